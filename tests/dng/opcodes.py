"""Bytes of opcodes (DNG specification, chapter 7)."""

import struct

import numpy as np

from scenes import HEIGHT, WIDTH
from write import area, opcode


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


def counted(data):
    """Number of the opcodes in a row of them."""
    number, at = 0, 0
    while at < len(data):
        at += 16 + struct.unpack_from(">I", data, at + 12)[0]
        number += 1
    return number


def as_list(data):
    return word(counted(data)) + data
