"""DNGs that are an error or make a note, with the words of it."""

import struct
from dataclasses import replace

import numpy as np

from opcodes import WHOLE, as_list, bad_list, doubles, floats, per_line, word
from scenes import A, CALIBRATION, DAYLIGHT, HEIGHT, NEUTRAL, Note, OTHER, Rejection, WARM, WIDTH, preview, scene, shot, with_sub, without_dng
from write import FLOAT, LONG, RATIONAL, SHORT, SRATIONAL, TAGS, UNDEFINED, area, dng, opcode


OF_SRGB = [3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570]


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
    add("white-infinite", 50717, ["WhiteLevel", "white level"], base(WhiteLevel=("as", (RATIONAL, [(1, 0)]))))
    add("analog-zero", 50727, ["AnalogBalance", "colour matrix"], base(AnalogBalance=[0, 1, 1], ColorMatrix1=WARM))
    add("calibration-singular", 50723, ["CameraCalibration1", "colour matrix"], base(CameraCalibration1=[0.0] * 9, ColorMatrix1=WARM))
    add("white-xy-zero", 50729, ["AsShotWhiteXY", "white balance"], base(AsShotWhiteXY=[0, 0], ColorMatrix1=WARM))
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
    both = {"ColorMatrix1": OF_SRGB, "ColorMatrix2": OF_SRGB, "CalibrationIlluminant1": A, "CalibrationIlluminant2": DAYLIGHT}
    # What a sensor with the colours of linear sRGB sees of standard illuminant A and of D65.
    add("tungsten", 0, ["2900 K", "2850 K", "6504 K"], **both, AsShotNeutral=[1.8452, 0.8263, 0.2333])
    add("daylight", 0, [" K,"], False, **both, AsShotNeutral=[1, 1, 1])
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
    return found
