"""DNGs that are cut, of odd content, or with bytes changed."""

import numpy as np

from opcodes import GRID, PART, WHOLE, as_list, bad_list, doubles, gain_map, per_line, table, word
from random_shots import random
from scenes import HEIGHT, NEUTRAL, WARM, WIDTH, scene, shot, with_sub, without_dng
from write import Directory, RATIONAL, area, dng, opcode


def cut_files():
    yield "strips", [
        shot(strip=8, BlackLevel=[100], ColorMatrix1=WARM, AsShotNeutral=NEUTRAL, BlackLevelDeltaH=np.zeros(WIDTH))
    ], "<", False
    yield "tiles-big", [with_sub(without_dng(shot(tile=(16, 16), OpcodeList2=as_list(per_line(12, PART, [1.0] * 12)))))], ">", True
    yield "jpeg", [with_sub(without_dng(shot(bits=14, compression=7, strip=16)))], ">", False


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
