"""DNGs at random, with some of everything."""

import numpy as np

import expected
from opcodes import as_list, gain_map, per_line, table
from scenes import A, CALIBRATION, Case, D50, DAYLIGHT, FORWARD, MIDDLE, scene, shot, with_sub, without_dng
from write import LONG, RATIONAL, area, opcode


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
