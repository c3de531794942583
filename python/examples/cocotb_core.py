"""`edof_core` under cocotb between a camera and a screen, with cocotbext-axi's AxiRam as its memory and random pauses on all channels.

Frames of 16 x 16 pixels, as the benches of a generated folder have them (sim/rtl): every picture on the screen must be golden.
"""

import itertools
import os
import random
from collections.abc import Iterator
from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, First, Timer
from cocotbext.axi import AxiRam

import edof
from edof.cocotb import AxiLite, VideoSink, VideoSource, memory_bus

FRAMES, ROWS, COLUMNS = 3, 16, 16
# Cycles of the core in a frame of the camera: the memory may be late.
CYCLES = 6000
CONTROL, SCRATCH = 0x14, 0x18


def pauses(seed: str) -> Iterator[bool]:
    """Cycles in which a channel pauses: full speed, trickle and long pauses in turn."""
    rng = random.Random(seed)
    while True:
        share = rng.choice([0.0, 0.0, 0.2, 0.5, 0.9])
        yield from (rng.random() < share for _ in range(rng.randint(1, 150)))
        yield from itertools.repeat(True, rng.choice([0, 0, 0, rng.randint(50, 400)]))


@cocotb.test()
async def every_picture_is_golden(dut: Any) -> None:
    """Raw frames in, the codes of `edof.board_picture` out."""
    seed = os.environ.get("EDOF_SEED", "1")
    network = edof.FixedNetwork.load(os.environ["EDOF_WEIGHTS"])
    rng = np.random.default_rng(int(seed))
    frames = [rng.integers(0, 65536, (ROWS, COLUMNS)).astype(np.uint16) for _ in range(FRAMES)]
    pictures = [edof.board_picture(frame, network) for frame in frames]

    # Inputs rise after the start: a block that waits for a change must see one.
    for name in dir(dut):
        if name.endswith("_i"):
            getattr(dut, name).value = 0
    dut.dram_ready_i.value, dut.i2c_done_i.value = 1, 1
    # A cycle of the memory's 200 MHz is 100 units of time, whatever the simulator takes a unit for.
    memory = 100
    calculator = 2 * round(memory * 100 / edof.Design(os.environ["EDOF_DESIGN"]).clock_mhz)
    slower = max(memory, calculator)
    camera = 2 * (slower * CYCLES // VideoSource.cycles(ROWS, COLUMNS) // 2)
    periods = {"clock_i": memory, "calculator_clock_i": calculator, "input_clock_i": camera, "screen_clock_i": 2 * (camera * 49 // 100)}
    for name, period in periods.items():
        cocotb.start_soon(Clock(getattr(dut, name), period, "step").start())

    ram = AxiRam(memory_bus(dut), dut.clock_i, size=1 << 25)
    channels = [ram.write_if.aw_channel, ram.write_if.w_channel, ram.write_if.b_channel]
    for number, channel in enumerate([*channels, ram.read_if.ar_channel, ram.read_if.r_channel]):
        channel.set_pause_generator(pauses(f"{seed} {number}"))
    host = AxiLite(dut, dut.clock_i)
    await ClockCycles(dut.clock_i, 5)
    dut.reset_i.value = 1
    await ClockCycles(dut.clock_i, 200)
    dut.reset_i.value = 0
    await ClockCycles(dut.clock_i, 200)
    await host.write(SCRATCH, 0x5EED)
    assert await host.read(SCRATCH) == 0x5EED
    # Runs, colours encoded.
    await host.write(CONTROL, 3)

    cocotb.start_soon(VideoSource(dut, dut.input_clock_i, frames).run())
    sink = VideoSink(dut, dut.screen_clock_i, pictures)
    watching = cocotb.start_soon(sink.run())
    await First(watching, Timer(slower * CYCLES * (FRAMES + 40), "step"))
    assert sink.shown == FRAMES, f"{sink.shown} of {FRAMES} pictures, {sink.frames} frames on the screen"
