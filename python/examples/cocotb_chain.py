"""The chain of `tiny` under cocotb: every word and every cycle at every boundary against the model, with random stalls.

Run by tests/test_cocotb.py, or by hand in a folder of `edof generate`:
EDOF_WEIGHTS=FILE EDOF_DESIGN=FILE MODULE=cocotb_chain TOPLEVEL=chain, and cocotb's own Makefile or `vvp -m` (docs/ci.md).
"""

import os
from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock

import edof
from edof.cocotb import ChainScoreboard, StreamSink, StreamSource, reset_chain

WINDOWS = 6


async def chain_with_stalls(dut: Any, seed: int, stalled: int) -> None:
    """Random windows through the chain; both ends stall in `stalled` of 256 cycles."""
    design, network = edof.Design(os.environ["EDOF_DESIGN"]), edof.FixedNetwork.load(os.environ["EDOF_WEIGHTS"])
    rng = np.random.default_rng(seed)
    windows = rng.integers(0, 32768, (WINDOWS, network.window**2)).astype(np.int16)
    expected = design.cycles(network, windows, seed=seed, stalled=stalled)
    last = int(expected[-1]["cycle"][-1])
    source_goes, sink_goes = edof.stall_pattern(2 * last, seed=seed, stalled=stalled)

    clock = dut.clock_i
    cocotb.start_soon(Clock(clock, 10, "step").start())
    source = StreamSource(dut, clock, "window", source_goes)
    sink = StreamSink(dut, clock, "patch", sink_goes)
    board = ChainScoreboard(dut, clock, expected)
    await reset_chain(dut, clock)
    cocotb.start_soon(source.send(windows))
    taken = cocotb.start_soon(sink.take(len(expected[-1]["cycle"])))
    await board.run()
    words = await taken
    assert (words == expected[-1]["words"].ravel()).all()
    dut._log.info("%d beats at %d boundaries, each in its cycle", sum(board.passed), len(board.passed))


@cocotb.test()
async def every_word_in_its_cycle(dut: Any) -> None:
    """Without stalls."""
    await chain_with_stalls(dut, 1, 0)


@cocotb.test()
async def every_word_in_its_cycle_with_stalls(dut: Any) -> None:
    """Both ends pause at random."""
    await chain_with_stalls(dut, 2, 100)
