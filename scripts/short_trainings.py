"""The tables of short trainings in scripts/results.sh: short_trainings.py PAGE FOLDER LINE..., a line a training as there."""
import json
import statistics
import sys
from pathlib import Path

# Stride of windows, so one window for so many pixels; outputs of F: 8x8 pixels of three colours.
PIXELS, OUTPUTS = 64, 192
LEVELS = {"none": "no noise", "0.01": "σ = 0.01", "0.02": "σ = 0.02"}


def dense_share(options):
    """Share of the products of I and of the linear path that a structure of the weights leaves."""
    words = options.split()
    structure = words[words.index("--structure") + 1] if "--structure" in words else "free"
    if structure == "symmetric":
        return 0.5
    return 1 - float(structure.removeprefix("blocks:")) if structure.startswith("blocks:") else 1


def multiplications(form, share, non_zeros):
    """A pixel's, where a layer multiplies so many inputs: those of I and of the linear path are never zero."""
    window, codes = form["window"] ** 2, form["codes"]
    *between, last = non_zeros
    total = share * window * codes + sum(between) * codes + (last + share * window * form["linear_path"]) * OUTPUTS
    return total / PIXELS


def row(name, options, result):
    form, best = result["form"], result["validation"]
    share = dense_share(options)
    dense = multiplications(form, share, [form["codes"]] * (form["layers"] - 1))
    photographs = {level: {} for level in LEVELS}
    for photograph in best["photographs"]:
        if photograph["noise"] in LEVELS:
            photographs[photograph["noise"]][photograph["name"]] = statistics.fmean(photograph["db"])
    return {
        "name": name,
        "options": options,
        "levels": {level["noise"]: (level["db"], level["worst_db"]) for level in best["levels"]},
        "photographs": photographs,
        "busy": best["non_zeros_busy"],
        "executed": multiplications(form, share, best["non_zeros_busy"]),
        "dense": dense,
    }


def gain(row, reference, level):
    """Mean over photographs of the difference to another training, and its standard error; None where one has no such noise."""
    here, there = row["photographs"][level], reference["photographs"][level]
    differences = [here[name] - there[name] for name in here if name in there]
    if len(differences) < 2:
        return None
    return statistics.fmean(differences), statistics.stdev(differences) / len(differences) ** 0.5


def words(found):
    return "%+.2f ± %.2f dB" % found


def clear(found, spread):
    """Whether a difference is more than twice its error: that over photographs and, of two trainings, that of the seed."""
    mean, error = found
    return abs(mean) > 2 * (error**2 + 2 * spread**2) ** 0.5


def verdict_of_ablations(rows):
    seeds = [r for r in rows if r["name"] in ("recipe", "seed-2", "seed-3")]
    lines = []
    for level, title in LEVELS.items():
        spread = statistics.stdev(r["levels"][level][0] for r in seeds)
        found = [(r, gain(r, rows[0], level)) for r in rows if r not in seeds]
        told = [(r, g) for r, g in found if g and clear(g, spread)]
        better = [f"`{r['name']}` {words(g)}" for r, g in sorted(told, key=lambda pair: -pair[1][0]) if g[0] > 0]
        worse = [f"`{r['name']}` {words(g)}" for r, g in sorted(told, key=lambda pair: pair[1][0]) if g[0] < 0]
        lines.append(
            f"- With {title} (standard deviation over the three seeds {spread:.3f} dB): better {', '.join(better) or 'none'}; "
            f"worse {', '.join(worse) or 'none'}."
        )
    lead = "Changes whose difference to the recipe is more than twice its error. The error is that over photographs and seeds; a range of noise of its own is a class."
    return [lead, "", *lines]


def verdict_of_classes(rows):
    by_name = {r["name"]: r for r in rows}
    lines = []
    for name, level in (("low", "none"), ("mid", "0.01"), ("high", "0.02")):
        own, cheap = (gain(by_name[n], by_name["all-on"], level) for n in (name, f"{name}-thresholds"))
        lines.append(f"- With {LEVELS[level]}: `{name}` {words(own)}, `{name}-thresholds` {words(cheap)}.")
    lead = (
        "Against the network for all noise with 8,000 further steps (`all-on`). It and thresholds alone have had 16,000 steps in all, the networks of a class 8,000."
    )
    return [lead, "", *lines]


def verdict_of_forms(rows):
    default = next(r for r in rows if r["name"] == "t4w12")
    lines = []
    for r in sorted((r for r in rows if r is not default), key=lambda r: r["executed"]):
        more = 100 * (r["executed"] / default["executed"] - 1)
        gains = ", ".join(f"{words(gain(r, default, level))} with {title}" for level, title in LEVELS.items() if gain(r, default, level))
        lines.append(f"- `{r['name']}`, {abs(more):.0f} % {'more' if more > 0 else 'fewer'} multiplications: {gains}.")
    cheap = [r for r in rows if r is not default and r["executed"] <= default["executed"] and gain(r, default, "0.01")[0] >= 0.2]
    names = ", ".join(f"`{r['name']}`" for r in cheap)
    lead = "Better than the default by 0.2 dB at σ = 0.01 for no more multiplications: " + (names or "none") + ". Each form against the default:"
    return [lead, "", *lines]


PAGES = {
    "forms": (
        "Forms of the network",
        [
            "Short trainings (8,000 steps, seed 1, camera `ring-outer`) of other forms than the default's, `t4w12`. With `--structure symmetric` codes are pairs, the",
            "second the first's for a transposed window: sums and differences of pixels across the diagonal halve the products of I and of the linear path. With",
            "`--structure blocks:SHARE` so many blocks of both (8 codes by 4 pixels) are zero; it goes on from `t4w12`, as `t4w12on` does without. Additions are not",
            "counted. A code that is not shrunk needs no form of its own: thresholds may be negative, and a budget counts it as a non-zero.",
        ],
        verdict_of_forms,
    ),
    "ablations": (
        "The training recipe with one change each",
        [
            "Short trainings of the default form behind `ring-outer`: 8,000 steps and seed 1 unless the options say otherwise. The first line is the recipe",
            "(docs/decisions/0005-training.md); the lines with another seed show what differences mean nothing.",
        ],
        verdict_of_ablations,
    ),
    "classes": (
        "Classes of noise",
        [
            "Short trainings of the default form behind `ring-outer`, 8,000 steps and seed 1 each. The first line serves all noise. Lines with `--from` go on",
            "from it for 8,000 steps: the second with all weights and all noise, those with `--only thresholds` for one class of noise, where only the",
            "thresholds may change. A board then loads a few hundred words for another class of noise; a network of its own replaces all weights.",
        ],
        verdict_of_classes,
    ),
}


def main():
    page, folder = sys.argv[1], Path(sys.argv[2])
    rows, revisions = [], set()
    for line in sys.argv[3:]:
        name, options = line.split(" ", 1)
        options = options.replace(f"{folder}/", "")
        result = json.loads((folder / f"{name}.json").read_text())
        rows.append(row(name, options, result))
        revisions.add(result["provenance"]["revision"])
    (revision,) = revisions
    title, text, verdict = PAGES[page]
    said = verdict(rows)
    reference = next(r for r in rows if r["name"] == "t4w12") if page == "forms" else rows[0]
    if page == "forms":
        rows.sort(key=lambda r: r["executed"])
    print(f"# {title}\n")
    print(f"Made by `scripts/results.sh {page}` (revision `{revision}`).\n")
    print(f"**Verdict.** {said[0]}")
    print("\n".join(said[1:]) + "\n")
    print("\n".join(text))
    print("dB: mean PSNR over validation windows (30 photographs of both kinds, five ψ) / mean over photographs at the worst ψ, for each noise σ that")
    print(f"the training's range holds. Below it the first of them minus that of `{reference['name']}`, paired by photograph, with the standard error of the mean.")
    print("Non-zeros after each shrinkage on the busiest quarter of noisy windows. Multiplications per pixel at stride 8 with those non-zeros, and dense.\n")
    print("| name | options | " + " | ".join(LEVELS.values()) + " | non-zeros | multiplications per pixel | dense |")
    print("|---|---|---|---|---|---|---|---|")
    for r in rows:
        cells = []
        for level in LEVELS:
            cell = "%.2f / %.2f" % r["levels"][level] if level in r["levels"] else "–"
            difference = gain(r, reference, level) if r is not reference else None
            cells.append(cell + ("<br>%+.2f ± %.2f" % difference if difference else ""))
        busy = ", ".join(f"{n:.0f}" for n in r["busy"])
        print(f"| {r['name']} | `{r['options']}` | {' | '.join(cells)} | {busy} | {r['executed']:.0f} | {r['dense']:.0f} |")


if __name__ == "__main__":
    main()
