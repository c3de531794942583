#!/usr/bin/env python3
"""Initialises the DRAM over UARTBone, and then lets the core use it.

    python litex/dram.py /dev/ttyUSB0

A board without a CPU has nobody else to do so. The steps are those of LiteDRAM's software (liblitedram/sdram.c) for the Kintex-7's PHY; the
eight byte lanes are trained at once. Needed after each configuration of the FPGA, not after a reset of the core.
"""

import argparse
import json
import random
import sys
from pathlib import Path

BUILD = Path(__file__).resolve().parent.parent / "build/litex_kc705"

SOFTWARE, HARDWARE = 0x0E, 0x01
CS, WE, CAS, RAS, WRITE_DATA, READ_DATA = 0x01, 0x02, 0x04, 0x08, 0x10, 0x20
# Taps of a delay line, positions of a bit slip.
TAPS, SLIPS = 32, 8
# Bit of mode register 1 that begins write leveling.
LEVELING = 1 << 7


class DramError(Exception):
    """The DRAM was not initialised."""


def longest_run(works):
    """First and last index of the longest run of true values; None without one."""
    best, start = None, None
    for index, work in enumerate([*works, False]):
        if work and start is None:
            start = index
        elif not work and start is not None:
            if best is None or index - start > best[1] - best[0] + 1:
                best = (start, index - 1)
            start = None
    return best


class Dram:
    """A DRAM behind LiteDRAM's registers. `registers` has them by name, with `read` and `write`."""

    def __init__(self, registers, settings, say=print):
        self.registers, self.settings, self.say = registers, settings, say
        self.lanes = range(settings["lanes"])

    def write(self, name, value=1):
        getattr(self.registers, name).write(value)

    def read(self, name):
        return getattr(self.registers, name).read()

    def command(self, phase, command, address=0, bank=0):
        injector = f"sdram_dfii_pi{phase}"
        self.write(f"{injector}_address", address)
        self.write(f"{injector}_baddress", bank)
        self.write(f"{injector}_command", command)
        self.write(f"{injector}_command_issue")

    def reset(self):
        """The sequence of JEDEC, up to mode registers and ZQ calibration."""
        self.write("sdram_dfii_control", SOFTWARE)
        for step in self.settings["steps"]:
            if step["is_control"]:
                self.write("sdram_dfii_control", step["value"])
            else:
                self.command(0, step["value"], step["address"], step["bank"])

    def wrong_lanes(self):
        """Writes words and reads them; gives the lanes in which a bit differs. Two patterns: what an earlier write left is seen."""
        wrong = set()
        for seed in (42, 84):
            draw = random.Random(seed)
            width = 16 * self.settings["lanes"]
            words = [draw.getrandbits(width) for _ in range(self.settings["phases"])]
            self.command(0, RAS | CS)
            for phase, word in enumerate(words):
                self.write(f"sdram_dfii_pi{phase}_wrdata", word)
            self.command(self.settings["write_phase"], CAS | WE | CS | WRITE_DATA)
            self.command(self.settings["read_phase"], CAS | CS | READ_DATA)
            self.command(0, RAS | WE | CS)
            for phase, word in enumerate(words):
                differs = word ^ self.read(f"sdram_dfii_pi{phase}_rddata")
                wrong |= {lane for lane in self.lanes if differs >> 8 * lane & 0xFF or differs >> width // 2 + 8 * lane & 0xFF}
        return wrong


class Training(Dram):
    """The delays of K7DDRPHY: of clock and commands, of each lane's strobe and data when written and data when read."""

    STEPS = {
        "wdly_dq": "wdly_dq_inc",
        "wdly_dqs": "wdly_dqs_inc",
        "wdly_dq_bitslip": "wdly_dq_bitslip",
        "rdly_dq": "rdly_dq_inc",
        "rdly_dq_bitslip": "rdly_dq_bitslip",
    }

    def select(self, lanes):
        self.write("ddrphy_dly_sel", sum(1 << lane for lane in lanes))

    def step(self, delay):
        self.write(f"ddrphy_{self.STEPS[delay]}")

    def begin(self, delay, lanes=None):
        self.select(self.lanes if lanes is None else lanes)
        self.write(f"ddrphy_{delay}_rst")

    def set(self, delay, values):
        """Sets a delay of each lane."""
        self.begin(delay)
        for count in range(max(values)):
            self.select([lane for lane in self.lanes if values[lane] > count])
            self.step(delay)
        self.select(())

    def scan(self, delay):
        """For each lane, which taps of a delay work."""
        works = [[] for _ in self.lanes]
        self.begin(delay)
        for _ in range(TAPS):
            wrong = self.wrong_lanes()
            for lane in self.lanes:
                works[lane].append(lane not in wrong)
            self.step(delay)
        return works

    def centre(self, delay, what):
        """Sets a delay to the middle of the taps that work."""
        runs = [longest_run(works) for works in self.scan(delay)]
        self.need(runs, what)
        self.set(delay, [(first + last) // 2 for first, last in runs])
        self.say(f"{what}: taps " + ", ".join(f"{first} to {last}" for first, last in runs))

    def need(self, found, what):
        lacking = [str(lane) for lane in self.lanes if found[lane] is None]
        if lacking:
            raise DramError(
                f"{what}: no setting works for byte lane {', '.join(lacking)} of {len(self.lanes)}, expected one for each; "
                "check the SODIMM's seat and that the bitstream is that of build/litex_kc705"
            )

    def best_slips(self):
        """For each lane the read bit slip with the most taps that work, and how many."""
        best = [(0, 0)] * len(self.lanes)
        self.begin("rdly_dq_bitslip")
        for slip in range(SLIPS):
            for lane, works in enumerate(self.scan("rdly_dq")):
                if sum(works) > best[lane][1]:
                    best[lane] = (slip, sum(works))
            self.select(self.lanes)
            self.step("rdly_dq_bitslip")
        return best

    def level_writes(self):
        """Aligns each lane's strobe with the clock, the clock delayed so that the strobes' taps are around the middle."""
        cycle = 4 * self.read("ddrphy_half_sys8x_taps")
        middle = TAPS / 2 - cycle / 8 - cycle / 4
        best = None
        for clock in range(cycle // 2):
            self.delay_clock(clock)
            found = [start for start in self.strobe_starts(cycle, 4) if start is not None]
            if found:
                rank = (len(found), -abs(sum(found) / len(found) - middle))
                best = max(best or (rank, clock), (rank, clock), key=lambda entry: entry[0])
        self.delay_clock(best[1] if best else 0)
        starts = self.strobe_starts(cycle, 16)
        self.need(starts, "write leveling")
        self.set("wdly_dq", starts)
        self.set("wdly_dqs", starts)
        self.say(f"write leveling: clock {best[1]}, strobes {', '.join(map(str, starts))}")

    def delay_clock(self, taps):
        self.write("ddrphy_cdly_rst")
        for _ in range(taps):
            self.write("ddrphy_cdly_inc")

    def strobe_starts(self, cycle, looks):
        """For each lane the tap from which on its strobe samples the clock as 1; None without one."""
        self.command(0, RAS | CAS | WE | CS, self.settings["mode_1"] ^ LEVELING, 1)
        self.write("ddrphy_wlevel_en", 1)
        for delay in ("wdly_dq", "wdly_dqs"):
            self.begin(delay)
        ones = [[] for _ in self.lanes]
        for _ in range(TAPS - cycle // 4):
            counts = [0 for _ in self.lanes]
            for _ in range(looks):
                self.write("ddrphy_wlevel_strobe")
                word = self.read("sdram_dfii_pi0_rddata") >> 8 * len(self.lanes)
                for lane in self.lanes:
                    counts[lane] += (word >> 8 * lane & 0xFF) != 0
            for lane in self.lanes:
                ones[lane].append(2 * counts[lane] > looks)
            self.step("wdly_dq")
            self.step("wdly_dqs")
        self.write("ddrphy_wlevel_en", 0)
        self.command(0, RAS | CAS | WE | CS, self.settings["mode_1"], 1)
        runs = [longest_run(taps) for taps in ones]
        # A run from tap 0 on has begun before it; where it is long, it began shortly before.
        return [run[0] if run and (run[0] > 0 or run[1] >= cycle // 4) else None for run in runs]

    def calibrate_latency(self):
        """The cycle of each lane's written words, by a bit slip of two steps a cycle."""
        best = [(None, 0)] * len(self.lanes)
        for slip in range(0, SLIPS, 2):
            self.set("wdly_dq_bitslip", [slip] * len(self.lanes))
            for lane, (_, taps) in enumerate(self.best_slips()):
                if taps > best[lane][1]:
                    best[lane] = (slip, taps)
        slips = [slip for slip, _ in best]
        self.need(slips, "write latency")
        self.set("wdly_dq_bitslip", slips)
        self.say(f"write latency: bit slips {', '.join(map(str, slips))}")

    def train(self):
        for delay in self.STEPS:
            self.begin(delay)
        self.level_writes()
        self.calibrate_latency()
        for delay, what in (("wdly_dq", "written data"), (None, "")):
            self.set("rdly_dq_bitslip", [slip for slip, _ in self.best_slips()])
            self.centre("rdly_dq", "read data")
            if delay:
                self.centre(delay, what)


def initialise(registers, settings, say=print):
    """Resets and trains the DRAM, and hands it to LiteDRAM. LiteX's model of a DRAM has no delays, and is only reset."""
    if hasattr(registers, "ddrphy_rst"):
        dram = Training(registers, settings, say)
        dram.write("ddrphy_rst", 1)
        dram.write("ddrphy_rst", 0)
        dram.reset()
        dram.train()
        wrong = dram.wrong_lanes()
        if wrong:
            lanes = ", ".join(map(str, sorted(wrong)))
            raise DramError(f"wrong words in byte lane {lanes} after training, expected none; configure the FPGA and run dram.py again")
    else:
        dram = Dram(registers, settings, say)
        dram.reset()
    dram.write("sdram_dfii_control", HARDWARE)


def check(line, base, size, places):
    """Random words all over the memory, by way of LiteDRAM's controller."""
    draw = random.Random(1)
    addresses = [base + place * (size // places) + 64 * draw.randrange(16) for place in range(places)]
    words = [[draw.getrandbits(32) for _ in range(16)] for _ in addresses]
    for address, expected in zip(addresses, words):
        line.write(address, expected)
    for address, expected in zip(addresses, words):
        found = line.read(address, 16)
        if found != expected:
            place = next(index for index in range(16) if found[index] != expected[index])
            raise DramError(
                f"DRAM at 0x{address - base + 4 * place:x}: 0x{found[place]:08x}, expected 0x{expected[place]:08x}; "
                "configure the FPGA and run dram.py again"
            )


def bring_up(line, settings, places=32, say=print):
    """The whole of it; `line` is LiteX's client with the map of this build, `places` how many places of the DRAM are tried at the end."""
    line.regs.edof_dram_ready.write(0)
    initialise(line.regs, settings, say)
    check(line, line.mems.main_ram.base, line.mems.main_ram.size, places)
    line.regs.edof_dram_ready.write(1)
    say("the DRAM works; the core uses it")


def main():
    from litex.tools.remote.comm_uart import CommUART

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", help="serial port of the board")
    parser.add_argument("--baud", type=int, default=921600, help="bits per second (default %(default)s)")
    parser.add_argument("--build", type=Path, default=BUILD, help="folder with csr.csv and dram.json (default %(default)s)")
    args = parser.parse_args()
    line = CommUART(args.port, baudrate=args.baud, csr_csv=str(args.build / "csr.csv"))
    try:
        bring_up(line, json.loads((args.build / "dram.json").read_text()))
    except DramError as error:
        sys.exit(f"dram.py: {error}")


if __name__ == "__main__":
    main()
