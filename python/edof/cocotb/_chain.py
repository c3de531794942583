"""Streams of a chain, and every boundary against the cycle model."""

from __future__ import annotations

from typing import Any, Optional, Sequence

import numpy as np
from cocotb.triggers import RisingEdge
from numpy.typing import NDArray

import edof

# Cycles that a chain's reset is held.
RESET = 64


class Mismatch(AssertionError):
    """The first thing that a design does otherwise than the model."""


def windows(raw: NDArray[np.uint16], network: edof.FixedNetwork, **frame: Any) -> NDArray[np.int16]:
    """Windows of a raw frame in the order in which the hardware takes them: count x pixels, words 0 to 32767."""
    words = edof.words(raw, network, **frame)["y"]
    return np.ascontiguousarray(words.reshape(-1, words.shape[2]))


def patch_words(raw: NDArray[np.uint16], network: edof.FixedNetwork, **frame: Any) -> NDArray[np.int16]:
    """Patches of a raw frame that the chain must give for its windows: count x 128 words."""
    words = edof.words(raw, network, **frame)["f"]
    return np.ascontiguousarray(words.reshape(-1, words.shape[2]))


def two_words(value: Any) -> tuple[int, int]:
    """The two signed words of a beat of 32 bits, the even one first."""
    bits = int(value)
    low, high = bits & 0xFFFF, bits >> 16 & 0xFFFF
    return low - (low >> 15 << 16), high - (high >> 15 << 16)


def beat(even: int, odd: int) -> int:
    """Two words as a beat of 32 bits."""
    return (int(odd) & 0xFFFF) << 16 | int(even) & 0xFFFF


async def reset_chain(dut: Any, clock: Any) -> None:
    """Resets a chain and leaves every input idle. The next rising edge of the clock is cycle 0."""
    for name in ("flush_i", "window_valid_i", "window_data_i", "window_last_i", "window_set_i", "patch_ready_i",
                 "write_valid_i", "write_address_i", "write_data_i", "status_address_i"):  # fmt: skip
        getattr(dut, name).value = 0
    dut.reset_i.value = 0
    await RisingEdge(clock)
    dut.reset_i.value = 1
    for _ in range(RESET):
        await RisingEdge(clock)
    dut.reset_i.value = 0
    # Two more pass until something can be taken.
    for _ in range(2):
        await RisingEdge(clock)


class StreamSource:
    """Sends beats of two words. While none is pending the next is offered in the first cycle in which `go` is set, and stays until it is taken."""

    def __init__(self, dut: Any, clock: Any, prefix: str, go: Optional[Sequence[bool]] = None) -> None:
        self.clock = clock
        self.valid = getattr(dut, f"{prefix}_valid_i")
        self.ready = getattr(dut, f"{prefix}_ready_o")
        self.data = getattr(dut, f"{prefix}_data_i")
        self.last = getattr(dut, f"{prefix}_last_i")
        self.go = go

    def _goes(self, cycle: int) -> bool:
        return self.go is None or bool(self.go[cycle])

    async def send(self, vectors: NDArray[np.int16]) -> None:
        """Sends vectors (count x words) one after the other, from cycle 0 on: to be started before the first edge after reset."""
        beats = [(row, element) for row in range(len(vectors)) for element in range(0, vectors.shape[1], 2)]
        cycle, index, pending = 0, 0, False
        while index < len(beats):
            pending = pending or self._goes(cycle)
            self.valid.value = int(pending)
            if pending:
                row, element = beats[index]
                self.data.value = beat(vectors[row, element], vectors[row, element + 1])
                self.last.value = int(element + 2 == vectors.shape[1])
            await RisingEdge(self.clock)
            cycle += 1
            if pending and int(self.ready.value):
                index, pending = index + 1, False
        self.valid.value = 0


class StreamSink:
    """Takes beats in exactly the cycles in which `go` is set; `words` are those that came."""

    def __init__(self, dut: Any, clock: Any, prefix: str, go: Optional[Sequence[bool]] = None) -> None:
        self.clock = clock
        self.valid = getattr(dut, f"{prefix}_valid_o")
        self.ready = getattr(dut, f"{prefix}_ready_i")
        self.data = getattr(dut, f"{prefix}_data_o")
        self.last = getattr(dut, f"{prefix}_last_o")
        self.go = go
        self.words: list[int] = []

    async def take(self, beats: int) -> NDArray[np.int16]:
        """Takes so many beats, from cycle 0 on: to be started before the first edge after reset."""
        cycle = 0
        while len(self.words) < 2 * beats:
            goes = self.go is None or bool(self.go[cycle])
            self.ready.value = int(goes)
            await RisingEdge(self.clock)
            cycle += 1
            if goes and int(self.valid.value):
                self.words += two_words(self.data.value)
        self.ready.value = 0
        return np.array(self.words, np.int16)


class ChainScoreboard:
    """Compares every boundary of a chain with `Design.cycles`: words, base words, marks of the last beat, and the cycle of each beat.

    With `timed=False` only what passes and in which order, for sources and sinks that stall as they like.
    """

    def __init__(self, dut: Any, clock: Any, expected: Sequence[dict[str, Any]], *, timed: bool = True) -> None:
        self.clock, self.expected, self.timed = clock, expected, timed
        self.passed = [0] * len(expected)
        last = len(expected) - 1
        self.ports: list[tuple[Any, Any, Any, Any, Any]] = []
        for boundary in range(last + 1):
            if boundary == 0:
                names = ("window_valid_i", "window_ready_o", "window_data_i", "window_last_i", None)
            elif boundary == last:
                names = ("patch_valid_o", "patch_ready_i", "patch_data_o", "patch_last_o", None)
            else:
                at = boundary - 1
                parts = ("valid", "ready", "data", "last", "base" if "base" in expected[boundary] else None)
                names = tuple(part and f"between_{part}_{at}_o" for part in parts)  # type: ignore[assignment]
            valid, ready, data, mark, base = (getattr(dut, name) if name else None for name in names)
            self.ports.append((valid, ready, data, mark, base))

    @property
    def done(self) -> bool:
        """Whether everything that is expected has passed."""
        return all(count == len(all_of["cycle"]) for count, all_of in zip(self.passed, self.expected))

    async def run(self) -> None:
        """Watches until everything has passed: to be started before the first edge after reset."""
        cycle = 0
        while not self.done:
            await RisingEdge(self.clock)
            for boundary in range(len(self.ports)):
                self._see(boundary, cycle)
            cycle += 1

    def _see(self, boundary: int, cycle: int) -> None:
        valid, ready, data, mark, base = self.ports[boundary]
        passes = valid.value.is_resolvable and ready.value.is_resolvable and int(valid.value) and int(ready.value)
        of, at = self.expected[boundary], self.passed[boundary]
        ended = at == len(of["cycle"])
        due = None if ended else int(of["cycle"][at])
        if not passes:
            if self.timed and due is not None and cycle >= due:
                raise Mismatch(self._where(boundary, cycle) + f"expected in cycle {due}, did not come")
            return
        if due is None:
            raise Mismatch(self._where(boundary, cycle) + "expected nothing more, and a beat came")
        if self.timed and cycle != due:
            raise Mismatch(self._where(boundary, cycle) + f"expected in cycle {due}, came in cycle {cycle}")
        pairs = [("", data, of["words"][at])] + ([("base: ", base, of["base"][at])] if base is not None else [])
        for what, signal, words in pairs:
            if not signal.value.is_resolvable:
                raise Mismatch(self._where(boundary, cycle) + f"{what}expected {words.tolist()}, got {signal.value}")
            for element, (wanted, got) in enumerate(zip(words, two_words(signal.value))):
                if int(wanted) != got:
                    raise Mismatch(self._where(boundary, cycle, element) + f"{what}expected {int(wanted)}, got {got}")
        if int(mark.value) != int(of["last"][at]):
            raise Mismatch(self._where(boundary, cycle) + f"last: expected {int(of['last'][at])}, got {int(mark.value)}")
        self.passed[boundary] += 1

    def _where(self, boundary: int, cycle: int, element: int = 0) -> str:
        of, at = self.expected[boundary], self.passed[boundary]
        ended = at == len(of["patch"])
        patch = int(of["patch"][-1 if ended else at])
        first = int(np.searchsorted(of["patch"], patch))
        place = 2 * (at - first) + element
        return f"stage {of['stage']} ({of['boundary']}), patch {patch}, element {place}, cycle {cycle}: "
