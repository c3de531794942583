"""What a DNG means, in NumPy from the specification (chapters 2, 5, 6 and 7) and docs/dng.md. A shot is a `write.Directory`."""

import struct
from math import sqrt

import numpy as np

from write import from_fp24, fp24, fraction

PHASES = {"rggb": (0, 1, 1, 2), "grbg": (1, 0, 2, 1), "gbrg": (1, 2, 0, 1), "bggr": (2, 1, 1, 0)}


def values(tags, name, default):
    """A tag's values as the file holds them: fractions rounded as written."""
    if name not in tags:
        return default
    given = tags[name]
    if isinstance(given, tuple) and len(given) == 2 and given[0] == "as":
        given = given[1][1]
    if isinstance(given, bytes):
        return list(given)
    given = list(given) if np.ndim(given) or isinstance(given, (list, tuple)) else [given]
    return [v[0] / v[1] if isinstance(v, tuple) else fraction(v)[0] / fraction(v)[1] for v in given]


def stored_values(shot):
    """Values as the file holds them, and the largest that it can hold."""
    if shot.stored.dtype.kind != "f":
        return shot.stored.astype(np.float64), (1 << (8 if shot.bits <= 8 else 16 if shot.bits <= 16 else 32)) - 1
    if shot.bits == 24:
        return np.vectorize(lambda v: from_fp24(fp24(float(v))))(shot.stored), 1.0
    return shot.stored.astype(f"f{shot.bits // 8}").astype(np.float64), 1.0


def linearised(shot):
    """Values of the whole picture after OpcodeList1 and LinearizationTable."""
    stored, largest = stored_values(shot)
    stored = plane_opcodes(stored, shot, "OpcodeList1", largest)
    if "LinearizationTable" in shot.tags:
        table = np.array(values(shot.tags, "LinearizationTable", None))
        stored = table[np.minimum(np.rint(stored), len(table) - 1).astype(int)]
    return stored


def active_area(shot):
    height, width = shot.stored.shape
    return [int(v) for v in values(shot.tags, "ActiveArea", [0, 0, height, width])]


def black_levels(shot, size):
    height, width = size
    rows, columns = (int(v) for v in values(shot.tags, "BlackLevelRepeatDim", [1, 1]))
    level = np.array(values(shot.tags, "BlackLevel", [0] * (rows * columns))).reshape(rows, columns)
    black = np.tile(level, (height // rows + 1, width // columns + 1))[:height, :width]
    black = black + np.array(values(shot.tags, "BlackLevelDeltaH", [0] * width))[None, :]
    return black + np.array(values(shot.tags, "BlackLevelDeltaV", [0] * height))[:, None]


def white_level(shot):
    default = 1.0 if shot.stored.dtype.kind == "f" else (1 << shot.bits) - 1
    return values(shot.tags, "WhiteLevel", [default])[0]


def light(shot):
    """Light of the active area, 0 to 1, as the network gets it."""
    top, left, bottom, right = active_area(shot)
    part = linearised(shot)[top:bottom, left:right]
    black = black_levels(shot, part.shape)
    scaled = np.clip((part - black) / (white_level(shot) - black.max()), 0, 1)
    scaled = plane_opcodes(scaled, shot, "OpcodeList2", 1.0)
    height, width = (side & ~1 for side in part.shape)
    return scaled[:height, :width]


def phase(shot):
    """Name of the mosaic, by the planes that CFAPlaneColor lists."""
    pattern = [int(v) for v in values(shot.tags, "CFAPattern", [0, 1, 1, 2])]
    return next(name for name, cells in PHASES.items() if list(cells) == pattern)


# Opcodes

NEWEST = 0x01070100


def opcodes(data):
    count, at = struct.unpack_from(">I", data)[0], 4
    for _ in range(count):
        number, version, flags, length = struct.unpack_from(">4I", data, at)
        if version <= NEWEST:
            yield number, flags, data[at + 16 : at + 16 + length]
        at += 16 + length


class Area:
    """Pixels that an opcode changes: rows, columns and planes, with the rest of its data."""

    def __init__(self, data, size):
        top, left, bottom, right, self.plane, self.planes, row_pitch, column_pitch = struct.unpack_from(">8I", data)
        self.rows = np.arange(top, min(bottom, size[0]), row_pitch)
        self.columns = np.arange(left, min(right, size[1]), column_pitch)
        self.at, self.rest = np.ix_(self.rows, self.columns), data[32:]


def mapped(number, pixels, area, size, delta_unit, table_scale, plane):
    """Pixels of an area after an opcode of 7 to 13."""
    rest = area.rest
    if number == 7:
        table = np.frombuffer(rest, ">u2", struct.unpack_from(">I", rest)[0], 4).astype(np.float64)
        return table[np.minimum(np.rint(pixels * table_scale), len(table) - 1).astype(int)] / table_scale
    if number == 8:
        degree = struct.unpack_from(">I", rest)[0]
        return np.polynomial.polynomial.polyval(pixels, np.frombuffer(rest, ">f8", degree + 1, 4))
    if number == 9:
        return pixels * gains(rest, area, size, plane)
    factors = np.frombuffer(rest, ">f4", struct.unpack_from(">I", rest)[0], 4).astype(np.float64)
    factors = factors[: len(area.rows), None] if number in (10, 12) else factors[None, : len(area.columns)]
    return pixels + factors * delta_unit if number in (10, 11) else pixels * factors


def gains(rest, area, size, plane):
    """Bilinear gains at the centres of pixels; beyond the map its edge."""
    points_v, points_h, space_v, space_h, first_v, first_h, planes = struct.unpack_from(">IIddddI", rest)
    grid = np.frombuffer(rest, ">f4", points_v * points_h * planes, 44).reshape(points_v, points_h, planes)
    grid = grid[:, :, min(plane, planes - 1)].astype(np.float64)

    def between(places, length, first, space, points):
        index = np.clip(((places + 0.5) / length - first) / space, 0, points - 1)
        low = np.minimum(index.astype(int), max(points - 2, 0))
        return low, np.minimum(low + 1, points - 1), index - low

    top, bottom, down = between(area.rows, size[0], first_v, space_v, points_v)
    left, right, across = between(area.columns, size[1], first_h, space_h, points_h)
    rows = grid[top] * (1 - down)[:, None] + grid[bottom] * down[:, None]
    return rows[:, left] * (1 - across) + rows[:, right] * across


def plane_opcodes(pixels, shot, name, largest):
    """Opcodes of lists 1 and 2, on a mosaic of values up to `largest`."""
    first, integer = name == "OpcodeList1", shot.stored.dtype.kind != "f"
    for number, _, data in opcodes(shot.tags.get(name, bytes(4))):
        pixels = pixels.copy()
        if number in (4, 5):
            unit = 1 if first and integer else 65535
            top, left = active_area(shot)[:2] if first else (0, 0)
            repair(pixels, number, data, unit, np.roll(np.reshape(PHASES[phase(shot)], (2, 2)), (top, left), (0, 1)))
        elif number == 3:
            pixels *= vignette(data, pixels.shape)
        elif 7 <= number <= 13:
            area = Area(data, pixels.shape)
            if area.plane == 0 and area.planes:
                delta = 1.0 if first or not integer else 1 / 65535
                table = 1.0 if first and integer else 65535.0
                pixels[area.at] = mapped(number, pixels[area.at], area, pixels.shape, delta, table, 0)
        pixels = np.clip(pixels, 0, largest)
        if first and integer:
            pixels = np.rint(pixels)
    return pixels


def repair(pixels, number, data, unit, cells):
    """Gives bad pixels the median of the nearest good ones of their colour: cells of one colour are two apart, greens also on diagonals.
    Good ones count at most 4 rows and columns away (docs/sensor.md, 3)."""
    height, width = pixels.shape
    bad = np.zeros(pixels.shape, bool)
    if number == 4:
        constant = struct.unpack_from(">I", data)[0]
        bad |= np.rint(pixels * unit) == constant
    else:
        _, points, rectangles = struct.unpack_from(">III", data)
        for index in range(points):
            bad[struct.unpack_from(">II", data, 12 + 8 * index)] = True
        for index in range(rectangles):
            top, left, bottom, right = struct.unpack_from(">4I", data, 12 + 8 * points + 16 * index)
            bad[top:bottom, left:right] = True
    # The phase of the opcode is passed over: writers number phases in two ways, and the pattern states the same.
    colours = np.tile(cells, (height // 2 + 1, width // 2 + 1))[:height, :width]
    source = pixels.copy()
    rows, columns = np.indices(pixels.shape)
    for row, column in np.argwhere(bad):
        in_reach = (abs(rows - row) <= 4) & (abs(columns - column) <= 4)
        good = ~bad & (colours == colours[row, column]) & in_reach
        if good.any():
            distance = (rows - row) ** 2 + (columns - column) ** 2
            nearest = good & (distance == distance[good].min())
            pixels[row, column] = np.median(source[nearest])


def centred(size, centre):
    """Distances of pixels from the centre, in parts of the distance to the farthest corner."""
    height, width = size
    x0, y0 = centre[0] * (width - 1), centre[1] * (height - 1)
    far = max(sqrt((x - x0) ** 2 + (y - y0) ** 2) for x in (0, width - 1) for y in (0, height - 1))
    rows, columns = np.indices(size)
    return (columns - x0) / far, (rows - y0) / far, far, x0, y0


def vignette(data, size):
    *k, cx, cy = struct.unpack_from(">7d", data)
    x, y, *_ = centred(size, (cx, cy))
    squared = x * x + y * y
    return 1 + sum(weight * squared ** (power + 1) for power, weight in enumerate(k))


def warp(number, data, picture):
    """WarpRectilinear (1) and WarpFisheye (2): each pixel comes from where the opcode places it."""
    planes, length = struct.unpack_from(">I", data)[0], 6 if number == 1 else 4
    numbers = struct.unpack_from(f">{planes * length + 2}d", data, 4)
    result = np.empty_like(picture)
    for plane in range(3):
        k = numbers[length * min(plane, planes - 1) :][:length]
        x, y, far, x0, y0 = centred(picture.shape[:2], numbers[-2:])
        squared = x * x + y * y
        if number == 1:
            ratio = k[0] + k[1] * squared + k[2] * squared**2 + k[3] * squared**3
            from_x = x * ratio + k[4] * 2 * x * y + k[5] * (squared + 2 * x * x)
            from_y = y * ratio + k[5] * 2 * x * y + k[4] * (squared + 2 * y * y)
        else:
            radius = np.sqrt(squared)
            angle = np.arctan(radius)
            bent = angle * (k[0] + k[1] * angle**2 + k[2] * angle**4 + k[3] * angle**6)
            ratio = np.divide(bent, radius, out=np.full_like(bent, k[0]), where=radius > 1e-9)
            from_x, from_y = x * ratio, y * ratio
        result[..., plane] = cubic(picture[..., plane], from_y * far + y0, from_x * far + x0)
    return result


def cubic(plane, rows, columns):
    """Catmull-Rom interpolation; beyond the edge its pixels."""
    height, width = plane.shape
    rows, columns = np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)
    top, left = np.floor(rows).astype(int), np.floor(columns).astype(int)

    def weights(t):
        return [((2 - t) * t - 1) * t / 2, ((3 * t - 5) * t * t + 2) / 2, ((4 - 3 * t) * t + 1) * t / 2, (t - 1) * t * t / 2]

    down, across = weights(rows - top), weights(columns - left)
    total = np.zeros(plane.shape)
    for i in range(4):
        for j in range(4):
            total += down[i] * across[j] * plane[np.clip(top + i - 1, 0, height - 1), np.clip(left + j - 1, 0, width - 1)]
    return total


def picture_opcodes(picture, shot):
    """Opcodes of list 3, on a picture of camera colours."""
    for number, _, data in opcodes(shot.tags.get("OpcodeList3", bytes(4))):
        picture = picture.copy()
        if number in (1, 2):
            picture = warp(number, data, picture)
        elif number == 3:
            picture *= vignette(data, picture.shape[:2])[..., None]
        elif 7 <= number <= 13:
            delta = 1.0 if shot.stored.dtype.kind == "f" else 1 / 65535
            area = Area(data, picture.shape[:2])
            for plane in range(area.plane, min(area.plane + area.planes, 3)):
                part = picture[..., plane]
                part[area.at] = mapped(number, part[area.at], area, part.shape, delta, 65535.0, plane)
        picture = np.clip(picture, 0, 1)
    return picture


# Colours

D65, D50 = np.array([0.95047, 1.0, 1.08883]), np.array([0.96422, 1.0, 0.82521])


def xyz_from_srgb():
    """From the primaries of ITU-R BT.709 and D65."""
    corners = np.array([[x / y, 1, (1 - x - y) / y] for x, y in ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))]).T
    return corners * np.linalg.solve(corners, D65)


def bradford(source, target):
    cones = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
    return np.linalg.inv(cones) @ np.diag((cones @ target) / (cones @ source)) @ cones


TEMPERATURES = {
    1: 5500,
    2: 4150,
    3: 2850,
    4: 5500,
    9: 5500,
    10: 6500,
    11: 7500,
    12: 6400,
    13: 5050,
    14: 4150,
    15: 3525,
    16: 2925,
    17: 2850,
    18: 5500,
    19: 6500,
    20: 5500,
    21: 6500,
    22: 7500,
    23: 5000,
    24: 3200,
}


def temperature(shot_tags, index, order):
    code = int(values(shot_tags, f"CalibrationIlluminant{index}", [0])[0])
    if code != 255:
        return TEMPERATURES.get(code)
    data = shot_tags.get(f"IlluminantData{index}", b"\0\1")
    if struct.unpack_from(order + "H", data)[0] != 0:
        return None
    a, b, c, d = struct.unpack_from(order + "4I", data, 2)
    n = (a / b - 0.3320) / (c / d - 0.1858)
    # McCamy's formula.
    return -449 * n**3 + 3525 * n**2 - 6823.3 * n + 5520.33


def calibration(tags, order):
    """Index of the calibration nearest to D65, by 1/T; the second of those without illuminants."""
    present = [i for i in (1, 2, 3) if f"ColorMatrix{i}" in tags or f"ForwardMatrix{i}" in tags]
    known = [(abs(1 / temperature(tags, i, order) - 1 / 6504), i) for i in present if temperature(tags, i, order)]
    if known:
        return min(known)[1]
    return None if not present else present[min(1, len(present) - 1)]


def rendering(tags, order="<"):
    """White balance and matrix to linear sRGB, each None where the file has none."""
    square = lambda name: np.array(values(tags, name, np.eye(3).ravel().tolist())).reshape(3, 3)
    index = calibration(tags, order)
    signature = lambda name: bytes(tags.get(name, b"")).rstrip(b"\0")
    paired = signature("CameraCalibrationSignature") == signature("ProfileCalibrationSignature")
    own = square(f"CameraCalibration{index}") if paired and index else np.eye(3)
    own = np.diag(values(tags, "AnalogBalance", [1, 1, 1])) @ own
    neutral = None
    if "AsShotNeutral" in tags:
        neutral = np.array(values(tags, "AsShotNeutral", None))
    elif "AsShotWhiteXY" in tags and f"ColorMatrix{index}" in tags:
        x, y = values(tags, "AsShotWhiteXY", None)
        neutral = own @ square(f"ColorMatrix{index}") @ np.array([x / y, 1, (1 - x - y) / y])
    balance = None if neutral is None else 1 / neutral
    scaled = lambda matrix: matrix / matrix.sum(axis=1, keepdims=True)
    matrix = None
    if index and f"ForwardMatrix{index}" in tags:
        n = np.ones(3) if neutral is None else neutral
        reference = np.linalg.solve(own, n)
        to_srgb = np.linalg.inv(xyz_from_srgb()) @ bradford(D50, D65)
        matrix = to_srgb @ square(f"ForwardMatrix{index}") @ np.diag(1 / reference) @ np.linalg.inv(own) @ np.diag(n)
        matrix = scaled(matrix)
    elif index:
        matrix = np.linalg.inv(scaled(own @ square(f"ColorMatrix{index}") @ xyz_from_srgb()))
    return balance, matrix


def rendered(picture, balance, matrix):
    """Camera colours in those of a screen: the smallest factor of the balance counts as 1, and full stays full."""
    if balance is not None:
        picture = np.minimum(picture * (balance / balance.min()), np.maximum(picture, 1.0))
    return picture if matrix is None else picture @ matrix.T


# Geometry


def nearest(value):
    return int(np.floor(value + 0.5))


def cropped(picture, shot):
    """The default crop of the active area, then the user's of that; what the cut to whole cells has taken from the area is missing."""
    top, left, bottom, right = active_area(shot)
    x, y = (nearest(v) for v in values(shot.tags, "DefaultCropOrigin", [0, 0]))
    across, down = (nearest(v) for v in values(shot.tags, "DefaultCropSize", [right - left - x, bottom - top - y]))
    upper, first, lower, last = values(shot.tags, "DefaultUserCrop", [0, 0, 1, 1])
    return picture[y + nearest(upper * down) : y + nearest(lower * down), x + nearest(first * across) : x + nearest(last * across)]


def turned(picture, orientation):
    """By TIFF's Orientation: where the first row and the first column of the stored picture are seen."""
    return {
        1: lambda p: p,
        2: lambda p: p[:, ::-1],
        3: lambda p: p[::-1, ::-1],
        4: lambda p: p[::-1],
        5: lambda p: p.transpose(1, 0, 2),
        6: lambda p: p.transpose(1, 0, 2)[:, ::-1],
        7: lambda p: p[::-1, ::-1].transpose(1, 0, 2),
        8: lambda p: p.transpose(1, 0, 2)[::-1],
    }[orientation](picture)


def finished(reconstructed, shot, colours=None, order="<"):
    """The picture that a reconstruction of `light` becomes. `colours` are the tags of the first directory, if it is another."""
    colours = shot.tags | (colours or {})
    picture = cropped(picture_opcodes(reconstructed, shot), shot)
    picture = np.clip(rendered(picture, *rendering(colours, order)), 0, 1)
    return turned(picture, int(values(colours, "Orientation", [1])[0]))
