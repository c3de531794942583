"""DNGs whose pictures are known, for each honoured row of docs/dng.md."""

from dataclasses import replace

import numpy as np

import expected
from lists import lists
from opcodes import WHOLE, as_list, per_line
from scenes import (
    A,
    CALIBRATION,
    COOL,
    Case,
    D50,
    DAYLIGHT,
    FORWARD,
    FORWARD2,
    HEIGHT,
    MIDDLE,
    NEUTRAL,
    OTHER,
    WARM,
    WIDTH,
    illuminant,
    preview,
    scene,
    shot,
    with_sub,
    without_dng,
)
from write import DOUBLE, FLOAT, IFD, IFD8, LONG, LONG8, RATIONAL, SHORT, SRATIONAL, TAGS, UNDEFINED


def honoured():
    found = [*stores(), *writers(), *frames(), *levels(), *geometry(), *colours(), *lists(), *options()]
    names = [case.name for case in found]
    assert len(set(names)) == len(names), [n for n in names if names.count(n) > 1]
    return found


def stores():
    """Depths, compressions, strips, tiles, byte orders."""
    base = (256, 257, 262, 277, 33421, 33422, 50706, 50707)
    yield Case("flat", base, shot(light=scene(flat=True)))
    yield Case("plain-odd-strips", (*base, 273, 278, 279), shot(34, 50, strip=5))
    for bits in (8, 10, 12, 13, 14, 16, 20, 24, 32):
        for order in "<>":
            yield Case(
                f"bits-{bits}-{'little' if order == '<' else 'big'}",
                (258, 339),
                shot(34, 50, bits, strip=8, SampleFormat=1),
                order=order,
                libraw=bits <= 16,
            )
    for bits in (16, 24, 32):
        for order in "<>":
            yield Case(
                f"float-{bits}-{'little' if order == '<' else 'big'}",
                (258, 339),
                shot(bits=bits, floating=True, strip=9),
                order=order,
                libraw=False,
            )
        yield Case(
            f"float-{bits}-levels",
            (339, 50714, 50717),
            shot(bits=bits, floating=True, low=0.125, high=3.5, BlackLevel=0.125, WhiteLevel=("as", (RATIONAL, [3.5])), tile=(16, 16)),
            libraw=False,
        )
    for order in "<>":
        yield Case(f"tiles-{'little' if order == '<' else 'big'}", (322, 323, 324, 325), shot(34, 50, 12, tile=(16, 32)), order=order)
        yield Case(f"bigtiff-{'little' if order == '<' else 'big'}", (256,), shot(34, 50, strip=5), order=order, big=True, libraw=False)
    main = without_dng(shot(tile=(16, 16)))
    yield Case("bigtiff-tiles-subifd", (330,), main, [with_sub(main)], big=True, libraw=False)
    for predictor in range(1, 8):
        yield Case(f"jpeg-predictor-{predictor}", (259,), shot(bits=14, compression=7, jpeg={"predictor": predictor}))
    yield Case("jpeg-strips", (259, 278), shot(bits=14, compression=7, strip=11), libraw=False)
    yield Case("jpeg-one-component", (259,), shot(bits=12, compression=7, jpeg={"components": 1}))
    yield Case("jpeg-16", (259,), shot(bits=16, compression=7))
    halves = np.where(np.arange(WIDTH) < WIDTH // 2, 16384, 49152)[None, :] / 65535 * np.ones((HEIGHT, 1))
    yield Case("jpeg-category-16", (259,), shot(light=halves, compression=7))
    before = dict(DNGVersion=[1, 0, 0, 0], DNGBackwardVersion=[1, 0, 0, 0])
    yield Case("jpeg-category-16-old", (259, 50706), shot(light=halves, compression=7, jpeg={"old": True}, **before), libraw=False)
    yield Case("jpeg-8", (259,), shot(bits=8, compression=7))
    yield Case("jpeg-tiles", (259, 322), shot(34, 50, 14, compression=7, tile=(16, 16)))
    yield Case("jpeg-restarts", (259,), shot(bits=12, compression=7, jpeg={"restart": 24}))
    yield Case("jpeg-restarts-in-rows", (259,), shot(bits=12, compression=7, jpeg={"restart": 48, "predictor": 4}), libraw=False)
    # Only the number of samples of the stream must be that of the strip.
    yield Case("jpeg-wide", (259,), shot(bits=14, compression=7, jpeg={"fold": 2}))
    yield Case("jpeg-wide-tiles", (259,), shot(34, 50, 14, compression=7, jpeg={"fold": 2, "components": 4}, tile=(16, 32)))
    yield Case("extremes", (258,), shot(light=np.random.default_rng(5).choice([0.0, 1.0, 0.5], (HEIGHT, WIDTH))), tolerance=0.004)
    yield Case(
        "short-types", (256, 257, 273), shot(tags={"ImageWidth": ("as", (SHORT, [WIDTH])), "ImageLength": ("as", (SHORT, [HEIGHT]))})
    )
    yield Case("rows-default", (278,), shot(without=("RowsPerStrip",)))


def writers():
    """What programs write otherwise than the specification has it, and what it allows but few write."""
    yield Case("rows-all", (278,), shot(34, 50, tags={"RowsPerStrip": 2**32 - 1}))
    yield Case("tile-larger", (322,), shot(tile=(64, 64)), libraw=False)
    yield Case("unsorted", (256,), shot(unsorted=True, BlackLevel=500), libraw=False)
    yield Case("jpeg-fewer-bits", (258, 259), shot(bits=16, high=16383, compression=7, jpeg={"bits": 14}, WhiteLevel=16383))
    for name, kind, big in (("ifd", IFD, False), ("ifd8", IFD8, True), ("long8", LONG8, True)):
        inner = without_dng(shot())
        first = with_sub(inner)
        first.sub_kind = kind
        yield Case(f"sub-{name}", (330,), inner, [first], big=big, libraw=False)
    pattern = [0, 1, 1, 2]
    for name, tags in {
        "pattern-undefined": {"CFAPattern": ("as", (UNDEFINED, bytes(pattern)))},
        "area-short": {"ActiveArea": ("as", (SHORT, [2, 4, 30, 44]))},
        "black-srational": {"BlackLevel": ("as", (SRATIONAL, [700]))},
        "black-negative": {"BlackLevel": ("as", (SRATIONAL, [-700]))},
        "black-float": {"BlackLevel": ("as", (FLOAT, [700.0]))},
        "neutral-float": {"AsShotNeutral": ("as", (FLOAT, [0.5, 1.0, 0.625]))},
        "matrix-double": {"ColorMatrix1": ("as", (DOUBLE, WARM)), "AsShotNeutral": NEUTRAL},
        "white-several": {"WhiteLevel": [60000, 50000, 40000]},
    }.items():
        yield Case(f"type-{name}", tuple(TAGS[n][0] for n in tags), shot(light=scene() * 0.6, **tags), libraw=False)
    gains = as_list(per_line(12, WHOLE, [0.7] * HEIGHT))
    yield Case("type-opcodes-byte", (51009,), shot(OpcodeList2=gains, tags={"OpcodeList2": gains}), libraw=False)


def frames():
    """Which of several directories is taken."""
    main, small = shot(), shot(16, 24, light=scene(16, 24, seed=9) * 0.5)
    inner = without_dng(main)
    yield Case("subifd", (330, 262, 254), inner, [with_sub(inner)])
    reduced = replace(small, tags=small.tags | {"NewSubFileType": 1}, subs=[inner])
    yield Case("reduced-first", (254, 330), inner, [reduced])
    old = replace(small, tags=small.tags | {"SubfileType": 2}, subs=[without_dng(shot(SubfileType=1))])
    yield Case("old-reduced-first", (255,), old.subs[0], [old], libraw=False)
    bright = [without_dng(shot(light=scene() * share)) for share in (1.0, 0.8, 0.6)]
    yield Case("several-subs", (330,), bright[0], [with_sub(*bright)], libraw=False)
    yield Case("several-chained", (330,), shot(), [shot(), bright[1]], libraw=False)
    yield Case("chained", (330,), bright[1], [preview(), bright[1]], libraw=False)
    second = with_sub(bright[2])
    yield Case("sub-before-chain", (330,), bright[1], [with_sub(bright[1]), second], libraw=False)
    mask = replace(inner, tags=inner.tags | {"NewSubFileType": 4}, stored=inner.stored // 2)
    yield Case("mask-first", (254,), inner, [with_sub(mask, inner)], libraw=False)
    # Levels and geometry of another directory, and colours of one that is neither the first nor the frame's.
    other = {
        "BlackLevel": 9000,
        "WhiteLevel": 20000,
        "ActiveArea": [0, 0, 6, 6],
        "DefaultCropOrigin": [1, 1],
        "DefaultCropSize": [4, 4],
        "OpcodeList2": as_list(per_line(12, WHOLE, [0.5] * HEIGHT)),
        "LinearizationTable": [1, 2, 3],
        "CFAPattern": [2, 1, 1, 0],
    }
    yield Case("levels-of-preview", (50714, 50717, 50829), inner, [with_sub(inner, **other)], libraw=False)
    thumb = without_dng(shot(16, 24, light=scene(16, 24), NewSubFileType=1, ColorMatrix1=WARM, AsShotNeutral=NEUTRAL, Orientation=6))
    yield Case("colours-of-another", (50721, 50728), inner, [with_sub(thumb, inner)], colours={}, libraw=False)
    unnamed = shot(without=("DNGVersion", "DNGBackwardVersion"))
    yield Case("without-version", (50706,), unnamed, libraw=False)
    ep = shot(phase="bggr", BlackLevel=3000, WhiteLevel=50000, without=("DNGVersion", "DNGBackwardVersion"))
    yield Case("tiff-ep", (50706, 33422, 50714, 50717), ep, libraw=False, ending=".tif")


def levels():
    for name, given in {
        "black-one": dict(low=512, high=4000, bits=12, BlackLevel=512, WhiteLevel=4000),
        "black-cell": dict(low=600, high=15000, bits=14, BlackLevelRepeatDim=[2, 2], BlackLevel=[500, 520, 560, 700], WhiteLevel=15000),
        "black-row": dict(low=600, high=15000, bits=14, BlackLevelRepeatDim=[1, 2], BlackLevel=[500, 620], WhiteLevel=15000),
        "black-column": dict(low=600, high=15000, bits=14, BlackLevelRepeatDim=[2, 1], BlackLevel=[500, 620], WhiteLevel=15000),
        "black-odd-repeat": dict(
            low=2000, high=60000, BlackLevelRepeatDim=[3, 5], BlackLevel=list(range(1000, 2500, 100)), WhiteLevel=60000
        ),
        "black-large-repeat": dict(
            low=2000, high=60000, BlackLevelRepeatDim=[4, 4], BlackLevel=list(range(1000, 2600, 100)), WhiteLevel=60000
        ),
        "black-fraction": dict(low=512, high=4000, bits=12, BlackLevel=510.5, WhiteLevel=4000),
        "black-short": dict(low=512, high=4000, bits=12, BlackLevel=("as", (SHORT, [512])), WhiteLevel=("as", (SHORT, [4000]))),
        "black-long": dict(low=512, high=4000, bits=12, BlackLevel=("as", (LONG, [512])), WhiteLevel=("as", (LONG, [4000]))),
        "black-above": dict(low=300, high=4000, bits=12, BlackLevel=1100, WhiteLevel=4000),
        "white-low": dict(bits=12, WhiteLevel=3000),
        "white-default": dict(bits=12, low=100, BlackLevel=100),
    }.items():
        yield Case(name, tuple(TAGS[n][0] for n in given if n in TAGS), shot(**given), libraw=True)
    columns, rows = 256 * np.sin(np.arange(WIDTH)), np.linspace(0, 700, HEIGHT)
    for name, given in {
        "delta-h": dict(BlackLevelDeltaH=columns),
        "delta-v": dict(BlackLevelDeltaV=rows),
        "deltas": dict(BlackLevelDeltaH=columns, BlackLevelDeltaV=rows, BlackLevelRepeatDim=[2, 2], BlackLevel=[900, 950, 1000, 1100]),
    }.items():
        yield Case(name, tuple(TAGS[n][0] for n in given), shot(low=1500, high=60000, WhiteLevel=60000, **given))
    yield Case(
        "deltas-of-area",
        (50715, 50716, 50829),
        shot(
            36,
            54,
            low=1500,
            high=60000,
            BlackLevelDeltaH=columns[:46],
            BlackLevelDeltaV=rows[:31],
            ActiveArea=[3, 5, 34, 51],
            BlackLevel=800,
        ),
    )
    table = np.rint(65535 * (np.arange(4096) / 4095) ** 2.2)
    yield Case("linearization", (50712,), shot(bits=12, light=scene() ** (1 / 2.2), LinearizationTable=table, WhiteLevel=65535))
    yield Case(
        "linearization-black",
        (50712, 50714),
        shot(bits=12, light=scene() ** (1 / 2.2), LinearizationTable=table, WhiteLevel=60000, BlackLevel=700),
    )
    yield Case("linearization-short", (50712,), shot(bits=12, LinearizationTable=np.arange(3000) * 20, WhiteLevel=60000))
    yield Case("linearization-8", (50712,), shot(bits=8, LinearizationTable=np.arange(256) ** 2, WhiteLevel=65025))
    yield Case("linearization-default-white", (50712, 50717), shot(bits=12, LinearizationTable=np.arange(4096) // 2 + 100), libraw=False)
    for phase in expected.PHASES:
        yield Case(f"phase-{phase}", (33422,), shot(phase=phase, bits=14))


def geometry():
    for name, place in {"even": [2, 4, 30, 44], "odd": [3, 5, 29, 46], "odd-size": [1, 0, 30, 43]}.items():
        for phase in ("rggb", "gbrg"):
            yield Case(f"area-{name}-{phase}", (50829,), shot(phase=phase, bits=14, ActiveArea=place))
    yield Case(
        "area-black-cell",
        (50829, 50713),
        shot(bits=14, ActiveArea=[3, 5, 29, 46], BlackLevelRepeatDim=[2, 2], BlackLevel=[100, 300, 500, 900]),
    )
    for name, given in {
        "crop-even": dict(DefaultCropOrigin=[4, 2], DefaultCropSize=[40, 26]),
        "crop-odd": dict(DefaultCropOrigin=[5, 3], DefaultCropSize=[31, 23]),
        "crop-fraction": dict(DefaultCropOrigin=[4.3, 2.8], DefaultCropSize=[40.2, 25.7]),
        "crop-short": dict(DefaultCropOrigin=("as", (SHORT, [6, 4])), DefaultCropSize=("as", (SHORT, [30, 20]))),
        "crop-long": dict(DefaultCropOrigin=("as", (LONG, [6, 4])), DefaultCropSize=("as", (LONG, [30, 20]))),
        "crop-area": dict(ActiveArea=[3, 5, 31, 47], DefaultCropOrigin=[4, 2], DefaultCropSize=[33, 21]),
        "user-crop": dict(DefaultUserCrop=[0.25, 0.1, 0.75, 0.8]),
        "user-crop-of-crop": dict(DefaultCropOrigin=[4, 2], DefaultCropSize=[40, 26], DefaultUserCrop=[0.13, 0.22, 0.71, 0.93]),
    }.items():
        yield Case(name, tuple(TAGS[n][0] for n in given), shot(**given))
    yield Case("crop-beyond", (50720,), shot(ActiveArea=[0, 0, 31, 47], DefaultCropOrigin=[0, 0], DefaultCropSize=[47, 31]))
    yield Case("user-crop-of-odd-area", (51125,), shot(ActiveArea=[0, 0, 31, 47], DefaultUserCrop=[0.25, 0.3, 0.6, 0.71]))
    for turn in range(1, 9):
        yield Case(f"orientation-{turn}", (274,), shot(Orientation=turn))
    inner = without_dng(shot())
    yield Case("orientation-first", (274,), inner, [with_sub(inner, Orientation=6)], colours={"Orientation": 6})
    both = without_dng(shot(Orientation=3))
    yield Case("orientation-both", (274,), both, [with_sub(both, Orientation=8)], colours={"Orientation": 8}, libraw=False)
    yield Case("orientation-of-frame", (274,), both, [with_sub(both)], libraw=False)
    yield Case("orientation-crop", (274, 50719), shot(Orientation=6, DefaultCropOrigin=[5, 3], DefaultCropSize=[31, 21]))


def colours():
    one = {"ColorMatrix1": WARM, "AsShotNeutral": NEUTRAL}
    two = one | {"ColorMatrix2": COOL}
    three = two | {"ColorMatrix3": MIDDLE}
    both = {"CalibrationIlluminant1": A, "CalibrationIlluminant2": DAYLIGHT}
    forward = {"ForwardMatrix1": FORWARD, "ForwardMatrix2": FORWARD2}
    calibrated = {"CameraCalibration1": CALIBRATION, "CameraCalibration2": CALIBRATION[::-1]}
    sets = {
        "neutral": {"AsShotNeutral": NEUTRAL},
        "neutral-large": {"AsShotNeutral": [2.0, 4.0, 2.5]},
        "matrix-1": one,
        "matrix-only": {"ColorMatrix1": WARM},
        "matrix-two-unnamed": two,
        "matrix-a-d65": two | both,
        "matrix-d65-a": two | {"CalibrationIlluminant1": DAYLIGHT, "CalibrationIlluminant2": A},
        "matrix-a-d50-d65": three | {"CalibrationIlluminant1": A, "CalibrationIlluminant2": D50, "CalibrationIlluminant3": DAYLIGHT},
        "matrix-d50-a-shade": three | {"CalibrationIlluminant1": D50, "CalibrationIlluminant2": A, "CalibrationIlluminant3": 11},
        "matrix-tungsten-fluorescent": two | {"CalibrationIlluminant1": 14, "CalibrationIlluminant2": 3},
        "matrix-other": two
        | {
            "CalibrationIlluminant1": OTHER,
            "CalibrationIlluminant2": OTHER,
            "IlluminantData1": illuminant(0.3127, 0.3290),
            "IlluminantData2": illuminant(0.4476, 0.4074),
        },
        "matrix-other-2": two
        | {
            "CalibrationIlluminant1": OTHER,
            "CalibrationIlluminant2": OTHER,
            "IlluminantData1": illuminant(0.4476, 0.4074),
            "IlluminantData2": illuminant(0.3457, 0.3585),
        },
        "matrix-other-3": three
        | {
            "CalibrationIlluminant1": A,
            "CalibrationIlluminant2": D50,
            "CalibrationIlluminant3": OTHER,
            "IlluminantData3": illuminant(0.3127, 0.3290),
        },
        "forward-1": one | {"ForwardMatrix1": FORWARD},
        "forward-2": two | both | forward,
        "forward-of-other-only": two | both | {"ForwardMatrix1": FORWARD},
        "forward-3": three
        | {"CalibrationIlluminant1": A, "CalibrationIlluminant2": D50, "CalibrationIlluminant3": DAYLIGHT, "ForwardMatrix3": FORWARD},
        "calibration": two | both | calibrated,
        "calibration-1": one | {"CameraCalibration1": CALIBRATION},
        "calibration-3": three
        | {
            "CalibrationIlluminant1": A,
            "CalibrationIlluminant2": D50,
            "CalibrationIlluminant3": DAYLIGHT,
            "CameraCalibration3": CALIBRATION,
        },
        "calibration-forward": two | both | calibrated | forward,
        "calibration-forward-balance": two | both | calibrated | forward | {"AnalogBalance": [1.5, 1.0, 0.7]},
        "balance-cancels": one | {"AnalogBalance": [1.5, 1.0, 0.7]},
        "balance-xy": {"ColorMatrix1": WARM, "AsShotWhiteXY": [0.3457, 0.3585], "AnalogBalance": [1.5, 1.0, 0.7]},
        "xy": {"ColorMatrix1": WARM, "AsShotWhiteXY": [0.3457, 0.3585]},
        "xy-two": {"ColorMatrix1": WARM, "ColorMatrix2": COOL, "AsShotWhiteXY": [0.4, 0.38], **both},
        "xy-calibration": {"ColorMatrix1": WARM, "CameraCalibration1": CALIBRATION, "AsShotWhiteXY": [0.3457, 0.3585]},
        "signatures-equal": one
        | {"CameraCalibration1": CALIBRATION, "CameraCalibrationSignature": b"same\0", "ProfileCalibrationSignature": b"same\0"},
        "signatures-differ": one
        | {"CameraCalibration1": CALIBRATION, "CameraCalibrationSignature": b"one\0", "ProfileCalibrationSignature": b"two\0"},
        "signature-alone": one | {"CameraCalibration1": CALIBRATION, "CameraCalibrationSignature": b"one\0"},
    }
    for name, tags in sets.items():
        rows = tuple(TAGS[n][0] for n in tags)
        yield Case(f"colour-{name}", rows, shot(light=scene() * 0.6, **tags))
    inner = without_dng(shot(light=scene() * 0.6))
    yield Case("colour-first-directory", (50721,), inner, [with_sub(inner, **two, **both)], colours=two | both)
    inner = without_dng(shot(light=scene() * 0.6, ColorMatrix1=COOL, AsShotNeutral=[1, 1, 1]))
    yield Case("colour-both-directories", (50721,), inner, [with_sub(inner, **one)], colours=one, libraw=False)
    inner = without_dng(shot(light=scene() * 0.6, **one))
    yield Case("colour-of-frame", (50721,), inner, [with_sub(inner)], libraw=False)
    ended = two | {
        "CalibrationIlluminant1": OTHER,
        "CalibrationIlluminant2": OTHER,
        "IlluminantData1": illuminant(0.3127, 0.3290, ">"),
        "IlluminantData2": illuminant(0.4476, 0.4074, ">"),
    }
    yield Case("colour-other-big", (52533, 52534), shot(light=scene() * 0.6, **ended), order=">")


def options():
    """Options that take the file's place, over what is right, missing, damaged."""
    light = scene() * 0.6
    balance = ["--white-balance", "2,1,1.6"]

    def instead(name, meant, options_, phase=None, **given):
        yield Case(f"option-{name}", (), meant, [shot(light=light, **given)], phase=phase, options=options_, libraw=False)

    meant = shot(light=light, AsShotNeutral=[0.5, 1, 0.625])
    for name, given in {
        "present": {"AsShotNeutral": [1, 0.4, 0.5]},
        "missing": {},
        "zero": {"AsShotNeutral": [(0, 0)] * 3},
        "count": {"AsShotNeutral": [1.0, 1.0]},
        "xy": {"AsShotWhiteXY": [(0, 0), (0, 0)]},
    }.items():
        yield from instead(f"balance-{name}", meant, balance, **given)
    meant = shot(light=light, BlackLevel=1000)
    for name, given in {
        "present": {"BlackLevel": 77},
        "deltas": {"BlackLevelDeltaV": np.arange(HEIGHT) * 20, "BlackLevelDeltaH": np.arange(WIDTH) * 20},
        "repeat": {"BlackLevelRepeatDim": [3, 1], "BlackLevel": [1, 2, 3]},
        "zero": {"BlackLevel": [(0, 0)]},
        "deltas-count": {"BlackLevelDeltaV": [1, 2, 3]},
    }.items():
        yield from instead(f"black-{name}", meant, ["--black-level", "1000"], **given)
    cells = shot(light=light, BlackLevelRepeatDim=[2, 2], BlackLevel=[1000, 1100, 1200, 1300])
    yield from instead("black-four", cells, ["--black-level", "1000,1100,1200,1300"], BlackLevel=7)
    meant = shot(light=light, WhiteLevel=60000)
    for name, given in {"present": {"WhiteLevel": 50000}, "zero": {"WhiteLevel": 0}, "missing": {}}.items():
        yield from instead(f"white-{name}", meant, ["--white-level", "60000"], **given)
    for name, given in {
        "present": {"CFAPattern": [2, 1, 1, 0]},
        "missing": {"without": ("CFAPattern",)},
        "damaged": {"CFAPattern": [9, 9, 9, 9]},
    }.items():
        yield from instead(f"phase-{name}", shot(light=light), ["--phase", "rggb"], phase="rggb", **given)
    matrix = "0.9,0.2,-0.1,-0.1,1.2,-0.1,0.05,-0.25,1.2"
    numbers = np.array([float(v) for v in matrix.split(",")]).reshape(3, 3)
    # The matrix is that of XYZ to the camera whose inverse it is.
    camera = np.linalg.inv(numbers) @ np.linalg.inv(expected.xyz_from_srgb())
    meant = shot(light=light, ColorMatrix1=camera.ravel(), AsShotNeutral=NEUTRAL)
    yield from instead("matrix", meant, ["--colour-matrix", matrix], ColorMatrix1=WARM, AsShotNeutral=NEUTRAL)
