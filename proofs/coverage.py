#!/usr/bin/env python3
"""What simulations covered of each Verilog module: coverage.py FOLDER adds up what instances wrote there, and prints a table in Markdown.

A line or branch is covered if it ran in any instance of the module, a bit if it rose or fell in one. A block of other sizes has other numbers in
its lines, and may have them elsewhere: lines are the same if all else in them is, and as many such lines stand before them. proofs/coverage.json says of a module how many
lines or bits cannot be covered, and why; they do not count. Its row "of tests" names modules that only tests have. Exit status 1 if a module has less than 95 % of its lines or 90 % of its bits, or a
reason is given for more points than are left. `--missing MODULE` prints the points of a module that were not covered.
"""

import argparse
import functools
import json
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

LEAST = {"line": 95.0, "toggle": 90.0}
KIND = {"line": "line", "branch": "line", "toggle": "toggle"}
NUMBER = re.compile(r"\b\d+'[dhb][0-9a-f_]+|\d+")
POINT = re.compile(r"C '(.*)' (\d+)$")


@functools.cache
def lines(path):
    """Of each line of a text what it says apart from numbers, and how many lines before it say the same."""
    seen, found = Counter(), []
    for line in path.read_text().split("\n"):
        plain = NUMBER.sub("#", line.strip())
        found.append(f"{plain} ({seen[plain]})")
        seen[plain] += 1
    return found


def points(path):
    """Module, kind and place of each point of a file, with its count."""
    for line in path.open(errors="replace"):
        found = POINT.match(line.rstrip("\n"))
        if not found:
            continue
        field = dict(part.split("\x02", 1) for part in found[1].split("\x01") if part)
        kind, module = field["page"].removeprefix("v_").split("/", 1)
        if kind in KIND:
            text = lines(path.parent / "texts" / Path(field["f"]).name)
            place = (text[int(field["l"]) - 1], field.get("n", ""), field.get("o", ""))
            yield (module.split("__")[0], KIND[kind], ":".join(place)), int(found[2])


def add_up(folder):
    """Counts of all instances so far. What they wrote is removed once it is added."""
    kept = folder / "all.json"
    total = defaultdict(int, json.loads(kept.read_text()) if kept.exists() else {})
    files = sorted(folder.glob("*.dat"))
    for path in files:
        for point, count in points(path):
            total["\t".join(point)] += count
    new = kept.with_suffix(".new")
    new.write_text(json.dumps(total))
    new.rename(kept)
    for path in files:
        path.unlink()
    return total


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--missing", metavar="MODULE")
    parser.add_argument("--quiet", action="store_true", help="add up only")
    given = parser.parse_args()
    total = add_up(given.folder)
    if given.quiet:
        return 0
    modules = defaultdict(lambda: {kind: [0, 0] for kind in LEAST})
    for point, count in total.items():
        module, kind, place = point.split("\t")
        modules[module][kind][0] += count > 0
        modules[module][kind][1] += 1
        if module == given.missing and not count:
            print(kind, place)
    if given.missing:
        return 0
    reasons = json.loads((Path(__file__).parent / "coverage.json").read_text())
    of_tests = reasons.pop("of tests")
    faults = [f"{module}: no such module was simulated" for module in [*reasons, *of_tests] if module not in modules]
    print("| module | lines | bits | not counted |")
    print("|---|---|---|---|")
    for module, found in sorted(modules.items()):
        if module in of_tests:
            continue
        cells, told = [], []
        for kind, least in LEAST.items():
            covered, all_points = found[kind]
            waived, reason = reasons.get(module, {}).get(kind, [0, ""])
            if waived > all_points - covered:
                faults.append(f"{module}: proofs/coverage.json waives {waived} {kind}s, {all_points - covered} are left")
            if waived:
                told.append(f"{waived} {'lines' if kind == 'line' else 'bits'}: {reason}")
            share = 100.0 * covered / (all_points - waived) if all_points > waived else 100.0
            if share < least:
                faults.append(f"{module}: {share:.1f} % of {kind}s, at least {least} % asked for")
            cells.append(f"{covered} of {all_points - waived} ({share:.1f} %)" if all_points else "–")
        print(f"| `{module}` | {' | '.join(cells)} | {'; '.join(told)} |")
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


sys.exit(main())
