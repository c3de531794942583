"""Says what nextpnr reached, from its report: `report.py REPORT MHZ` prints clocks and cells, and fails where a clock is below MHZ."""

import json
import sys

CELLS = ("MULT18X18D", "DP16KD", "TRELLIS_COMB", "TRELLIS_FF", "TRELLIS_RAMW")


def main(path, wanted):
    with open(path) as file:
        report = json.load(file)
    for name in CELLS:
        of = report["utilization"][name]
        print(f"{name}: {of['used']} of {of['available']}")
    if not report["fmax"]:
        sys.exit(f"{path}: no clock")
    missed = False
    for clock, reached in report["fmax"].items():
        mhz = reached["achieved"]
        missed |= mhz < wanted
        paths = [path["path"] for path in report["critical_paths"] if path["from"] == path["to"] == f"posedge {clock}"]
        total = {kind: sum(step["delay"] for step in paths[0] if (step["type"] == "routing") == kind) for kind in (False, True)}
        print(f"{clock}: {mhz:.1f} MHz; worst path {total[False]:.2f} ns of cells, {total[True]:.2f} ns of wires")
    if missed:
        sys.exit(f"{path}: a clock is below {wanted} MHz")


main(sys.argv[1], float(sys.argv[2]))
