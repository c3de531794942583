"""DNGs with each opcode in each list that may hold it."""

import struct

import numpy as np

import expected
from opcodes import GRID, PART, WHOLE, as_list, bad_list, doubles, gain_map, per_line, table, word
from scenes import Case, HEIGHT, LARGE, NEUTRAL, ROUND, WARM, WIDTH, scene, shot
from write import area, opcode


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
    # The numbers of the specification, then those of Adobe's SDK and of Android.
    for order in (("rggb", "grbg", "gbrg", "bggr"), ("grbg", "rggb", "bggr", "gbrg")):
        for phase_number, phase in enumerate(order):
            light = scene(phase=phase, flat=True)
            light[9, 13] = light[14, 14] = light[20, 23] = light[25, 30] = light[0, 0] = light[31, 47] = 0.9
            data = bad_list(phase_number, [(9, 13), (14, 14), (20, 23), (25, 30), (0, 0), (31, 47)], [])
            name = f"list{number}-bad-phase-{phase}-{phase_number}"
            yield Case(name, (row,), shot(light=light, phase=phase, **{f"OpcodeList{number}": as_list(data)}))
    light = np.roll(scene(flat=True), (1, 1), (0, 1))
    light[9, 13] = light[14, 14] = light[20, 23] = 0.9
    data = as_list(bad_list(1, [(9, 13), (14, 14), (20, 23)], []))
    if number == 1:
        yield Case("list1-bad-area", (row,), shot(light=light, ActiveArea=[1, 1, 31, 47], OpcodeList1=data))


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
