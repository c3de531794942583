"""edof_core in a LiteX system: a slave of its bus, and a master of LiteDRAM.

The core keeps the clocks that its files were made for. LiteX's bus and LiteDRAM have the domain `sys`, and each channel of the core's ports
crosses between `core` and `sys` in a FIFO of LiteX.
"""

import json
import re
from pathlib import Path

from litedram.frontend.axi import LiteDRAMAXI2Native
from litedram.init import get_sdram_phy_init_sequence
from litex.gen import LiteXModule
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import stream
from litex.soc.interconnect.axi import AXIInterface, AXILiteClockDomainCrossing, AXILiteInterface
from litex.soc.interconnect.csr import CSRStorage
from migen import ClockSignal, Instance, Module, Signal
from migen.genlib.cdc import MultiReg

# The generated directory.
ROOT = Path(__file__).resolve().parent.parent

# LiteDRAM's clock: DDR3-1000. The clock of the core's memory and host ports is that of all boards.
SYS_HZ = 125_000_000
CORE_HZ = @core_mhz@e6

# Byte addresses on the bus: the core's registers from 0 on, as `edof board` expects them; the DRAM; LiteX's registers.
REGISTERS, REGISTERS_BYTES = 0x0000_0000, 0x1000_0000
DRAM, DRAM_BYTES = 0x4000_0000, 0x0200_0000
CSR = 0xF000_0000

# Words of 512 bits that a channel holds between the domains, and words of a burst.
CROSSING_WORDS = 16
BURST_WORDS = @burst_words@

# Values of DFII_CONTROL_* and DFII_COMMAND_* of LiteDRAM's software.
DFII = {"CONTROL_SEL": 1, "CONTROL_CKE": 2, "CONTROL_ODT": 4, "CONTROL_RESET_N": 8}
DFII |= {"COMMAND_CS": 1, "COMMAND_WE": 2, "COMMAND_CAS": 4, "COMMAND_RAS": 8}


class Block(Module):
    """An instance of a generated module. Its ports are signals of the same names; an input without a driver is 0."""

    def __init__(self, module, name, **parameters):
        text = (ROOT / "rtl" / f"{module}.v").read_text()
        header = re.search(rf"^module {module}\b.*?^\);", text, re.S | re.M).group()
        connections = {f"p_{parameter}": value for parameter, value in parameters.items()}
        for way, top, port in re.findall(r"\b(input|output)\s+wire\s+(?:\[(\d+):0\]\s*)?(\w+)", header):
            signal = Signal(int(top or 0) + 1, name=f"{name}_{port}")
            setattr(self, port, signal)
            connections[("i_" if way == "input" else "o_") + port] = signal
        self.specials += Instance(module, name=name, **connections)

    def connect(self, prefix, bundle):
        """Connects the ports `prefix_CHANNEL_FIELD` to the channels of a bundle of LiteX."""
        for name, signal in vars(self).items():
            match = re.fullmatch(rf"{prefix}_([a-z]+)_(\w+)_([io])", name)
            if match:
                field = getattr(getattr(bundle, match[1]), match[2])
                self.comb += field.eq(signal) if match[3] == "o" else signal.eq(field)


class EdofCore(LiteXModule):
    """`core`, its host port as a slave of the bus (`bus`), its memory port before a native port of LiteDRAM.

    The core's memory port is closed until `dram_ready` is written: whoever initialises the DRAM writes it.
    """

    def __init__(self, port):
        self.submodules.core = core = Block("edof_core", "core")
        self.dram_ready = CSRStorage(description="1: the DRAM is initialised, and the core may use it.")
        self.bus = AXILiteInterface(data_width=32, address_width=32)
        self.comb += core.clock_i.eq(ClockSignal("core"))
        self.comb += core.calculator_clock_i.eq(ClockSignal("calculator"))
        self.comb += core.screen_clock_i.eq(ClockSignal("screen"))
        self.specials += MultiReg(self.dram_ready.storage, core.dram_ready_i, "core")

        host = AXILiteInterface(data_width=32, address_width=32, clock_domain="core")
        self.submodules += AXILiteClockDomainCrossing(self.bus, host, "sys", "core")
        core.connect("host", host)

        memory = AXIInterface(data_width=512, address_width=32, id_width=1, clock_domain="core")
        crossed = AXIInterface(data_width=512, address_width=32, id_width=1)
        core.connect("dram_write", memory)
        core.connect("dram_read", memory)
        for channel in ("aw", "w", "ar"):
            self.cross(getattr(memory, channel), getattr(crossed, channel), "core", "sys")
        for channel in ("b", "r"):
            self.cross(getattr(crossed, channel), getattr(memory, channel), "sys", "core")
        self.submodules += LiteDRAMAXI2Native(crossed, port, w_buffer_depth=BURST_WORDS, r_buffer_depth=BURST_WORDS)

    def cross(self, source, sink, source_domain, sink_domain):
        crossing = stream.ClockDomainCrossing(source.description, source_domain, sink_domain, depth=CROSSING_WORDS)
        self.submodules += crossing
        self.comb += [source.connect(crossing.sink), crossing.source.connect(sink)]


class EdofSoC(SoCMini):
    """The bus with UARTBone as its only master, LiteDRAM and the core. The board adds the domains, pins and the PHY."""

    mem_map = {**SoCMini.mem_map, "csr": CSR}

    def __init__(self, platform, baud):
        super().__init__(platform, SYS_HZ)
        self.add_uartbone(baudrate=baud)

    def add_edof(self, phy, module):
        """Gives the core. The bus has a window into the DRAM, which the core uses from address 0 on."""
        self.add_sdram("sdram", phy=phy, module=module, origin=DRAM, size=DRAM_BYTES, l2_cache_size=0)
        self.edof = EdofCore(self.sdram.crossbar.get_port())
        self.bus.add_slave("edof", self.edof.bus, SoCRegion(origin=REGISTERS, size=REGISTERS_BYTES, cached=False))
        return self.edof.core

    def write_dram_settings(self, path):
        """Writes what `dram.py` needs to know of PHY and DRAM."""
        controller = self.sdram.controller.settings
        phy, timing = controller.phy, controller.timing
        sequence, modes = get_sdram_phy_init_sequence(phy, timing)

        def number(value):
            return value.reset.value if isinstance(value, Signal) else value

        steps = []
        for name, address, bank, words, _ in sequence:
            words = words.split("|")
            value = sum(DFII[word.removeprefix("DFII_")] for word in words)
            steps.append({"name": name, "is_control": "CONTROL" in words[0], "address": address, "bank": bank, "value": value})
        settings = {
            "phases": phy.nphases,
            "lanes": phy.databits // 8,
            "read_phase": number(phy.rdphase),
            "write_phase": number(phy.wrphase),
            "mode_1": modes[1],
            "steps": steps,
        }
        path.write_text(json.dumps(settings, indent=1) + "\n")
