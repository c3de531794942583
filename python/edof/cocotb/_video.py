"""Video into and out of a core: raw frames as pixels on the camera's bus, codes from the screen's."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from cocotb.triggers import RisingEdge
from numpy.typing import NDArray

import edof

from ._chain import Mismatch

# A pixel that is not shown, on the camera's bus.
BLANK = 0x5A5A
# The code that the screen shows until there is a picture: Y = 16, C = 128.
BLACK = 0x8010


class VideoSource:
    """Sends frames with separate syncs on `input_hs_i`, `input_vs_i`, `input_de_i` and `input_data_i`, the last one again and again.

    `frames` are raw frames (rows x columns) of `bit_depth` bits. The blanking is short: 16 pixels a line and 8 lines a frame.
    """

    def __init__(self, dut: Any, clock: Any, frames: Sequence[NDArray[np.uint16]], *, bit_depth: int = 16) -> None:
        self.dut, self.clock = dut, clock
        self.pixels = [edof.cable_pixels(frame, bit_depth=bit_depth) for frame in frames]

    @staticmethod
    def cycles(rows: int, columns: int) -> int:
        """Cycles of the camera's clock in a frame."""
        return (rows + 8) * (columns + 16)

    async def run(self) -> None:
        """Sends until the simulation ends. It begins behind a picture, so that the first frame has its sync before it."""
        dut, (rows, columns) = self.dut, self.pixels[0].shape
        index, row = -1, rows
        syncs = (0, 0)
        while True:
            for column in range(columns + 16):
                shown = row < rows and column < columns
                hs = int(columns + 4 <= column < columns + 10)
                if column == columns + 4:
                    syncs = (hs, int(rows + 2 <= row < rows + 4))
                dut.input_hs_i.value = hs
                dut.input_vs_i.value = syncs[1]
                dut.input_de_i.value = int(shown)
                dut.input_data_i.value = int(self.pixels[index][row, column]) if shown else BLANK
                await RisingEdge(self.clock)
            row += 1
            if row == rows + 8:
                row, index = 0, min(index + 1, len(self.pixels) - 1)


class VideoSink:
    """Watches `screen_vs_o`, `screen_de_o` and `screen_data_o`, and holds every frame against the pictures that must come.

    Frames must be black before the first picture, and then the pictures in order; one may be shown again. `pictures` are those of `edof.board_picture`.
    """

    def __init__(self, dut: Any, clock: Any, pictures: Sequence[edof.BoardPicture]) -> None:
        self.dut, self.clock = dut, clock
        self.expected = [picture.yuyv().view("<u2") for picture in pictures]
        self.shape = pictures[0].y_code.shape
        self.shown = 0
        self.frames = 0

    async def run(self) -> None:
        """Watches until the last picture was shown."""
        pixels: list[int] = []
        before = 1
        while self.shown < len(self.expected):
            await RisingEdge(self.clock)
            sync = self.dut.screen_vs_o.value
            if not sync.is_resolvable:
                continue
            if int(self.dut.screen_de_o.value):
                data = self.dut.screen_data_o.value
                pixels.append(int(data) if data.is_resolvable else -1)
            if int(sync) and not before:
                self._frame(np.array(pixels, np.int64))
                pixels = []
            before = int(sync)

    def _frame(self, pixels: NDArray[np.int64]) -> None:
        if len(pixels) == 0:
            return
        self.frames += 1
        if self.shown == 0 and (pixels == BLACK).all():
            return
        again = self.expected[self.shown - 1] if self.shown else None
        due = self.expected[self.shown]
        if len(pixels) == len(due) and (pixels == due).all():
            self.shown += 1
            return
        if again is not None and len(pixels) == len(again) and (pixels == again).all():
            return
        if len(pixels) != len(due):
            raise Mismatch(f"frame {self.frames}: {len(pixels)} pixels, expected {len(due)}")
        at = int(np.argmax(pixels != due))
        row, column = divmod(at, self.shape[1])
        raise Mismatch(
            f"frame {self.frames}, picture {self.shown}, row {row}, column {column}: expected 0x{due[at]:04x}, got 0x{pixels[at] & 0xFFFF:04x}"
        )
