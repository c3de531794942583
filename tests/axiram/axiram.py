"""cocotbext-axi's AxiRam as the core's memory: it checks what AXI4 asks of a master, and pauses on every channel at random.

Every frame on the screen must be black or a golden picture, in order (the bench's own check).
"""

import itertools
import os
import random

import cocotb
from cocotb.triggers import ClockCycles, First, RisingEdge
from cocotbext.axi import AxiBus, AxiRam


def pauses(seed):
    """Cycles in which a channel pauses: full speed, trickle and long pauses in turn."""
    rng = random.Random(seed)
    while True:
        share = rng.choice([0.0, 0.0, 0.2, 0.5, 0.9])
        yield from (rng.random() < share for _ in range(rng.randint(1, 150)))
        yield from itertools.repeat(True, rng.choice([0, 0, 0, rng.randint(50, 400)]))


@cocotb.test()
async def every_picture_is_golden(dut):
    seed = int(os.environ["AXIRAM_SEED"])
    ram = AxiRam(AxiBus.from_prefix(dut, "m_axi"), dut.clock, size=1 << 25)
    channels = [ram.write_if.aw_channel, ram.write_if.w_channel, ram.write_if.b_channel]
    channels += [ram.read_if.ar_channel, ram.read_if.r_channel]
    for number, channel in enumerate(channels):
        channel.set_pause_generator(pauses(f"{seed} {number}"))
    await First(RisingEdge(dut.passed), RisingEdge(dut.failed))
    await ClockCycles(dut.clock, 2)
    assert dut.failed.value == 0 and dut.passed.value == 1, "a frame on the screen is none that was sent, or pictures do not come"
