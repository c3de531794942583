"""A client of an edof board, written from docs/host.md alone: reads the id, writes a row of weights and reads it back.

Usage: board_client.py PORT, and on standard input a JSON object with the values of the C header.
"""

import json
import os
import select
import struct
import sys
import termios
import tty
import zlib


class Board:
    def __init__(self, port):
        self.line = os.open(port, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.line)
        termios.tcflush(self.line, termios.TCIOFLUSH)

    def read(self, address, count=1):
        os.write(self.line, struct.pack(">BBI", 2, count, address // 4))
        answer = b""
        while len(answer) < 4 * count:
            if not select.select([self.line], [], [], 20)[0]:
                sys.exit(f"no answer from 0x{address:x}")
            answer += os.read(self.line, 4 * count - len(answer))
        return list(struct.unpack(f">{count}I", answer))

    def write(self, address, *words):
        os.write(self.line, struct.pack(f">BBI{len(words)}I", 1, len(words), address // 4, *words))


def word(stage, space, bank, row, half):
    return ((((stage << 2 | space) << 6 | bank) << 12 | row) << 1 | half) * 4


def checked(half):
    return half | (~half & 0xFFFF) << 16


def main():
    header = json.load(sys.stdin)
    board = Board(sys.argv[1])
    identity = board.read(header["EDOF_ID"])[0]
    assert identity == header["EDOF_ID_VALUE"] == 0x45444F46, hex(identity)
    board.write(header["EDOF_SCRATCH"], 0x12345678)
    assert board.read(header["EDOF_SCRATCH"]) == [0x12345678]
    stage, bank, row = 1, 1, 20
    halves = [0x01234567, 0x89ABCDEF]
    at = header["EDOF_WEIGHTS"]
    # The row is one of the bank in use, which takes words only without its protection.
    refused = board.read(header["EDOF_WRITES_REFUSED"])[0]
    board.write(at + word(stage, 0, bank, row, 0), *halves)
    assert board.read(header["EDOF_WRITES_REFUSED"]) == [refused + 2]
    board.write(header["EDOF_PROTECTION"], checked(~header["EDOF_PROTECTION_BANK_MASK"] & 1))
    assert board.read(header["EDOF_PROTECTION"]) == [0]
    board.write(at + word(stage, 0, bank, row, 0), *halves)
    assert board.read(header["EDOF_WRITES_REFUSED"]) == [refused + 2]
    board.write(at + word(stage, 3, 0, 3, 0), bank << 24 | row << 12)
    reads = header["EDOF_STAGE_READS"] + 16 * stage
    while board.read(reads + 12) != [0]:
        pass
    crc, low, high, _ = board.read(reads, 4)
    assert [low, high] == halves, (low, high)
    assert crc == zlib.crc32(struct.pack("<2I", *halves)), hex(crc)
    print(f"id {identity:08x}, row {low:08x} {high:08x}, CRC {crc:08x}")


main()
