"""litex/dram.py's training against a model of DRAM and PHY: eight byte lanes, each with delays of its own.

    python dram_model.py LITEX DRAM_JSON

LITEX is the folder of dram.py, DRAM_JSON what kc705.py wrote. The model takes the registers of LiteDRAM's injector and of K7DDRPHY, and answers
as DDR3 would: a word comes back whole where strobe, written data, their cycle and the read delay of its lane are within their windows.
"""

import json
import random
import sys

sys.path.insert(0, sys.argv[1])
import dram

SETTINGS = json.load(open(sys.argv[2]))
# Taps of a clock cycle at 500 MHz, and a half of a half of it, as K7DDRPHY has it in a register.
HALF = 6
CYCLE = 4 * HALF
BANK, ROW = 0, 0


class Lane:
    """What a lane needs, at random, and the delays that it has."""

    def __init__(self, draw):
        # The strobe's flight against the clock, in taps; the data's against the strobe.
        self.flight, self.skew = draw.randrange(4, 10), draw.randrange(-2, 3)
        self.cycle = draw.choice((0, 2, 4, 6))
        self.slip, self.eye = draw.randrange(8), draw.randrange(3, 18)
        self.delays = dict.fromkeys(dram.Training.STEPS, 0)
        self.stored, self.works = 0, True

    def sampled_clock(self, clock):
        """The clock at the strobe's edge."""
        return (self.delays["wdly_dqs"] - clock - self.flight) % CYCLE < CYCLE // 2

    def takes(self, clock):
        strobe = self.delays["wdly_dqs"] - clock - self.flight
        data = self.delays["wdly_dq"] - self.delays["wdly_dqs"] - self.skew
        return self.works and abs(strobe) <= 5 and abs(data) <= 5 and self.delays["wdly_dq_bitslip"] == self.cycle

    def gives(self):
        return self.delays["rdly_dq_bitslip"] == self.slip and 0 <= self.delays["rdly_dq"] - self.eye <= 10


class Register:
    def __init__(self, model, name):
        self.model, self.name = model, name

    def write(self, value):
        self.model.accesses += 1
        self.model.written(self.name, value)

    def read(self):
        self.model.accesses += 1
        return self.model.values.get(self.name, 0)


class Model:
    """The registers, by name as LiteX's client has them."""

    def __init__(self, seed):
        draw = random.Random(seed)
        self.lanes = [Lane(draw) for _ in range(SETTINGS["lanes"])]
        self.values, self.clock, self.is_open, self.modes, self.accesses = {"ddrphy_half_sys8x_taps": HALF}, 0, False, {}, 0

    def __getattr__(self, name):
        return Register(self, name)

    def written(self, name, value):
        self.values[name] = value
        delay = name.removeprefix("ddrphy_")
        if delay == "cdly_rst":
            self.clock = 0
        elif delay == "cdly_inc":
            self.clock += 1
        elif delay == "wlevel_strobe":
            # Leveling must be on in the DRAM, too.
            ones = [lane.sampled_clock(self.clock) and self.modes[1] & dram.LEVELING for lane in self.lanes]
            self.values["sdram_dfii_pi0_rddata"] = sum(0xFF << 8 * (8 + number) for number, one in enumerate(ones) if one)
        elif delay.removesuffix("_rst") in dram.Training.STEPS and delay.endswith("_rst"):
            for lane in self.selected():
                lane.delays[delay.removesuffix("_rst")] = 0
        elif delay in dram.Training.STEPS.values():
            kind = next(kind for kind, step in dram.Training.STEPS.items() if step == delay)
            for lane in self.selected():
                lane.delays[kind] = (lane.delays[kind] + 1) % (8 if "bitslip" in kind else 32)
        elif name.endswith("_command_issue"):
            self.commanded(int(name[len("sdram_dfii_pi")]))

    def selected(self):
        return [lane for number, lane in enumerate(self.lanes) if self.values["ddrphy_dly_sel"] >> number & 1]

    def commanded(self, phase):
        injector = f"sdram_dfii_pi{phase}_"
        command, address, bank = (self.values[injector + word] for word in ("command", "address", "baddress"))
        row = command & (dram.RAS | dram.CAS | dram.WE)
        if row == dram.RAS | dram.CAS | dram.WE:
            self.modes[bank] = address
        elif row == dram.RAS:
            assert not self.is_open, "a row is opened twice"
            self.is_open = True
        elif row == dram.RAS | dram.WE:
            self.is_open = False
        elif row == dram.CAS | dram.WE:
            assert self.is_open and command & dram.WRITE_DATA and phase == SETTINGS["write_phase"]
            for number, lane in enumerate(self.lanes):
                if lane.takes(self.clock):
                    lane.stored = [self.bytes_of(f"sdram_dfii_pi{each}_wrdata", number) for each in range(4)]
        elif row == dram.CAS:
            assert self.is_open and command & dram.READ_DATA and phase == SETTINGS["read_phase"]
            for each in range(4):
                word = 0
                for number, lane in enumerate(self.lanes):
                    low, high = lane.stored[each] if lane.gives() and lane.stored else (0x5A, 0xA5)
                    word |= low << 8 * number | high << 8 * (8 + number)
                self.values[f"sdram_dfii_pi{each}_rddata"] = word

    def bytes_of(self, name, lane):
        return self.values[name] >> 8 * lane & 0xFF, self.values[name] >> 8 * (8 + lane) & 0xFF


assert [dram.longest_run(map(int, taps)) for taps in ("0111011", "000", "1101110", "1111")] == [(1, 3), None, (3, 5), (0, 3)]
for seed in range(4):
    model = Model(seed)
    dram.initialise(model, SETTINGS, say=lambda text: None)
    for number, lane in enumerate(model.lanes):
        assert lane.takes(model.clock) and lane.gives(), f"seed {seed}, lane {number}: {vars(lane)}"
        assert 4 <= lane.delays["rdly_dq"] - lane.eye <= 6, f"seed {seed}, lane {number}: the read delay is not in the middle"
    assert model.values["sdram_dfii_control"] == dram.HARDWARE and not model.modes[1] & dram.LEVELING
print(f"dram.py: eight lanes trained, {model.accesses} accesses")

model = Model(1)
model.lanes[5].works = False
try:
    dram.initialise(model, SETTINGS, say=lambda text: None)
    sys.exit("dram.py: a lane that takes nothing was trained")
except dram.DramError as error:
    assert "write latency: no setting works for byte lane 5 of 8" in str(error), error
