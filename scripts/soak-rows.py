#!/usr/bin/env python3
"""Measures one row of each page of docs/results again and compares it in all digits of its table, times and memory aside: scripts/soak-rows.py EDOF [PAGE]...

EDOF is the program. A page that differs is named with the field, and the exit status is then 1. Not among them: forms.md, layers.md,
ablations.md, classes.md, joint.md, bound.*, aperture-networks.* and colour.md, whose rows are of networks that scripts/results.sh trains.
Photographs: $EDOF_KODAK, else ../shared/data/kodak.
"""

import csv
import os
import pathlib
import subprocess
import sys
import tempfile

import table

RESULTS = pathlib.Path(__file__).resolve().parent.parent / "docs" / "results"
# What no two runs agree about, and what older rows do not have.
UNEQUAL = ("seconds", "repetitions", "memory", "place", "_sha256", "range", "crop")


def compared(old, new):
    """Cells of an old row that a new one does not have, or has otherwise."""
    names = [name for name in old if not any(part in name for part in UNEQUAL)]
    return [f"{name}: was {old[name]}, is {new.get(name)}" for name in names if old[name] != new.get(name)]


def run(edof, arguments, folder):
    """Runs the program."""
    command = [edof, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, cwd=RESULTS.parent.parent, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip().splitlines()[-1:]}")
    return folder


def study(edof, page, name, arguments, chosen, same):
    """One row of a study with a file of rows: the first of the page's that `chosen` takes, against the new one of the same `same` fields."""
    old = next((row for row in table.read(RESULTS / f"{page}.csv") if chosen(row)), None)
    if old is None:
        return [f"no such row in {page}.csv"]
    with tempfile.TemporaryDirectory() as folder:
        rows = pathlib.Path(folder) / "rows.jsonl"
        photo = str(int("".join(c for c in old["image"] if c.isdigit())))
        run(edof, ["study", name, "--rows", str(rows), "--photos", photo, *arguments], folder)
        new = [row for row in map(table.cells, table.rows_of(rows)[1]) if all(row[key] == old[key] for key in same)]
    return compared(old, new[0]) if len(new) == 1 else [f"{len(new)} rows in place of one"]


def lines(edof, page, arguments, belongs):
    """Lines of a page's tables that a run for some of its rows gives again."""
    with tempfile.TemporaryDirectory() as folder:
        markdown = pathlib.Path(folder) / "page.md"
        run(edof, ["study", *arguments, "--markdown", str(markdown)], folder)
        new = [line for line in markdown.read_text().splitlines() if belongs(line)]
    old = (RESULTS / f"{page}.md").read_text().splitlines()
    missing = [f"is not on the page: {line}" for line in new if line not in old]
    return missing if new else ["no line of the new page belongs to it"]


def scene(edof):
    """One lens and method of the scenes at four depths."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.csv"
        run(edof, ["study", "multi-depth", "--scenes", "leaves", "--nets", "paper-t4", "--csv", str(out)], folder)
        old, new = (list(csv.DictReader(path.open())) for path in (RESULTS / "multi-depth.csv", out))
    key = lambda row: (row["scene"], row["lens"], row["treatment"])
    ours = {key(row): row for row in new}
    both = [row for row in old if key(row) in ours]
    return [line for row in both for line in compared(row, ours[key(row)])] if both else ["no row of both"]


PHOTOGRAPHS = pathlib.Path(os.environ.get("EDOF_KODAK", RESULTS.parent.parent.parent / "shared/data/kodak"))
SHOTS = [word for number in ("01", "13", "20") for word in ("--photo", str(PHOTOGRAPHS / f"kodim{number}.png"))]
MORE = os.environ.get("EDOF_MORE", str(RESULTS.parent.parent.parent / "shared/data/more"))
FAR = ["--psi", "8", "--noise", "none"]
NET = ["method", "camera", "image", "psi", "noise"]


# Networks by noise of the coded lens.
CLASSES = "+".join(f"edof-t4w12-outer-{noise}" for noise in ("low", "mid", "high"))


def far(method):
    """Rows of a method at ψ = 8 without noise."""
    return lambda row: (row["method"], row["psi"], row["noise"]) == (method, "8", "none")


def held_back(page):
    """A row of photographs that were held back."""
    arguments = ["--images", MORE, "--nets", CLASSES, *FAR]
    return lambda edof: study(edof, page, "kodak", arguments, far("edof-t4w12-outer-by-noise.fixed"), NET)


PAGES = {
    "kodak-linear": lambda edof: study(
        edof, "kodak-linear", "kodak", ["--nets", "edof-t4w12-outer", *FAR], far("edof-t4w12-outer.fixed"), NET
    ),
    "kodak-srgb": lambda edof: study(
        edof, "kodak-srgb", "kodak", ["--tone", "srgb", "--nets", "edof-t4w12-outer", *FAR], far("edof-t4w12-outer.fixed"), NET
    ),
    "held-back": held_back("held-back"),
    "held-back-colourful": held_back("held-back-colourful"),
    "tolerances": lambda edof: study(
        edof,
        "tolerances",
        "tolerances",
        ["--net", CLASSES, "--errors", "radius", *FAR],
        lambda row: (row["kind"], row["psi"], row["noise"]) == ("radius", "8", "none"),
        ["kind", "amount", "image", "psi", "noise"],
    ),
    "aperture": lambda edof: lines(edof, "aperture", ["aperture", "--psi-ranges", "4", "--electrons", "1000"], lambda line: line.startswith("| 0 to 4 | 1000 |")),
    "single-depth": lambda edof: study(
        edof,
        "single-depth",
        "single-depth",
        ["--nets", "paper-t4", "--methods", "omp-known", "--stride", "8", *FAR],
        lambda row: far("omp-known-depth")(row) and row["stride"] == "8",
        NET,
    ),
    "overlap": lambda edof: study(
        edof,
        "overlap",
        "single-depth",
        ["--nets", "paper-t4", "--methods", "omp-known", "--stride", "4", *FAR],
        lambda row: far("omp-known-depth")(row) and row["stride"] == "4",
        NET,
    ),
    "blind": lambda edof: study(edof, "blind", "blind", ["--side", "15"], lambda _: True, ["image", "blur", "side"]),
    "blind-train": lambda edof: study(edof, "blind-train", "blind", ["--side", "15"], lambda _: True, ["image", "blur", "side"]),
    "knobs": lambda edof: study(
        edof,
        "knobs",
        "knobs",
        ["--knobs", "noise-class"],
        lambda row: (row["knob"], row["value"]) == ("noise-class", "0.02"),
        ["knob", "value", "image"],
    ),
    "multi-depth": scene,
    "bits": lambda edof: lines(edof, "bits", ["bits", "--nets", "edof-t4w12-clear"], lambda line: line.startswith("| 12 |")),
    "stability": lambda edof: lines(
        edof, "stability", ["stability", "--only", "flat-magenta"], lambda line: line.startswith("| `flat-magenta`")
    ),
    "design": lambda edof: lines(
        edof,
        "design",
        ["design", "--weights", "paper-t4", *SHOTS, "--psi", "0,4,8"],
        lambda line: line.startswith("| paper-t4 |"),
    ),
}


def main():
    """All pages, or those that are named."""
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    edof, *pages = sys.argv[1:]
    unknown = [page for page in pages if page not in PAGES]
    if unknown:
        sys.exit(f"{', '.join(unknown)}: must be one of {', '.join(PAGES)}")
    wrong = 0
    for page in pages or PAGES:
        differences = PAGES[page](edof)
        wrong += bool(differences)
        print(f"{page}: {'; '.join(differences) or 'a row is the same in every digit'}", flush=True)
    sys.exit(wrong != 0)


if __name__ == "__main__":
    main()
