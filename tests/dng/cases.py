"""The DNGs of check.py: for each row of docs/dng.md what is written, and what is expected of it."""

import struct
from dataclasses import dataclass, field, replace

import numpy as np

import expected
from write import ASCII, BYTE, DOUBLE, FLOAT, LONG, RATIONAL, SHORT, SLONG, SRATIONAL, TAGS, UNDEFINED, Directory, area, dng, opcode

HEIGHT, WIDTH = 32, 48
LARGE = 128, 192
# Largest difference of a number 0 to 1: light is rounded to 16 bits, and so are the pictures.
TOLERANCE = 0.0012
# The corner of the farthest pixel or its middle may have the radius 1: a small difference in a large frame.
ROUND = 0.003

WARM = [0.8, 0.15, -0.05, -0.3, 1.1, 0.2, -0.05, 0.2, 0.6]
COOL = [0.9, -0.2, -0.1, -0.4, 1.2, 0.2, -0.1, 0.25, 0.5]
MIDDLE = [0.85, -0.05, -0.08, -0.35, 1.15, 0.2, -0.08, 0.22, 0.55]
FORWARD = [0.6, 0.25, 0.11, 0.25, 0.7, 0.05, 0.02, 0.1, 0.7]
FORWARD2 = [0.5, 0.35, 0.12, 0.2, 0.72, 0.08, 0.04, 0.05, 0.74]
CALIBRATION = [1.05, 0.03, -0.02, 0.02, 0.95, 0.04, -0.01, 0.05, 1.1]
NEUTRAL = [0.5, 1.0, 0.625]
A, DAYLIGHT, D50, OTHER = 17, 21, 23, 255


@dataclass
class Case:
    """A file whose picture is known: the directory of its frame, and how it lies in the file."""

    name: str
    rows: tuple
    shot: Directory
    directories: list | None = None
    order: str = "<"
    big: bool = False
    colours: dict | None = None
    phase: str | None = None
    options: list = field(default_factory=list)
    tolerance: float = TOLERANCE
    libraw: bool = True

    def file(self):
        return dng(self.directories or [self.shot], self.order, self.big)

    def finished(self, reconstructed):
        return expected.finished(reconstructed, self.shot, self.colours, self.order)


@dataclass
class Harmless:
    name: str
    data: bytes
    number: int


@dataclass
class Rejection:
    name: str
    data: bytes
    number: int
    words: list
    options: list = field(default_factory=list)
    help: bool = True
    ending: str = ".dng"


@dataclass
class Note:
    name: str
    data: bytes
    number: int
    words: list
    expected: bool = True
    options: list = field(default_factory=list)


# Scenes


def scene(height=HEIGHT, width=WIDTH, phase="rggb", seed=1, noise=0.02, flat=False):
    """Light of a mosaic: ramps along both sides, an asymmetric blob, noise; or flat 0.3 0.4 0.5."""
    rows, columns = np.indices((height, width))
    colour = np.array(expected.PHASES[phase]).reshape(2, 2)[rows % 2, columns % 2]
    light = np.array([0.3, 0.4, 0.5])[colour]
    if flat:
        return light
    field_ = 0.55 + 0.25 * columns / width + 0.3 * rows / height
    field_ += 0.25 * np.exp(-((6 * rows / height - 1.8) ** 2 + (6 * columns / width - 4.2) ** 2))
    noisy = light * field_ + noise * np.random.default_rng(seed).uniform(-1, 1, light.shape)
    return np.clip(noisy, 0.02, 0.98)


def shot(height=HEIGHT, width=WIDTH, bits=16, phase="rggb", low=0.0, high=None, light=None, floating=False, **given):
    """A directory whose stored values lie between `low` and `high`; the other arguments are those of Directory, or tags."""
    fields = {name: given.pop(name) for name in ("compression", "tile", "strip", "jpeg", "subs", "without") if name in given}
    high = high if high is not None else (1.0 if floating else (1 << bits) - 1)
    light = scene(height, width, phase) if light is None else light
    stored = low + (high - low) * light
    stored = stored.astype(np.float32) if floating else np.rint(stored).astype(np.int64)
    tags = {
        "DNGVersion": [1, 4, 0, 0],
        "DNGBackwardVersion": [1, 1, 0, 0],
        "UniqueCameraModel": "check",
        "CFARepeatPatternDim": [2, 2],
        "CFAPattern": list(expected.PHASES[phase]),
    }
    return Directory(stored, bits=bits, tags=tags | given.pop("tags", {}) | given, **fields)


def plain(**given):
    return Case("plain", (), shot(**given))


def preview(**tags):
    """A small RGB preview as a first directory."""
    pixels = np.full((8, 12 * 3), 77)
    made = {"ImageWidth": 12, "SamplesPerPixel": 3, "BitsPerSample": [8, 8, 8], "PhotometricInterpretation": 2, "NewSubFileType": 1}
    return Directory(pixels, bits=8, tags={"DNGVersion": [1, 4, 0, 0], "DNGBackwardVersion": [1, 1, 0, 0]} | made | tags)


def without_dng(directory):
    """The directory of a frame that is not the first."""
    tags = {k: v for k, v in directory.tags.items() if k not in ("DNGVersion", "DNGBackwardVersion", "UniqueCameraModel")}
    return replace(directory, tags=tags)


# Honoured


def honoured():
    found = [*stores(), *frames(), *levels(), *geometry(), *colours(), *lists(), *options()]
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


def with_sub(*subs, **tags):
    first = preview(**tags)
    first.subs = list(subs)
    return first


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


def illuminant(x, y, order="<"):
    return struct.pack(order + "H4I", 0, round(x * 10000), 10000, round(y * 10000), 10000)


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


def floats(*numbers):
    return struct.pack(f">{len(numbers)}f", *numbers)


def doubles(*numbers):
    return struct.pack(f">{len(numbers)}d", *numbers)


def word(number):
    return struct.pack(">I", number)


def table(numbers):
    return word(len(numbers)) + np.asarray(numbers).astype(">u2").tobytes()


def gain_map(place, grid, spacing, origin, planes=1):
    grid = np.asarray(grid, np.float64).reshape(*np.shape(grid)[:2], planes)
    return opcode(9, place + struct.pack(">IIddddI", *grid.shape[:2], *spacing, *origin, planes) + grid.astype(">f4").tobytes())


GRID = [[1.0, 0.8, 0.9, 1.1], [0.7, 0.95, 1.05, 0.85], [0.9, 1.1, 0.75, 1.0]]


def per_line(number, place, numbers):
    return opcode(number, place + word(len(numbers)) + floats(*numbers))


def bad_list(phase, points, rectangles):
    data = word(phase) + word(len(points)) + word(len(rectangles))
    return opcode(5, data + b"".join(struct.pack(">II", *p) for p in points) + b"".join(struct.pack(">4I", *r) for r in rectangles))


WHOLE = area(0, 0, HEIGHT, WIDTH)
PART = area(3, 5, 27, 42, 0, 1, 2, 2)


def mosaic_opcodes(first):
    """Opcodes of lists 1 and 2, by name. Values are stored ones in list 1 and light in list 2."""
    delta, unit = 65535, 1 if first else 65535
    curve = [200 / unit, 0.9, 0.05 * unit / 65535]
    lines = np.linspace(0.8, 1.1, 12)
    yield "map-table", opcode(7, WHOLE + table(np.rint(65535 * (np.arange(65536) / 65535) ** 1.3)))
    yield "map-table-short", opcode(7, PART + table(np.arange(30000)))
    yield "map-polynomial", opcode(8, WHOLE + word(2) + doubles(*curve))
    yield "map-polynomial-part", opcode(8, PART + word(1) + doubles(curve[0], 0.7))
    yield "gain-map", gain_map(WHOLE, GRID, (0.5, 1 / 3), (0.0, 0.0))
    yield "gain-map-inside", gain_map(WHOLE, GRID, (0.2, 0.15), (0.3, 0.25))
    yield "gain-map-one", gain_map(PART, [[0.8]], (1.0, 1.0), (0.0, 0.0))
    cells = [
        gain_map(area(r, c, HEIGHT, WIDTH, 0, 1, 2, 2), np.array(GRID) * (1 - 0.1 * (2 * r + c)), (0.5, 1 / 3), (0.0, 0.0))
        for r in (0, 1)
        for c in (0, 1)
    ]
    yield "gain-map-cells", b"".join(cells)
    yield "delta-row", per_line(10, PART, list(delta * np.linspace(-0.08, 0.1, 12)))
    yield "delta-column", per_line(11, PART, list(delta * np.linspace(-0.08, 0.1, 19)))
    yield "scale-row", per_line(12, PART, list(lines))
    yield "scale-column", per_line(13, PART, list(np.linspace(1.1, 0.7, 19)))
    yield "beyond", per_line(12, area(20, 30, 60, 90, 0, 1, 3, 1), list(np.linspace(0.5, 1, 14)))
    yield "trim-nothing", opcode(6, struct.pack(">4I", 0, 0, HEIGHT, WIDTH))
    yield "optional-unknown", opcode(99, b"1234", optional=True) + per_line(12, PART, list(lines))
    yield "optional-new", opcode(13, b"1234", optional=True, version=(1, 9, 0, 0))
    yield "order", opcode(8, WHOLE + word(1) + doubles(curve[0] * 5, 0.7)) + per_line(12, WHOLE, list(np.linspace(0.8, 1.1, HEIGHT)))


def counted(data):
    """Number of the opcodes in a row of them."""
    number, at = 0, 0
    while at < len(data):
        at += 16 + struct.unpack_from(">I", data, at + 12)[0]
        number += 1
    return number


def as_list(data):
    return word(counted(data)) + data


def lists():
    for number in (1, 2):
        for name, data in mosaic_opcodes(number == 1):
            row = {1: 51008, 2: 51009}[number]
            yield Case(f"list{number}-{name}", (row,), shot(light=scene() * 0.9, **{f"OpcodeList{number}": as_list(data)}))
            if name in ("gain-map-cells", "delta-row", "map-polynomial"):
                bits = 16 if name == "map-polynomial" else 14
                made = shot(bits=bits, light=scene() * 0.9, **{f"OpcodeList{number}": as_list(data)})
                yield Case(f"list{number}-{name}-big", (row,), made, order=">")
        yield from repairs(number)
    vignette = opcode(3, doubles(0.1, -0.25, 0.1, 0.05, -0.1, 0.45, 0.55))
    yield Case("list2-vignette", (51009,), shot(*LARGE, light=scene(*LARGE) * 0.9, OpcodeList2=as_list(vignette)), tolerance=ROUND)
    levels_ = dict(bits=14, low=900, high=15000, BlackLevel=900, WhiteLevel=15000, ActiveArea=[3, 5, 31, 47], light=scene() * 0.8)
    yield Case(
        "list1-of-whole-picture",
        (51008,),
        shot(**levels_, OpcodeList1=as_list(per_line(11, area(4, 6, 20, 40, 0, 1, 2, 1), list(np.linspace(-800, 900, 34))))),
    )
    yield Case(
        "list2-of-area",
        (51009,),
        shot(**levels_, OpcodeList2=as_list(gain_map(area(0, 1, 28, 42, 0, 1, 2, 2), GRID, (0.5, 1 / 3), (0, 0)))),
    )
    yield Case(
        "list1-before-table",
        (51008, 50712),
        shot(
            bits=12,
            LinearizationTable=np.arange(4096) * 15,
            WhiteLevel=60000,
            OpcodeList1=as_list(per_line(12, PART, list(np.linspace(0.8, 1, 12)))),
        ),
    )
    yield Case(
        "list2-float",
        (51009,),
        shot(bits=32, floating=True, light=scene() * 0.9, OpcodeList2=as_list(per_line(10, PART, list(np.linspace(-0.08, 0.1, 12))))),
        libraw=False,
    )
    yield from picture_lists()


def repairs(number):
    row = {1: 51008, 2: 51009}[number]
    ramps = [np.indices((HEIGHT, WIDTH))[0] / HEIGHT, np.indices((HEIGHT, WIDTH))[1] / WIDTH]
    for axis, ramp in enumerate(ramps):
        light = scene(flat=True) * (0.5 + 0.4 * ramp)
        for r, c in [(10, 12), (10, 17), (15, 20), (21, 31)]:
            light[r, c] = 1.0
        data = opcode(4, struct.pack(">II", 65535, 0))
        yield Case(f"list{number}-bad-constant-{axis}", (row,), shot(light=light, **{f"OpcodeList{number}": as_list(data)}))
        light = scene(flat=True) * (0.5 + 0.4 * ramp)
        points, rectangles = [(10, 12), (10, 17), (15, 20), (21, 31)], [(5, 30, 6, 36)]
        for r, c in points:
            light[r, c] = 0.95
        light[5:6, 30:36] = 0.0
        yield Case(
            f"list{number}-bad-list-{axis}", (row,), shot(light=light, **{f"OpcodeList{number}": as_list(bad_list(0, points, rectangles))})
        )
    for phase_number, phase in enumerate(expected.PHASES):
        light = scene(phase=phase, flat=True)
        light[9, 13] = light[14, 14] = light[20, 23] = light[25, 30] = light[0, 0] = light[31, 47] = 0.9
        data = bad_list(phase_number, [(9, 13), (14, 14), (20, 23), (25, 30), (0, 0), (31, 47)], [])
        yield Case(f"list{number}-bad-phase-{phase}", (row,), shot(light=light, phase=phase, **{f"OpcodeList{number}": as_list(data)}))


def picture_lists():
    planes = lambda first, count: area(3, 5, 27, 42, first, count, 2, 3)
    whole = area(0, 0, HEIGHT, WIDTH, 0, 3)
    unit = 65535
    smooth = scene(*LARGE, noise=0.0) * 0.9
    made = {
        "map-table": opcode(7, whole + table(np.rint(65535 * (np.arange(65536) / 65535) ** 1.3))),
        "map-polynomial": opcode(8, planes(0, 3) + word(2) + doubles(0.01, 0.8, 0.1)),
        "map-polynomial-green": opcode(8, planes(1, 1) + word(2) + doubles(0.01, 0.8, 0.1)),
        "gain-map": gain_map(whole, GRID, (0.5, 1 / 3), (0.0, 0.0)),
        "gain-map-planes": gain_map(
            whole, np.stack([np.array(GRID), np.array(GRID)[::-1], np.array(GRID) * 0.8], -1), (0.5, 1 / 3), (0.0, 0.0), 3
        ),
        "gain-map-last-plane": gain_map(area(0, 0, HEIGHT, WIDTH, 1, 2), GRID, (0.5, 1 / 3), (0.1, 0.0)),
        "delta-row": per_line(10, planes(0, 3), list(unit * np.linspace(-0.08, 0.1, 12))),
        "delta-column": per_line(11, planes(2, 1), list(unit * np.linspace(-0.08, 0.1, 13))),
        "scale-row": per_line(12, planes(0, 2), list(np.linspace(0.8, 1.1, 12))),
        "scale-column": per_line(13, planes(0, 3), list(np.linspace(1.1, 0.8, 13))),
        "trim-nothing": opcode(6, struct.pack(">4I", 0, 0, HEIGHT, WIDTH)),
        "optional-unknown": opcode(14, b"1234", optional=True),
    }
    for name, data in made.items():
        yield Case(f"list3-{name}", (51022,), shot(light=scene() * 0.9, OpcodeList3=as_list(data)), tolerance=0.002)
    vignette = opcode(3, doubles(0.2, -0.25, 0.1, 0.05, -0.1, 0.45, 0.55))
    yield Case("list3-vignette", (51022,), shot(*LARGE, light=smooth, OpcodeList3=as_list(vignette)), tolerance=ROUND)
    identity = [1.0, 0, 0, 0, 0, 0]
    warps = {
        "warp-nothing": (1, [identity], (0.5, 0.5)),
        "warp-scale": (1, [[0.9, 0, 0, 0, 0, 0]], (0.5, 0.5)),
        "warp-radial": (1, [[0.95, -0.08, 0.05, 0.02, 0, 0]], (0.45, 0.55)),
        "warp-tangential": (1, [[0.95, 0, 0, 0, 0.03, -0.04]], (0.5, 0.5)),
        "warp-planes": (1, [[0.92, 0, 0, 0, 0, 0], identity, [0.95, -0.05, 0, 0, 0, 0]], (0.5, 0.5)),
        "fisheye": (2, [[1.1, -0.1, 0.05, 0.02]], (0.5, 0.5)),
        "fisheye-planes": (2, [[1.1, -0.1, 0, 0], [1.05, 0, 0, 0], [1.0, 0.1, 0, 0]], (0.45, 0.55)),
    }
    for name, (number, sets, centre) in warps.items():
        data = opcode(number, word(len(sets)) + b"".join(doubles(*k) for k in sets) + doubles(*centre))
        yield Case(f"list3-{name}", (51022,), shot(*LARGE, light=smooth, OpcodeList3=as_list(data)), tolerance=ROUND)
    crop = dict(
        ActiveArea=[2, 4, 32, 46],
        DefaultCropOrigin=[4, 2],
        DefaultCropSize=[33, 21],
        Orientation=6,
        AsShotNeutral=NEUTRAL,
        ColorMatrix1=WARM,
    )
    yield Case(
        "list3-before-crop-and-colours",
        (51022,),
        shot(light=scene() * 0.6, **crop, OpcodeList3=as_list(gain_map(area(0, 0, 30, 42, 0, 3), GRID, (0.5, 1 / 3), (0, 0)))),
        tolerance=0.004,
    )
    yield Case(
        "list3-float",
        (51022,),
        shot(bits=32, floating=True, OpcodeList3=as_list(per_line(10, planes(0, 3), list(np.linspace(-0.08, 0.1, 12))))),
        libraw=False,
        tolerance=0.002,
    )


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


# Harmless


SAMPLES = {
    ASCII: "text of a case",
    BYTE: [1, 2, 3, 4],
    SHORT: [3],
    LONG: [5],
    RATIONAL: [1.5],
    SRATIONAL: [-0.5],
    UNDEFINED: b"\1\2\3\4\5\6\7\10",
    FLOAT: [0.5, 0.25],
    DOUBLE: [0.5, 0.25],
    SLONG: [-7],
}
# Types and values of harmless tags where these are not three of SHORT.
TEXTS = [
    269,
    270,
    271,
    272,
    285,
    305,
    306,
    315,
    316,
    333,
    337,
    32781,
    33432,
    34852,
    36867,
    37395,
    50708,
    50735,
    50966,
    50967,
    50968,
    50971,
    51105,
    51081,
    51182,
    52526,
    52528,
    52552,
    50934,
    50936,
    50942,
]
BYTES = [700, 34377, 50709, 50827, 50740, 50969, 50972, 50973, 51111, 50781, 51043, 51113, 51114, 52540, 33723, 37398]
UNDEFINEDS = [34675, 34856, 34857, 37388, 37389, 50828, 50831, 50833, 51113, 52545, 52548, 52550, 52551]
RATIONALS = {
    282: [72.0],
    283: [72.0],
    286: [1.0],
    287: [1.0],
    318: [0.3127, 0.329],
    319: [0.64, 0.33, 0.3, 0.6, 0.15, 0.06],
    529: [0.3, 0.6, 0.1],
    532: [0, 255, 128, 255, 128, 255],
    33423: [0.5],
    33434: [0.01],
    33437: [2.8],
    37122: [4.0],
    37378: [3.0],
    37381: [3.0],
    37382: [1.5],
    37386: [50.0],
    37387: [2.0],
    37390: [5000.0],
    37391: [5000.0],
    37397: [1.5],
    50731: [2.5],
    50732: [1.5],
    50734: [0.7],
    50736: [24.0, 70.0, 2.8, 2.8],
    50737: [3.0],
    50738: [0.5],
    50739: [0.5],
    50780: [2.0],
    50935: [0.8],
    51058: [2.8],
    51178: [1.0],
    51179: [9.0],
}
SRATIONALS = {
    37377: [6.0],
    37379: [1.0],
    37380: [1.5],
    50725: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    50726: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    52538: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    50832: [2, 0, 0, 0, 2, 0, 0, 0, 2],
    50834: [2, 0, 0, 0, 2, 0, 0, 0, 2],
    51044: [24.0],
}
LONGS = {
    288: [8],
    289: [4],
    292: [1],
    293: [1],
    50933: [8],
    51089: [24, 16],
    51090: [24, 16],
    51091: [24, 16],
    51110: [1],
    50941: [1],
    50970: [2],
    51107: [1],
    51108: [1],
    50733: [3000],
    34853: [8],
    34665: [8],
    37393: [7],
    52536: [1, 2, 3, 4],
    513: [8],
    514: [4],
    519: [8],
    520: [8],
    521: [8],
    52541: [8],
    52542: [4],
    52554: [7],
    52555: [2],
}
DOUBLES = {51041: [2e-5, 4e-7], 51112: [0.5]}
OTHERS = {
    52553: (FLOAT, [1.5]),
    34858: (SHORT, [1]),
    284: (SHORT, [2]),
    50741: (SHORT, [1]),
    338: (SHORT, [1]),
    301: (SHORT, list(range(0, 256 * 100, 100))),
    320: (SHORT, list(range(768))),
    291: (SHORT, [5, 6, 7]),
    530: (SHORT, [2, 2]),
    342: (SHORT, [1, 2, 3, 4, 5, 6]),
    297: (SHORT, [1, 4]),
    280: (SHORT, [1000]),
    281: (SHORT, [2000]),
    340: (SHORT, [1000]),
    341: (SHORT, [2000]),
    37396: (SHORT, [9, 9]),
    336: (SHORT, [10, 200]),
    321: (SHORT, [10, 200]),
    34855: (SHORT, [100]),
}


def harmless_value(number):
    for numbers, kind in ((TEXTS, ASCII), (BYTES, BYTE), (UNDEFINEDS, UNDEFINED)):
        if number in numbers:
            return kind, SAMPLES[kind]
    for values, kind in ((RATIONALS, RATIONAL), (SRATIONALS, SRATIONAL), (LONGS, LONG), (DOUBLES, DOUBLE)):
        if number in values:
            return kind, values[number]
    return OTHERS.get(number, (SHORT, SAMPLES[SHORT]))


def harmless(rows):
    found = []
    for number, row in rows.items():
        if row.treatment == "harmless":
            kind, value = harmless_value(number)
            if kind == BYTE:
                value = bytes(value)
            data = with_tag(plain().shot, number, kind, value)
            found.append(Harmless(f"{number}-{row.name}", data, number))
            # Out of the file, and of an unknown type: the tag is not read.
            found.append(Harmless(f"{number}-{row.name}-damaged", damaged(plain().shot, number, 99, 7), number))
    return found


def with_tag(directory, number, kind, value):
    name = next((n for n, (code, _) in TAGS.items() if code == number), None)
    tags = {k: v for k, v in directory.tags.items() if k != name}
    if kind == BYTE and isinstance(value, bytes):
        value = list(value)
    return dng([replace(directory, tags=tags | {number: (kind, value)}, without=directory.without + ((name,) if name else ()))])


# Rejected


def rejected():
    base = lambda **tags: dng([shot(**tags)])
    found = []

    def add(name, number, words, data, **more):
        found.append(Rejection(name, data, number, words, **more))

    for name, value in {
        "FillOrder": 2,
        "Predictor": 2,
        "JPEGTables": b"\xff\xd8\xff\xd9",
        "CFALayout": 2,
        "CFAPlaneColor": [1, 0, 2],
        "DefaultScale": [2.0, 1.0],
        "SubTileBlockSize": [2, 2],
        "RowInterleaveFactor": 2,
        "ColumnInterleaveFactor": 2,
        "ColorimetricReference": 1,
    }.items():
        number = TAGS[name][0]
        more = dict(compression=7, bits=14) if name == "JPEGTables" else {}
        add(name, number, [name, str(number)], base(**{name: value}, **more))
    add("predictor-horizontal-jpeg", 317, ["Predictor", "317"], base(Predictor=3, compression=7, bits=14))
    for value in (2, 5, 6, 8, 34892, 52546, 60000):
        add(f"compression-{value}", 259, ["Compression", str(value)], base(tags={"Compression": value}))
    for value in (4, 7, 33, 64):
        add(f"bits-{value}", 258, ["BitsPerSample", str(value)], base(tags={"BitsPerSample": value}))
    add("bits-float-64", 258, ["BitsPerSample"], base(bits=32, floating=True, tags={"BitsPerSample": 64}))
    add("samples", 277, ["SamplesPerPixel"], base(tags={"SamplesPerPixel": 3}))
    for value in (2, 4, 5):
        add(f"format-{value}", 339, ["SampleFormat", str(value)], base(SampleFormat=value))
    add("float-12", 258, ["BitsPerSample"], base(bits=12, SampleFormat=3))
    add("linear", 262, ["three colours"], base(tags={"PhotometricInterpretation": 34892}))
    add("no-mosaic", 262, ["colour filter array"], dng([preview(NewSubFileType=0)]), help=False)
    add("only-reduced", 254, ["NewSubFileType"], base(NewSubFileType=1))
    add("four-colours", 33422, ["mosaic"], base(tags={"CFAPattern": [0, 1, 2, 3], "CFAPlaneColor": [0, 1, 2, 3]}))
    add("x-trans", 33421, ["6x6"], base(tags={"CFARepeatPatternDim": [6, 6], "CFAPattern": [1, 1, 0, 1, 1, 2] * 6}))
    add("no-pattern", 33422, ["CFAPattern", "phase"], base(without=("CFAPattern",)))
    add("new-version", 50707, ["DNGBackwardVersion", "1.8"], base(tags={"DNGBackwardVersion": [1, 8, 0, 0]}))
    add("white-below-black", 50717, ["level"], base(BlackLevel=5000, WhiteLevel=4000))
    add("white-missing-for-table", 50717, ["WhiteLevel"], base(bits=12, LinearizationTable=np.arange(4096) * 16))
    add("white-zero", 50717, ["white level"], base(WhiteLevel=0))
    add("area-outside", 50829, ["ActiveArea"], base(ActiveArea=[0, 0, HEIGHT + 2, WIDTH]))
    add("area-empty", 50829, ["ActiveArea"], base(ActiveArea=[8, 8, 8, 20]))
    add("crop-outside", 50719, ["DefaultCrop"], base(DefaultCropOrigin=[WIDTH + 4, 0], DefaultCropSize=[4, 4]))
    add("crop-empty", 50720, ["DefaultCropSize"], base(DefaultCropOrigin=[4, 4], DefaultCropSize=[0, 4]))
    add("user-crop-turned", 51125, ["DefaultUserCrop"], base(DefaultUserCrop=[0.8, 0.0, 0.2, 1.0]))
    add("orientation-9", 274, ["Orientation"], base(Orientation=9))
    add("neutral-zero", 50728, ["AsShotNeutral", "white balance"], base(AsShotNeutral=[(0, 0)] * 3))
    add("neutral-zero-one", 50728, ["AsShotNeutral", "white balance"], base(AsShotNeutral=[0.5, 0, 0.5]))
    add("matrix-singular", 50721, ["ColorMatrix1"], base(ColorMatrix1=[1, 1, 1] * 3))
    add("black-count", 50714, ["BlackLevel"], base(BlackLevelRepeatDim=[2, 2], BlackLevel=[1, 2, 3]))
    add("black-repeat-zero", 50713, ["BlackLevelRepeatDim"], base(BlackLevelRepeatDim=[0, 2], BlackLevel=[1]))
    add("black-fraction-zero", 50714, ["BlackLevel"], base(BlackLevel=[(0, 0)]))
    add("delta-h-count", 50715, ["BlackLevelDeltaH"], base(BlackLevelDeltaH=[1, 2, 3]))
    add("delta-v-count", 50716, ["BlackLevelDeltaV"], base(BlackLevelDeltaV=[1] * (HEIGHT + 1)))
    add("table-empty", 50712, ["LinearizationTable"], base(tags={"LinearizationTable": ("as", (SHORT, []))}))
    add("tile-zero", 322, ["TileWidth"], base(tile=(16, 16), tags={"TileWidth": 0}))
    add("strip-zero", 278, ["RowsPerStrip"], base(tags={"RowsPerStrip": 0}))
    add("strip-few", 273, ["StripOffsets"], base(strip=8, tags={"StripOffsets": [8]}))
    add("width-zero", 256, ["ImageWidth"], base(tags={"ImageWidth": 0}))
    add("size-huge", 257, ["ImageLength"], base(tags={"ImageLength": 2**31}))
    add("no-offsets", 273, ["StripOffsets"], base(without=("StripOffsets",)), help=False)
    add("jpeg-garbage", 259, ["JPEG"], dng([shot(compression=7, bits=14)]).replace(b"\xff\xd8\xff\xc3", b"\xff\xd8\xff\xc0"), help=False)
    # Directories without an end.
    add("loop", 330, [], loop(), help=False)
    for number, row in ((1, 51008), (2, 51009), (3, 51022)):
        tag = f"OpcodeList{number}"
        every = {
            "trims": (opcode(6, struct.pack(">4I", 0, 0, HEIGHT - 2, WIDTH)), "TrimBounds"),
            "unknown": (opcode(99, b""), "99"),
            "new": (opcode(13, b"1234", version=(1, 9, 0, 0)), "ScalePerColumn"),
            "warp2": (opcode(14, b"1234"), "WarpRectilinear2"),
            "short": (opcode(12, WHOLE[:20]), "ScalePerRow"),
            "polynomial": (opcode(8, WHOLE + word(9) + doubles(*[0.1] * 10)), "MapPolynomial"),
            "map": (opcode(9, WHOLE + struct.pack(">IIddddI", 1 << 20, 1 << 20, 1, 1, 0, 0, 1)), "GainMap"),
            "count": (per_line(10, WHOLE, [1.0] * 3), "DeltaPerRow"),
            "pitch": (per_line(10, area(0, 0, 8, 8, 0, 1, 0, 1), [1.0] * 8), "DeltaPerRow"),
        }
        if number < 3:
            every["warp"] = (opcode(1, word(1) + doubles(1, 0, 0, 0, 0, 0, 0.5, 0.5)), "WarpRectilinear")
            every["fisheye"] = (opcode(2, word(1) + doubles(1, 0, 0, 0, 0.5, 0.5)), "WarpFisheye")
        if number == 1:
            every["vignette"] = (opcode(3, doubles(0.1, 0, 0, 0, 0, 0.5, 0.5)), "FixVignetteRadial")
        if number == 3:
            every["bad-constant"] = (opcode(4, struct.pack(">II", 0, 0)), "FixBadPixelsConstant")
            every["bad-list"] = (bad_list(0, [(1, 1)], []), "FixBadPixelsList")
        for name, (data, word_) in every.items():
            add(f"list{number}-{name}", row, [tag, word_], base(**{tag: as_list(data)}), help=False)
        add(f"list{number}-cut", row, [tag], base(**{tag: as_list(opcode(13, WHOLE + word(4) + floats(1, 1, 1, 1)))[:-5]}), help=False)
        add(f"list{number}-many", row, [tag], base(**{tag: word(2**31) + bytes(16)}), help=False)
        add(f"list{number}-empty", row, [tag], base(**{tag: b"\0\0"}), help=False)
    return found


def loop():
    """A directory that is its own successor."""
    data = bytearray(dng([shot(16, 24, light=scene(16, 24), NewSubFileType=1)]))
    first = struct.unpack_from("<I", data, 4)[0]
    count = struct.unpack_from("<H", data, first)[0]
    struct.pack_into("<I", data, first + 2 + 12 * count, first)
    return bytes(data)


def damaged(directory, number, kind, count, value=0x7FFFFFF0):
    """A file in which a tag's entry has a type, a count and a value, or a place, of its own."""
    name = next((n for n, (code, _) in TAGS.items() if code == number), None)
    tags = dict(directory.tags)
    if name in tags or number in tags or name is None or name not in present(directory):
        tags.pop(name, None)
        tags[number] = (SHORT, [1])
        directory = replace(directory, tags=tags)
    data = bytearray(dng([directory]))
    at = struct.unpack_from("<I", data, 4)[0]
    for entry in range(struct.unpack_from("<H", data, at)[0]):
        place = at + 2 + 12 * entry
        if struct.unpack_from("<H", data, place)[0] == number:
            struct.pack_into("<HII", data, place + 2, kind, count, value)
            return bytes(data)
    raise AssertionError(number)


def present(directory):
    """Names of the tags that the writer makes of a picture."""
    shared = {"ImageWidth", "ImageLength", "BitsPerSample", "Compression", "PhotometricInterpretation", "SamplesPerPixel"}
    parts = (
        {"TileWidth", "TileLength", "TileOffsets", "TileByteCounts"}
        if directory.tile
        else {"RowsPerStrip", "StripOffsets", "StripByteCounts"}
    )
    return shared | parts | ({"SampleFormat"} if directory.stored.dtype.kind == "f" else set()) | set(directory.tags)


def unreadable(rows):
    """Each honoured or rejected tag beyond the end of the file, and of an unknown type."""
    found = []
    for number, row in rows.items():
        if row.treatment not in ("honoured", "rejected"):
            continue
        for way, kind, count in (("far", LONG, 1000), ("type", 99, 1)):
            extra = {}
            if 322 <= number <= 325:
                extra = dict(tile=(16, 16))
            if number in (52533, 52534, 52535):
                index = number - 52532
                extra = {f"ColorMatrix{index}": WARM, f"CalibrationIlluminant{index}": OTHER}
            elif number in (50778, 50779, 50721, 50722, 50723, 50724, 50964, 50965, 52529, 52530, 52531, 52532):
                index = {50778: 1, 50779: 2, 50721: 1, 50722: 2, 50723: 1, 50724: 2, 50964: 1, 50965: 2}.get(number, 3)
                extra = {f"ColorMatrix{index}": WARM, f"CalibrationIlluminant{index}": DAYLIGHT}
            elif number == 50729:
                extra = {"ColorMatrix1": WARM}
            elif number == 50727:
                extra = {"ColorMatrix1": WARM, "AsShotNeutral": NEUTRAL}
            elif number in (50931, 50932):
                extra = {"ColorMatrix1": WARM, "CameraCalibration1": CALIBRATION}
            elif number == 347:
                extra = dict(compression=7, bits=14)
            found.append(
                Rejection(f"{way}-{number}-{row.name}", damaged(shot(**extra), number, kind, count), number, [row.name], help=False)
            )
    return found


# Noted


def noted():
    found = []

    def add(name, number, word_, expected_=True, **given):
        found.append(Note(name, dng([shot(**given)]), number, word_, expected_))

    cube = [v for _ in range(8) for v in (0.0, 1.1, 0.9)]
    curve = [0.0, 0.0, 0.5, 0.7, 1.0, 1.0]
    gain_table = struct.pack("<IIddddI5f", 1, 1, 1.0, 1.0, 0.0, 0.0, 2, 0.2, 0.2, 0.2, 0.1, 0.3) + struct.pack("<2f", 1.0, 2.0)
    for name, number, value in [
        ("BaselineExposure", 50730, (SRATIONAL, [1.5])),
        ("BaselineExposureOffset", 51109, (RATIONAL, [0.5])),
        ("ProfileHueSatMapDims", 50937, (LONG, [2, 2, 2])),
        ("ProfileHueSatMapData1", 50938, (FLOAT, cube)),
        ("ProfileHueSatMapData2", 50939, (FLOAT, cube)),
        ("ProfileHueSatMapData3", 52537, (FLOAT, cube)),
        ("ProfileToneCurve", 50940, (FLOAT, curve)),
        ("ProfileLookTableDims", 50981, (LONG, [2, 2, 2])),
        ("ProfileLookTableData", 50982, (FLOAT, cube)),
        ("ProfileGainTableMap", 52525, (UNDEFINED, gain_table)),
        ("ProfileGainTableMap2", 52544, (UNDEFINED, gain_table)),
        ("RGBTables", 52543, (UNDEFINED, bytes(64))),
    ]:
        add(name, number, [name], tags={number: value})
        add(f"{name}-absent", number, [name], False)
    add("MaskedAreas", 50830, ["MaskedAreas", "black"], ActiveArea=[0, 8, 32, 48], MaskedAreas=[0, 0, 32, 8])
    add("MaskedAreas-with-black", 50830, ["MaskedAreas"], False, ActiveArea=[0, 8, 32, 48], MaskedAreas=[0, 0, 32, 8], BlackLevel=100)
    add("BaselineExposure-zero", 50730, ["BaselineExposure"], False, BaselineExposure=0)
    add("optional-opcode", 51009, ["OpcodeList2", "99"], OpcodeList2=as_list(opcode(99, b"1234", optional=True)))
    add("optional-warp2", 51022, ["OpcodeList3", "WarpRectilinear2"], OpcodeList3=as_list(opcode(14, b"1234", optional=True)))
    inner = [without_dng(shot()) for _ in range(3)]
    found.append(Note("several", dng([with_sub(*inner)]), 330, ["3", "frame"]))
    found.append(Note("one", dng([with_sub(inner[0])]), 330, ["frames"], False))
    for name, options_, given, word_ in [
        ("white-balance", ["--white-balance", "1,1,1"], {"AsShotNeutral": NEUTRAL}, "AsShotNeutral"),
        ("black", ["--black-level", "10"], {"BlackLevel": 500}, "BlackLevel"),
        ("white", ["--white-level", "60000"], {"WhiteLevel": 50000}, "WhiteLevel"),
        ("phase", ["--phase", "bggr"], {}, "CFAPattern"),
    ]:
        found.append(Note(f"option-{name}", dng([shot(**given)]), 0, [word_], True, options_))
    for case in found:
        case.number = case.number or 50728
    return found


# Cut files


def cut_files():
    yield "strips", [
        shot(strip=8, BlackLevel=[100], ColorMatrix1=WARM, AsShotNeutral=NEUTRAL, BlackLevelDeltaH=np.zeros(WIDTH))
    ], "<", False
    yield "tiles-big", [with_sub(without_dng(shot(tile=(16, 16), OpcodeList2=as_list(per_line(12, PART, [1.0] * 12)))))], ">", True
    yield "jpeg", [with_sub(without_dng(shot(bits=14, compression=7, strip=16)))], ">", False


# Files that are an error or a picture, never a crash


def strange():
    """Files of odd content, by name."""
    frame = shot(bits=32, floating=True)
    frame.stored[3, 4], frame.stored[9, 9], frame.stored[20, 21] = np.nan, np.inf, -np.inf
    yield "float-nan", dng([frame])
    nan_map = gain_map(WHOLE, [[float("nan"), 1], [1, float("inf")]], (1, 1), (0, 0))
    for number in (1, 2, 3):
        tag = f"OpcodeList{number}"
        yield f"nan-gains-{number}", dng([shot(**{tag: as_list(nan_map)})])
        yield f"nan-spacing-{number}", dng([shot(**{tag: as_list(gain_map(WHOLE, GRID, (float("nan"), 0.0), (0, 0)))})])
        yield f"nan-polynomial-{number}", dng([shot(**{tag: as_list(opcode(8, WHOLE + word(1) + doubles(float("nan"), 1)))})])
        yield f"nan-rows-{number}", dng([shot(**{tag: as_list(per_line(12, WHOLE, [float("nan")] * HEIGHT))})])
        yield f"empty-area-{number}", dng([shot(**{tag: as_list(per_line(12, area(9, 9, 9, 20), []))})])
        yield f"turned-area-{number}", dng([shot(**{tag: as_list(per_line(12, area(20, 9, 9, 20), []))})])
        yield f"far-area-{number}", dng(
            [shot(**{tag: as_list(opcode(7, area(0, 0, 2**32 - 1, 2**32 - 1, 0, 2**32 - 1, 2**31, 2**31) + table([5])))})]
        )
        yield f"no-table-{number}", dng([shot(**{tag: as_list(opcode(7, WHOLE + word(0)))})])
    for name, numbers in {"nan": [float("nan")] * 6, "large": [1e300] * 6, "zero": [0.0] * 6}.items():
        yield f"warp-{name}", dng([shot(OpcodeList3=as_list(opcode(1, word(1) + doubles(*numbers, 0.5, 0.5))))])
        yield f"fisheye-{name}", dng([shot(OpcodeList3=as_list(opcode(2, word(1) + doubles(*numbers[:4], 0.5, 0.5))))])
        yield f"vignette-{name}", dng([shot(OpcodeList3=as_list(opcode(3, doubles(*numbers[:5], 0.5, 0.5))))])
    yield "vignette-centre", dng([shot(OpcodeList3=as_list(opcode(3, doubles(0.1, 0, 0, 0, 0, float("nan"), -7))))])
    yield "all-bad", dng([shot(OpcodeList1=as_list(bad_list(0, [], [(0, 0, HEIGHT, WIDTH)])))])
    yield "bad-outside", dng([shot(OpcodeList1=as_list(bad_list(0, [(HEIGHT, 3), (2**31, 2**31)], [(5, 5, 2**31, 2**31), (9, 9, 3, 3)])))])
    yield "bad-phase", dng([shot(OpcodeList1=as_list(bad_list(9, [(3, 3)], [])))])
    for name in (
        "WhiteLevel",
        "BlackLevel",
        "DefaultCropSize",
        "DefaultUserCrop",
        "AsShotNeutral",
        "AsShotWhiteXY",
        "ColorMatrix1",
        "AnalogBalance",
        "DefaultScale",
    ):
        many = {
            "DefaultCropSize": 2,
            "DefaultUserCrop": 4,
            "AsShotNeutral": 3,
            "AsShotWhiteXY": 2,
            "ColorMatrix1": 9,
            "AnalogBalance": 3,
            "DefaultScale": 2,
        }.get(name, 1)
        extra = {} if name == "ColorMatrix1" else {"ColorMatrix1": WARM}
        yield f"division-{name}", dng([shot(**extra, **{name: ("as", (RATIONAL, [(5, 0)] * many))})])
        yield f"nothing-{name}", dng([shot(**extra, **{name: ("as", (RATIONAL, [(0, 7)] * many))})])
    deep = without_dng(shot(16, 24, light=scene(16, 24)))
    for _ in range(200):
        deep = Directory(subs=[deep], tags={"NewSubFileType": 1})
    yield "deep", dng([with_sub(deep)])
    yield "many", dng([Directory(tags={"NewSubFileType": 1}) for _ in range(3000)])
    yield "flat-tiles", dng([shot(tile=(1, 1))])
    yield "none", b""
    yield "mark", b"II*\0"


def mutated(seed):
    """A file with some bytes changed."""
    draw = np.random.default_rng(seed)
    data = bytearray(random(int(draw.integers(0, 50))).file())
    for _ in range(int(draw.integers(1, 9))):
        # Most are in the directories, at the end.
        at = int(draw.integers(0, len(data)) if draw.random() < 0.3 else len(data) - 1 - draw.integers(0, min(len(data), 500)))
        data[at] = int(draw.integers(0, 256))
    return bytes(data)


# At random


def random(seed):
    """A frame with some of everything, all tags honoured together."""
    draw = np.random.default_rng(seed)
    chance = lambda p: draw.random() < p
    phase = draw.choice(list(expected.PHASES))
    height, width = (int(v) for v in draw.integers(20, 44, 2))
    floating = chance(0.15)
    bits = int(draw.choice([16, 24, 32]) if floating else draw.choice([10, 12, 14, 16, 16, 20, 24, 32]))
    tags = {}
    area_ = [0, 0, height, width]
    if chance(0.4):
        area_ = [int(v) for v in (*draw.integers(0, 5, 2), height - draw.integers(0, 5), width - draw.integers(0, 5))]
        tags["ActiveArea"] = area_
    rows, columns = area_[2] - area_[0], area_[3] - area_[1]
    full = 1.0 if floating else float((1 << bits) - 1)
    low, high = (full * draw.uniform(0.02, 0.1), full * draw.uniform(0.7, 1.0)) if chance(0.7) else (0.0, full)
    whole = lambda v: v if floating else np.rint(v)
    table = not floating and bits <= 14 and chance(0.3)
    if table:
        length = int(draw.integers(1 << bits - 1, 1 << bits))
        values = np.rint(65535 * np.linspace(0, 1, length) ** draw.uniform(0.7, 1.2))
        tags["LinearizationTable"] = values
        low, high, full = 0.02 * 65535, 60000.0, 65535.0
    if low or table:
        repeat = [int(v) for v in draw.integers(1, 5, 2)]
        level = whole(draw.uniform(0.5, 1.0, repeat[0] * repeat[1]) * low)
        if repeat != [1, 1] or chance(0.5):
            tags["BlackLevelRepeatDim"] = repeat
        tags["BlackLevel"] = level if len(level) > 1 else level[0]
        # A fraction has a numerator of 32 bits.
        tags["WhiteLevel"] = ("as", (RATIONAL, [float(np.float32(high))])) if floating else int(high)
        if full > 2**30:
            tags["BlackLevel"] = ("as", (LONG, [int(v) for v in level]))
        if chance(0.3) and full < 2**26:
            tags["BlackLevelDeltaH"] = [float(v) for v in whole(draw.uniform(-0.3, 0.3, columns) * low)]
        if chance(0.3) and full < 2**26:
            tags["BlackLevelDeltaV"] = [float(v) for v in whole(draw.uniform(-0.3, 0.3, rows) * low)]
    if chance(0.4):
        left, top = int(draw.integers(0, 5)), int(draw.integers(0, 5))
        tags["DefaultCropOrigin"] = [left, top]
        tags["DefaultCropSize"] = [int((columns & ~1) - left - draw.integers(0, 5)), int((rows & ~1) - top - draw.integers(0, 5))]
    if chance(0.2):
        tags["DefaultUserCrop"] = [round(float(v), 3) for v in (*draw.uniform(0, 0.3, 2), *draw.uniform(0.7, 1, 2))]
    stored_colours = {}
    if chance(0.7):
        stored_colours["AsShotNeutral"] = [round(float(v), 4) for v in draw.uniform(0.6, 1, 3)]
    if chance(0.6):
        matrices = draw.choice(3) + 1
        for index in range(1, matrices + 1):
            wobble = lambda base: [round(float(v), 4) for v in np.array(base) + draw.uniform(-0.05, 0.05, 9)]
            stored_colours[f"ColorMatrix{index}"] = wobble(MIDDLE)
            if matrices > 1:
                stored_colours[f"CalibrationIlluminant{index}"] = [A, DAYLIGHT, D50][(index + seed) % 3]
            if chance(0.3):
                stored_colours[f"ForwardMatrix{index}"] = wobble(FORWARD)
            if chance(0.3):
                stored_colours[f"CameraCalibration{index}"] = wobble(CALIBRATION)
        if chance(0.3):
            stored_colours["AnalogBalance"] = [round(float(v), 3) for v in draw.uniform(0.7, 1.4, 3)]
    if chance(0.4):
        stored_colours["Orientation"] = int(draw.integers(1, 9))
    size = rows & ~1, columns & ~1
    # Results of OpcodeList1 are rounded to stored values, whose steps must be small.
    if chance(0.25) and not floating and 14 <= bits <= 16:
        tags["OpcodeList1"] = as_list(random_opcodes(draw, height, width, 1))
    if chance(0.35):
        tags["OpcodeList2"] = as_list(random_opcodes(draw, rows, columns, 1))
    if chance(0.35):
        tags["OpcodeList3"] = as_list(random_opcodes(draw, *size, 3))
    how = dict(strip=int(draw.integers(1, height + 1))) if chance(0.5) else dict(tile=(16, int(draw.choice([16, 32]))))
    if not floating and bits <= 16 and chance(0.3):
        # A tile holds pairs of columns, and so does a strip.
        width_ok = "tile" in how or width % 2 == 0
        how |= dict(compression=7, jpeg={"predictor": int(draw.integers(1, 8)), "components": 2 if width_ok else 1})
    # Not so dark that the network gives colours below 0, which a PNG cannot hold.
    light = np.maximum(scene(height, width, phase, seed) * 0.7, 0.1)
    stored_high = float(length) if table else high
    made = shot(height, width, bits, phase, 0.0 if table else low, stored_high, light, floating, **how, **tags)
    order, big = draw.choice(["<", ">"]), chance(0.2)
    # Clipped light of a strong gain is full, and then rounding differs by a little more.
    limit = 0.004
    if chance(0.4):
        inner = without_dng(made)
        return Case(f"random-{seed}", (), inner, [with_sub(inner, **stored_colours)], order, big, stored_colours, tolerance=limit)
    made.tags |= stored_colours
    return Case(f"random-{seed}", (), made, None, order, big, tolerance=limit)


def random_opcodes(draw, height, width, planes):
    data = b""
    for _ in range(int(draw.integers(1, 4))):
        top, left = (int(v) for v in draw.integers(0, 6, 2))
        pitch = [int(v) for v in draw.integers(1, 4, 2)]
        bottom, right = height - int(draw.integers(0, 6)), width - int(draw.integers(0, 6))
        first = int(draw.integers(0, planes))
        place = area(top, left, bottom, right, first, int(draw.integers(1, planes - first + 1)), *pitch)
        kind = draw.choice(["gain", "scale-row", "scale-column", "table"])
        if kind == "gain":
            points = [int(v) for v in draw.integers(1, 6, 2)]
            maps = int(draw.integers(1, 4)) if planes > 1 else 1
            data += gain_map(
                place, draw.uniform(0.7, 1.1, (*points, maps)), tuple(draw.uniform(0.1, 0.5, 2)), tuple(draw.uniform(0, 0.3, 2)), maps
            )
        elif kind == "table":
            data += opcode(7, place + table(np.rint(65535 * np.linspace(0, 1, 65536) ** draw.uniform(0.9, 1.2))))
        else:
            row = kind == "scale-row"
            count = -(-(bottom - top) // pitch[0]) if row else -(-(right - left) // pitch[1])
            data += per_line(12 if row else 13, place, list(draw.uniform(0.8, 1.1, count)))
    return data
