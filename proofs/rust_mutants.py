#!/usr/bin/env python3
"""Random samples of a crate's mutants: `draw FOLDER N SEED` chooses N of FOLDER/all.json for cargo-mutants, `score FOLDER` says how many tests saw.

FOLDER/drawn.toml is the configuration that names the chosen ones, FOLDER/score.md the table of the score. A mutant that does not compile does not
count, one that ends in no time counts as seen. Exit status 1 if fewer than nine in ten were seen, or one that is listed as equivalent was seen.
"""

import json
import random
import re
import sys
from pathlib import Path

LEAST = 0.9
EQUIVALENT = Path(__file__).with_name("rust-mutants.json")
# Line and column move with every edit, what is replaced in which function does not.
PLACE = re.compile(r":\d+:\d+:")


def draw(folder, count, seed):
    """Writes the names of `count` random mutants as cargo-mutants reads them."""
    names = sorted(mutant["name"] for mutant in json.loads((folder / "all.json").read_text()))
    if count > len(names):
        sys.exit(f"rust_mutants.py: {count} mutants: the crate has {len(names)}; ask for fewer")
    drawn = sorted(random.Random(seed).sample(names, count))
    # A string of JSON is one of TOML.
    patterns = ",\n".join(json.dumps(f"^{re.escape(name)}$") for name in drawn)
    (folder / "drawn.toml").write_text(f"examine_re = [\n{patterns}\n]\n")
    (folder / "drawn.json").write_text(json.dumps({"of": len(names), "seed": seed, "names": drawn}))


def lines(folder, name):
    path = folder / "mutants.out" / name
    return set(path.read_text().splitlines()) if path.exists() else set()


def score(folder):
    """Prints and keeps the score; returns whether it is enough."""
    drawn = json.loads((folder / "drawn.json").read_text())
    names = set(drawn["names"])
    skipped = lines(folder, "previously_caught.txt") & names
    missed = lines(folder, "missed.txt") & names
    seen = ((lines(folder, "caught.txt") | lines(folder, "timeout.txt")) & names) | skipped - missed
    unviable = lines(folder, "unviable.txt") & names
    seen -= unviable
    open_ = names - seen - missed - unviable
    if open_:
        sys.exit(f"rust_mutants.py: {len(open_)} of {len(names)} mutants were not tested; run the same command again")
    reasons = {(entry["mutant"]): entry["why"] for entry in json.loads(EQUIVALENT.read_text())}
    key = lambda name: PLACE.sub(":", name)
    equivalent = {name for name in missed if key(name) in reasons}
    wrong = [name for name in seen if key(name) in reasons]
    survived = sorted(missed - equivalent)
    share = len(seen) / (len(seen) + len(survived))
    text = [f"{len(names)} of {drawn['of']} mutants, seed {drawn['seed']}: {len(seen)} seen, {len(survived)} not seen, {len(equivalent)} equivalent,",
            f"{len(unviable)} that do not compile. Seen of those that count: {100 * share:.1f} %.", ""]
    text += [f"- not seen: `{name}`" for name in survived] + [f"- equivalent: `{name}`: {reasons[key(name)]}" for name in sorted(equivalent)]
    text += [f"- listed as equivalent, but seen: `{name}`" for name in wrong]
    (folder / "score.md").write_text("\n".join(text) + "\n")
    print("\n".join(text))
    return share >= LEAST and not wrong


def main():
    match sys.argv[1:]:
        case ["draw", folder, count, seed]:
            draw(Path(folder), int(count), int(seed))
        case ["score", folder]:
            sys.exit(0 if score(Path(folder)) else 1)
        case _:
            sys.exit(__doc__)


main()
