"""The table of forms in scripts/results.sh: forms.py FOLDER LINE..., a line a form as there."""
import json
import sys
from pathlib import Path

# Stride of windows, so one window for so many pixels; outputs of F: 8x8 pixels of three colours.
PIXELS, OUTPUTS = 64, 192


def multiplications(form, non_zeros):
    """A pixel's, where a layer multiplies so many inputs: those of I and of the linear path are never zero."""
    window, codes = form["window"] ** 2, form["codes"]
    *between, last = non_zeros
    total = window * codes + sum(between) * codes + (last + window * form["linear_path"]) * OUTPUTS
    return total / PIXELS


def row(name, options, result):
    form, best = result["form"], max(result["seeds"][0]["history"], key=lambda at: at["step"])
    dense = multiplications(form, [form["codes"]] * (form["layers"] - 1))
    return {
        "name": name,
        "options": options,
        "db": best["validation_db"],
        "worst": best["worst_db"],
        "busy": best["non_zeros_busy"],
        "executed": multiplications(form, best["non_zeros_busy"]),
        "dense": dense,
    }


folder = Path(sys.argv[1])
rows, revisions = [], set()
for line in sys.argv[2:]:
    name, options = line.split(" ", 1)
    result = json.loads((folder / f"{name}.json").read_text())
    rows.append(row(name, options, result))
    revisions.add(result["provenance"]["revision"])
(revision,) = revisions
rows.sort(key=lambda r: r["executed"])
print("# Forms of the network\n")
print(f"Made by `scripts/results.sh forms` (revision `{revision}`).\n")
print("Short trainings (8,000 steps, seed 1, camera `ring-outer`) of other forms than the default's. dB: mean PSNR over all sets of")
print("validation windows (photographs of both kinds, five ψ, without noise and with σ = 0.01), and the worst ψ and noise. Non-zeros after each shrinkage where")
print("scenes are busy and noisy. Multiplications a pixel at stride 8 with those non-zeros, and dense. Bold: no other form here is at least as good with fewer.\n")
print("| options | dB | worst | non-zeros | multiplications a pixel | dense |")
print("|---|---|---|---|---|---|")
best = float("-inf")
for r in rows:
    mark = "**" if r["db"] > best else ""
    best = max(best, r["db"])
    busy = ", ".join(f"{n:.0f}" for n in r["busy"])
    print(f"| {mark}`{r['options']}`{mark} | {r['db']:.2f} | {r['worst']:.2f} | {busy} | {r['executed']:.0f} | {r['dense']:.0f} |")
