"""Says what nextpnr reached, from its report: `report.py REPORT MHZ` prints cells and clocks, and fails where a clock is below MHZ. `report.py REPORT
CLOCK=MHZ…` names all clocks of a design, and wants 5 % more of each."""

import json
import sys

CELLS = ("MULT18X18D", "DP16KD", "TRELLIS_COMB", "TRELLIS_FF", "TRELLIS_RAMW", "EHXPLLL")
# What jitter and the blocks' own limits take, of which nextpnr knows nothing.
MARGIN = 1.05


def wanted(arguments, clocks):
    """Megahertz that each clock must reach. nextpnr puts `$glbnet$` before the names of global nets, and `$TRELLIS_IO_IN` behind those of pins."""
    if len(arguments) == 1 and "=" not in arguments[0]:
        return dict.fromkeys(clocks, float(arguments[0]))
    named = dict(argument.split("=") for argument in arguments)
    found = {clock: clock.removeprefix("$glbnet$").removesuffix("$TRELLIS_IO_IN") for clock in clocks}
    if sorted(found.values()) != sorted(named):
        sys.exit(f"clocks {', '.join(clocks)} were found, expected {', '.join(named)}")
    return {clock: MARGIN * float(named[name]) for clock, name in found.items()}


def main(path, *arguments):
    with open(path) as file:
        report = json.load(file)
    for name in CELLS:
        of = report["utilization"][name]
        print(f"{name}: {of['used']} of {of['available']}")
    if not report["fmax"]:
        sys.exit(f"{path}: no clock")
    limits, missed = wanted(arguments, report["fmax"]), []
    for clock, reached in report["fmax"].items():
        mhz = reached["achieved"]
        if mhz < limits[clock]:
            missed.append(f"{clock}: {mhz:.1f} MHz, expected {limits[clock]:.1f}")
        paths = [path["path"] for path in report["critical_paths"] if path["from"] == path["to"] == f"posedge {clock}"]
        total = {kind: sum(step["delay"] for step in paths[0] if (step["type"] == "routing") == kind) for kind in (False, True)}
        print(f"{clock}: {mhz:.1f} MHz; worst path {total[False]:.2f} ns of cells, {total[True]:.2f} ns of wires")
    if missed:
        sys.exit(f"{path}: {'; '.join(missed)}")


main(*sys.argv[1:])
