"""The tables of short trainings in scripts/results.sh: short_trainings.py PAGE FOLDER LINE..., a line a training as there."""
import json
import sys
from pathlib import Path

# Stride of windows, so one window for so many pixels; outputs of F: 8x8 pixels of three colours.
PIXELS, OUTPUTS = 64, 192

PAGES = {
    "forms": (
        "Forms of the network",
        ["Short trainings (8,000 steps, seed 1, camera `ring-outer`) of other forms than the default's."],
    ),
    "ablations": (
        "The training recipe with one change each",
        [
            "Short trainings of the default form behind `ring-outer`: 8,000 steps and seed 1 unless the options say otherwise. The first line is the recipe",
            "(docs/decisions/0005-training.md); the lines with another seed show what differences mean nothing.",
        ],
    ),
    "classes": (
        "Classes of noise",
        [
            "Short trainings of the default form behind `ring-outer`, 8,000 steps and seed 1 each. The first line serves all noise. Lines with `--from` go on",
            "from it for 8,000 steps: the second with all weights and all noise, those with `--only thresholds` for one class of noise, where only the",
            "thresholds may change. A board then loads a few hundred words for another class of noise; a network of its own replaces all weights.",
        ],
    ),
}


def multiplications(form, non_zeros):
    """A pixel's, where a layer multiplies so many inputs: those of I and of the linear path are never zero."""
    window, codes = form["window"] ** 2, form["codes"]
    *between, last = non_zeros
    total = window * codes + sum(between) * codes + (last + window * form["linear_path"]) * OUTPUTS
    return total / PIXELS


def row(name, options, result):
    form, best = result["form"], result["validation"]
    dense = multiplications(form, [form["codes"]] * (form["layers"] - 1))
    return {
        "name": name,
        "options": options,
        "levels": {level["noise"]: (level["db"], level["worst_db"]) for level in best["levels"]},
        "busy": best["non_zeros_busy"],
        "executed": multiplications(form, best["non_zeros_busy"]),
        "dense": dense,
    }


page, folder = sys.argv[1], Path(sys.argv[2])
rows, revisions = [], set()
for line in sys.argv[3:]:
    name, options = line.split(" ", 1)
    options = options.replace(f"{folder}/", "")
    result = json.loads((folder / f"{name}.json").read_text())
    rows.append(row(name, options, result))
    revisions.add(result["provenance"]["revision"])
(revision,) = revisions
if page == "forms":
    rows.sort(key=lambda r: r["executed"])
title, text = PAGES[page]
print(f"# {title}\n")
print(f"Made by `scripts/results.sh {page}` (revision `{revision}`).\n")
print("\n".join(text))
print("dB: mean PSNR over validation windows (30 photographs of both kinds, five ψ) / mean over photographs at the worst ψ, for each noise σ that")
print("the training's range holds. Non-zeros after each shrinkage on the busiest quarter of noisy windows. Multiplications per pixel at stride 8 with those")
print("non-zeros, and dense.\n")
levels = ["none", "0.01", "0.02"]
print("| options | no noise | σ = 0.01 | σ = 0.02 | non-zeros | multiplications per pixel | dense |")
print("|---|---|---|---|---|---|---|")
for r in rows:
    busy = ", ".join(f"{n:.0f}" for n in r["busy"])
    db = " | ".join("%.2f / %.2f" % r["levels"][level] if level in r["levels"] else "–" for level in levels)
    print(f"| `{r['options']}` | {db} | {busy} | {r['executed']:.0f} | {r['dense']:.0f} |")
