"""PNG of 16 bits: grey mosaics are written, pictures in RGB are read (PNG specification)."""

import struct
import zlib

import numpy as np


def write_png(path, words):
    height, width = words.shape
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in words)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


def read_png(path):
    """Numbers 0 to 1 of a picture of 16-bit RGB (PNG specification, filters 0 to 4)."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height, depth, colour, *_, interlace = struct.unpack_from(">IIBBBBB", data, at + 8)
            assert (depth, colour, interlace) == (16, 2, 0), path
        if kind == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    lines = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 6 * width)
    above, out = np.zeros((width, 6), np.uint8), []
    for line in lines:
        row = line[1:].reshape(width, 6).copy()
        if line[0] == 1:
            row = np.cumsum(row, axis=0, dtype=np.uint8)
        elif line[0] == 2:
            row += above
        elif line[0] in (3, 4):
            left = corner = np.zeros(6, np.int64)
            for x in range(width):
                up = above[x].astype(np.int64)
                if line[0] == 3:
                    guess = (left + up) // 2
                else:
                    base = left + up - corner
                    a, b, c = abs(base - left), abs(base - up), abs(base - corner)
                    guess = np.where((a <= b) & (a <= c), left, np.where(b <= c, up, corner))
                row[x] += guess.astype(np.uint8)
                left, corner = row[x].astype(np.int64), up
        above = row
        out.append(row)
    return np.stack(out).reshape(height, width, 3, 2).copy().view(">u2")[..., 0].astype(np.float64) / 65535
