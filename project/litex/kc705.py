#!/usr/bin/env python3
"""The KC705 with LiteX around edof_core: LiteDRAM in place of MIG, and UARTBone as the host's line."""

import argparse
import re

from litedram.modules import MT8JTF12864
from litedram.phy.s7ddrphy import K7DDRPHY
from litex.build.generic_platform import IOStandard, Misc, Pins
from litex.gen import LiteXModule
from litex.soc.cores.clock import S7IDELAYCTRL, S7MMCM
from litex.soc.integration.builder import Builder
from litex_boards.platforms import xilinx_kc705
from migen import Cat, ClockDomain, ClockSignal, If, Instance, ResetSignal, Signal
from migen.genlib.cdc import MultiReg

from edof_soc import CORE_HZ, ROOT, SYS_HZ, Block, EdofSoC

BUILD = ROOT / "build/litex_kc705"
BAUD = @baud@
# Figures of the MMCMs (divide, multiply, output) that make the design's clocks of the core's: @calculator_mhz@ MHz and @screen_mhz@ MHz.
CALCULATOR = (@calculator_divide@, @calculator_multiply@, @calculator_output@)
SCREEN = (@screen_divide@, @screen_multiply@, @screen_output@)
# Pins and timing of the video chips come from here.
XDC = (ROOT / "constraints/kc705.xdc").read_text()


def pins():
    """Pins of the video chips, as constraints/kc705.xdc has them."""
    found = {}
    for settings, port, index in re.findall(
        r"set_property -dict \{(.*?)\} \[get_ports \{?((?:hdmi|iic|fmc|fan)_\w+)(?:\[(\d+)\])?\}?\]", XDC
    ):
        words = settings.split()
        found.setdefault(port, []).append((int(index or 0), dict(zip(words[::2], words[1::2]))))
    for port, bits in found.items():
        bits = [settings for _, settings in sorted(bits, key=lambda bit: bit[0])]
        misc = [Misc(f"{key}={bits[0][key]}") for key in ("SLEW", "PULLUP") if key in bits[0]]
        yield port, 0, Pins(" ".join(bit["PACKAGE_PIN"] for bit in bits)), IOStandard(bits[0]["IOSTANDARD"]), *misc


class Clocks(LiteXModule):
    """Of the oscillator's 200 MHz: LiteDRAM's clocks and the core's; of the core's: the calculator's and the screen's."""

    def __init__(self, platform):
        for name in ("sys", "sys4x", "idelay", "core"):
            setattr(self, f"cd_{name}", ClockDomain(name))
        for name in ("calculator", "screen"):
            setattr(self, f"cd_{name}", ClockDomain(name, reset_less=True))
        self.main = main = S7MMCM(speedgrade=-2)
        main.register_clkin(platform.request("clk200"), 200e6)
        main.create_clkout(self.cd_sys, SYS_HZ, margin=0)
        main.create_clkout(self.cd_sys4x, 4 * SYS_HZ, margin=0)
        main.create_clkout(self.cd_idelay, 200e6, margin=0)
        main.create_clkout(self.cd_core, CORE_HZ, margin=0)
        self.idelayctrl = S7IDELAYCTRL(self.cd_idelay)
        # Ways between these two go through FIFOs of LiteX. The core's own ways are in crossings.xdc.
        platform.add_false_path_constraints(self.cd_sys.clk, self.cd_core.clk)
        # High while that clock is not locked, in the core's clock.
        self.calculator_reset = self.made(self.cd_calculator, "calculator_mmcm", CALCULATOR)
        self.screen_reset = self.made(self.cd_screen, "screen_mmcm", SCREEN)

    def made(self, domain, name, figures):
        divide, multiply, output = figures
        feedback, unbuffered, locked, seen, reset = (Signal() for _ in range(5))
        self.specials += Instance(
            "MMCME2_BASE",
            name=name,
            p_CLKIN1_PERIOD=1e9 / CORE_HZ,
            p_DIVCLK_DIVIDE=divide,
            p_CLKFBOUT_MULT_F=multiply,
            p_CLKOUT0_DIVIDE_F=output,
            i_CLKIN1=ClockSignal("core"),
            i_CLKFBIN=feedback,
            o_CLKFBOUT=feedback,
            o_CLKOUT0=unbuffered,
            o_LOCKED=locked,
            i_PWRDWN=0,
            i_RST=~self.main.locked,
        )
        self.specials += Instance("BUFG", i_I=unbuffered, o_O=domain.clk)
        self.specials += MultiReg(locked, seen, "core")
        self.sync.core += reset.eq(~seen)
        return reset


class Kc705(EdofSoC):
    def __init__(self):
        platform = xilinx_kc705.Platform()
        platform.add_extension(list(pins()))
        self.crg = Clocks(platform)
        super().__init__(platform, BAUD)
        self.ddrphy = K7DDRPHY(platform.request("ddram"), memtype="DDR3", nphases=4, sys_clk_freq=SYS_HZ)
        core = self.add_edof(self.ddrphy, MT8JTF12864(SYS_HZ, "1:4"))

        # The button resets the core alone: the DRAM stays initialised, and weights outlive it.
        self.submodules.button = button = Block("edof_debounce", "button")
        self.submodules.reset_of_input = input_reset = Block("edof_reset_sync", "reset_of_input", CYCLES=64)
        self.submodules.reset_of_core = core_reset = Block("edof_reset_sync", "reset_of_core", CYCLES=64)
        reset = Signal(reset=1)
        self.sync.core += reset.eq(ResetSignal("core") | button.level_o)
        self.comb += [
            button.clock_i.eq(ClockSignal("core")),
            button.line_i.eq(platform.request("cpu_reset")),
            core.reset_i.eq(reset),
            core.calculator_reset_i.eq(self.crg.calculator_reset),
            core.screen_reset_i.eq(self.crg.screen_reset),
            input_reset.clock_i.eq(core.input_clock_i),
            input_reset.reset_i.eq(reset),
            core_reset.clock_i.eq(ClockSignal("core")),
            core_reset.reset_i.eq(reset),
        ]
        self.add_receiver(platform, core, input_reset.reset_o)
        self.add_screen(platform, core)
        self.add_chips(platform, core, core_reset.reset_o, button.level_o)
        leds = Cat(*[platform.request("user_led", number) for number in range(8)])
        plugged = self.chips[0].slots_0_o[6]
        self.comb += leds.eq(Cat(core.status_o[:6], plugged, ~(self.crg.calculator_reset | self.crg.screen_reset)))
        self.comb += platform.request("fan_pwm").eq(1)

    def add_receiver(self, platform, core, reset):
        """The incoming bus: registered in the pads, then its syncs taken out of the pixels."""
        self.cd_input = ClockDomain("input", reset_less=True)
        self.specials += Instance("BUFG", i_I=platform.request("hdmi_rx_clk"), o_O=self.cd_input.clk)
        data = Signal(16, attr={("IOB", "TRUE")})
        self.sync.input += data.eq(platform.request("hdmi_rx_data"))
        self.submodules.syncs = syncs = Block("embedded_syncs", "syncs")
        self.comb += [
            core.input_clock_i.eq(ClockSignal("input")),
            syncs.clock_i.eq(ClockSignal("input")),
            syncs.reset_i.eq(reset),
            # The card has luma on the upper byte, the core on the lower.
            syncs.data_i.eq(Cat(data[8:], data[:8])),
            core.input_hs_i.eq(syncs.hs_o),
            core.input_vs_i.eq(syncs.vs_o),
            core.input_de_i.eq(syncs.de_o),
            core.input_data_i.eq(syncs.pixel_o),
            core.input_codes_i.eq(syncs.codes_o),
            core.input_malformed_i.eq(syncs.malformed_o),
        ]

    def add_screen(self, platform, core):
        """The outgoing bus: registered in the pads, its clock half a period later."""
        for port, signal in (
            ("hsync", core.screen_hs_o),
            ("vsync", core.screen_vs_o),
            ("de", core.screen_de_o),
            ("data", core.screen_data_o),
        ):
            pad = Signal(len(signal), attr={("IOB", "TRUE")}, name=f"screen_{port}_q")
            self.sync.screen += pad.eq(signal)
            self.comb += platform.request(f"hdmi_tx_{port}").eq(pad)
        self.specials += Instance(
            "ODDR",
            name="screen_clock_out",
            p_DDR_CLK_EDGE="SAME_EDGE",
            i_C=ClockSignal("screen"),
            i_CE=1,
            i_D1=0,
            i_D2=1,
            i_R=0,
            i_S=0,
            o_Q=platform.request("hdmi_tx_clk"),
        )

    def add_chips(self, platform, core, reset, button):
        """The set-up of the video chips: the board's bus, the card's."""
        text = (ROOT / "rtl/kc705_core.v").read_text()
        made = re.findall(r"chip_setup #\(\.IS_CARD\(1'b(\d)\), \.DEPTH\((\d+)\), \.INIT\(\"(\S+)\"\)\) (chips_\d)", text)
        self.chips = []
        for (is_card, depth, image, name), bus in zip(made, ("iic", "fmc_iic"), strict=True):
            chip = Block("chip_setup", name, IS_CARD=int(is_card), DEPTH=int(depth), INIT=image)
            self.submodules += chip
            self.chips.append(chip)
            for line in ("scl", "sda"):
                self.specials += Instance(
                    "IOBUF",
                    i_I=0,
                    o_O=getattr(chip, f"{line}_i"),
                    i_T=~getattr(chip, f"{line}_low_o"),
                    io_IO=platform.request(f"{bus}_{line}"),
                )
            self.comb += [
                chip.clock_i.eq(ClockSignal("core")),
                chip.reset_i.eq(reset),
                chip.restart_i.eq(core.i2c_restart_o),
                chip.settings_i.eq(core.video_setup_o),
                chip.access_i.eq(core.chip_access_o),
            ]
        board, card = self.chips
        self.comb += [
            core.i2c_done_i.eq(board.done_o & card.done_o),
            core.i2c_failed_i.eq(board.failed_o | card.failed_o),
            core.i2c_0_i.eq(board.word_o),
            core.i2c_1_i.eq(card.word_o),
            core.chips_0_i.eq(card.slots_0_o),
            core.chips_1_i.eq(card.slots_1_o),
            core.chips_2_i.eq(card.slots_2_o),
            core.chips_3_i.eq(board.slots_0_o),
            If(core.chip_access_o[25], core.chip_answer_i.eq(card.answer_o)).Else(core.chip_answer_i.eq(board.answer_o)),
            platform.request("iic_mux_reset_n").eq(~button),
            platform.request("fmc_iic_reset_n").eq(~button),
        ]


def constrain(platform):
    """Timing of the video pins as constraints/kc705.xdc has it, and the limits of the core's clock-domain crossings."""
    for line in XDC.splitlines():
        if re.match(r"(create_clock -name hdmi_rx|set_property IOBDELAY|set_input_delay|create_generated_clock|set_output_delay) ", line):
            platform.add_platform_command(escaped(line))
    slow = "iic_scl iic_sda fmc_iic_scl fmc_iic_sda"
    platform.add_platform_command(escaped(f"set_false_path -from [get_ports {{cpu_reset serial_rx {slow}}}]"))
    platform.add_platform_command(
        escaped(f"set_false_path -to [get_ports {{serial_tx {slow} iic_mux_reset_n fmc_iic_reset_n user_led* fan_pwm}}]")
    )
    # One paragraph per crossing, its path as in kc705_top: here the instances of kc705_core are those of the top, without the serial line.
    paragraphs = (ROOT / "constraints/crossings.xdc").read_text().split("\n\n")
    paragraphs = [re.sub(r"(?<=[ {])core/", "", text) for text in paragraphs if not text.startswith("# core/uart/")]
    (BUILD / "crossings.xdc").write_text("\n\n".join(paragraphs))
    commands = platform.toolchain.pre_synthesis_commands
    # Memory images are found by their names among the files of the project.
    commands.add('set_property verilog_define "EDOF_IMAGES_BY_NAME SYNTHESIS" [current_fileset]')
    commands.add(f"read_mem [glob {ROOT}/mem/*.mem]")
    # To what synthesis left, so that each limit holds what is there.
    platform.toolchain.pre_optimize_commands.add(f"read_xdc {BUILD}/crossings.xdc")


def escaped(command):
    """LiteX formats commands."""
    return command.replace("{", "{{").replace("}", "}}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", action="store_true", help="run Vivado; without it only its sources and its script are written")
    args = parser.parse_args()
    BUILD.mkdir(parents=True, exist_ok=True)
    system = Kc705()
    for path in sorted((ROOT / "rtl").glob("*.v")):
        if path.stem not in ("kc705_core", "kc705_top"):
            system.platform.add_source(str(path))
    constrain(system.platform)
    builder = Builder(system, output_dir=str(BUILD), csr_csv=str(BUILD / "csr.csv"), compile_software=False)
    builder.build(build_name="edof_kc705", run=args.build)
    system.write_dram_settings(BUILD / "dram.json")


if __name__ == "__main__":
    main()
