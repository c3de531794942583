#!/usr/bin/env python3
"""Simulates the system of kc705.py in Verilator: LiteDRAM before LiteX's model of a DRAM, and UARTBone behind a pseudo-terminal.

    python litex/sim.py            # initialises the DRAM, reads id, and compares every picture with its golden one
    python litex/sim.py --serve    # waits for a client at the line that it prints, such as dram.py

Recorded frames come in as on the receiver's bus, after the syncs were taken out; their size is that of `make sim`.
"""

import argparse
import json
import os
import subprocess
import sys

from litedram.modules import MT8JTF12864
from litedram.phy.model import SDRAMPHYModel, get_sdram_phy_settings
from litex.build.generic_platform import Pins, Subsignal
from litex.build.sim import SimPlatform
from litex.gen import LiteXModule
from litex.soc.integration.export import get_csr_csv
from litex.tools.remote.comm_uart import CommUART
from migen import ClockDomain

import dram
from edof_soc import ROOT, SYS_HZ, EdofSoC

BUILD = ROOT / "build/litex_sim"
# As bench.sv has it.
CYCLES_PER_BIT = 8
# Registers that are read and written here.
ID, SCRATCH, CONTROL = 0x000, 0x018, 0x@control_address@
RUNS = 0x@control@

DOMAINS = ("sys", "core", "calculator", "screen")
INPUTS = {"input_clock": 1, "input_hs": 1, "input_vs": 1, "input_de": 1, "input_data": 16}
OUTPUTS = {"screen_hs": 1, "screen_vs": 1, "screen_de": 1, "screen_data": 16}
PINS = [("serial", 0, Subsignal("tx", Pins(1)), Subsignal("rx", Pins(1))), ("reset", 0, Pins(1)), ("dram_ready", 0, Pins(1))]
PINS += [(f"{domain}_clk", 0, Pins(1)) for domain in DOMAINS]
PINS += [(name, 0, Pins(width)) for name, width in (INPUTS | OUTPUTS).items()]


class SmallModule(MT8JTF12864):
    """The KC705's module with an eighth of its rows: 128 MiB of the simulating machine's memory."""

    nrows = 2048


class Domains(LiteXModule):
    def __init__(self, platform, reset):
        for name in DOMAINS:
            domain = ClockDomain(name)
            setattr(self, f"cd_{name}", domain)
            self.comb += [domain.clk.eq(platform.request(f"{name}_clk")), domain.rst.eq(reset)]


class Simulated(EdofSoC):
    def __init__(self):
        platform = SimPlatform("SIM", PINS)
        reset = platform.request("reset")
        self.crg = Domains(platform, reset)
        super().__init__(platform, baud=SYS_HZ / CYCLES_PER_BIT)
        self.phy = SDRAMPHYModel(SmallModule(SYS_HZ, "1:4"), get_sdram_phy_settings("DDR3", 64, SYS_HZ), SYS_HZ)
        core = self.add_edof(self.phy, SmallModule(SYS_HZ, "1:4"))
        self.comb += [core.reset_i.eq(reset), core.i2c_done_i.eq(1)]
        self.comb += [getattr(core, f"{name}_i").eq(platform.request(name)) for name in INPUTS]
        self.comb += [platform.request(name).eq(getattr(core, f"{name}_o")) for name in OUTPUTS]
        self.comb += platform.request("dram_ready").eq(self.edof.dram_ready.storage)


def compile_bench():
    """Writes the system's Verilog, its map and dram.json, and compiles them with the bench."""
    BUILD.mkdir(parents=True, exist_ok=True)
    system = Simulated()
    system.finalize()
    write_verilog(system.platform.get_verilog(system, name="edof_litex").main_source)
    (BUILD / "csr.csv").write_text(get_csr_csv(system.csr_regions, system.constants, system.mem_regions))
    system.write_dram_settings(BUILD / "dram.json")
    core = [path for path in (ROOT / "sim/core_bench.f").read_text().split() if path != "sim/core_bench.sv"]
    sources = [*core, BUILD / "edof_litex.v", "litex/bench.sv", ROOT / "litex/line.cpp"]
    # Nothing is optimised: the bench takes less to run than to compile.
    flags = "--binary --timing -O3 -Wno-fatal -Wno-lint -Wno-style --x-assign unique --x-initial unique --top-module edof_litex_bench".split()
    flags += ["-MAKEFLAGS", "OPT_FAST=-O0 OPT_SLOW=-O0 OPT_GLOBAL=-O0", "--Mdir", BUILD / "obj", "-o", BUILD / "sim"]
    with open(BUILD / "verilator.log", "w") as log:
        done = subprocess.run(["verilator", *map(str, [*flags, *sources])], cwd=ROOT, stdout=log, stderr=log)
    if done.returncode:
        sys.exit(f"sim.py: Verilator failed, see {BUILD / 'verilator.log'}")


def write_verilog(text):
    """Leaves an equal file as it is, so that nothing is compiled again; comments at the margin have the date."""
    path = BUILD / "edof_litex.v"
    text = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("//"))
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def need(what, found, expected):
    if found != expected:
        sys.exit(f"sim.py: {what} reads 0x{found:08x} over UARTBone, expected 0x{expected:08x}")


def run(board):
    """What a host does after configuration, then frames until the bench has seen every picture."""
    # A pseudo-terminal takes any baud rate.
    line = CommUART(board.stdout.readline().split()[-1], csr_csv=str(BUILD / "csr.csv"))
    line.open()
    need("id", line.read(ID), 0x45444F46)
    line.write(SCRATCH, 0x12345678)
    need("scratch", line.read(SCRATCH), 0x12345678)
    print("id and scratch over UARTBone")
    line.write(CONTROL, RUNS)
    need("control", line.read(CONTROL), RUNS)
    # The camera starts when the core may use the memory.
    dram.bring_up(line, json.loads((BUILD / "dram.json").read_text()), places=4)
    print(board.stdout.read(), end="")
    return board.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--serve", action="store_true", help="wait for a client at the line")
    serve = parser.parse_args().serve
    compile_bench()
    os.chdir(ROOT)
    if serve:
        os.execv(BUILD / "sim", ["sim", "+serve"])
    board = subprocess.Popen([BUILD / "sim"], stdout=subprocess.PIPE, text=True)
    try:
        sys.exit(run(board))
    finally:
        board.kill()


if __name__ == "__main__":
    main()
