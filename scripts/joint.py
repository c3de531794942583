"""The page of lenses found together with a network, in scripts/results.sh: joint.py FOLDER NAME=FILE..., a camera file a lens."""
import json
import math
import sys
from pathlib import Path
from statistics import mean, stdev

LEVELS = ["none", "0.01", "0.02"]
# The levels that the search weighs.
SOUGHT = ["none", "0.01"]
REFERENCE = "ring-outer"
# Those of the reference; all other lenses have the first alone.
SEEDS = [1, 2, 3]


def photographs(folder, lens, seed):
    """dB of a lens with its network: {level: {photograph: [dB of each ψ]}}."""
    result = json.loads((folder / f"{lens}-{seed}.json").read_text())
    levels = {}
    for row in result["validation"]["photographs"]:
        levels.setdefault(row["noise"], {})[row["name"]] = row["db"]
    return levels, result["provenance"]["revision"]


def summed(levels, level):
    """Of each photograph: the average over ψ, and the dB at the ψ that is worst on average over photographs."""
    dbs = levels[level]
    psis = range(len(next(iter(dbs.values()))))
    worst = min(psis, key=lambda p: mean(db[p] for db in dbs.values()))
    return {name: (mean(db), db[worst]) for name, db in dbs.items()}


def scores(levels):
    """Of each photograph, what the search maximises: average and worst ψ alike, without noise and with σ 0.01 alike."""
    parts = [summed(levels, level) for level in SOUGHT]
    return {name: mean(mean(part[name]) for part in parts) for name in parts[0]}


def lens_words(camera):
    reference = camera["reference_wavelength_nm"]

    def ring(r):
        phase = r["delay"]["phase"]
        return f"ring {r['inner']:.3f} to {r['outer']:.3f}, {phase['rad'] * phase['at_nm'] / reference:+.2f} rad"

    sign = "" if camera["defocus_sign"] == 1 or not camera["rings"] else ", defocus sign −"
    return "; ".join([ring(r) for r in camera["rings"]] + [f"focus {camera['focus_psi']:.2f}"]) + sign


folder = Path(sys.argv[1])
lenses, revisions = {}, set()
for argument in sys.argv[2:]:
    lens, file = argument.split("=", 1)
    levels, revision = photographs(folder, lens, 1)
    lenses[lens] = (json.loads(Path(file).read_text()), levels)
    revisions.add(revision)
(revision,) = revisions

seeds = [mean(scores(photographs(folder, REFERENCE, seed)[0]).values()) for seed in SEEDS]
spread = stdev(seeds)
reference = scores(lenses[REFERENCE][1])
differences = {}
for lens, (_, levels) in lenses.items():
    own = scores(levels)
    paired = [own[name] - reference[name] for name in reference]
    differences[lens] = (mean(paired), math.sqrt(stdev(paired) ** 2 / len(paired) + 2 * spread**2))

print("# The mask through the network: lens and network searched together\n")
print(f"Made by `scripts/results.sh joint` (revision `{revision}`).\n")
found = [lens for lens in lenses if lens not in (REFERENCE, "clear-mid")]
best = max(found, key=lambda lens: differences[lens][0])
difference, error = differences[best]
if difference > 2 * error:
    verdict = f"`{best}` is better than `{REFERENCE}` by {difference:.2f} ± {error:.2f} dB of score."
elif difference < -2 * error:
    verdict = f"no lens that was found is as good as `{REFERENCE}`; the best, `{best}`, is worse by {-difference:.2f} ± {error:.2f} dB of score."
else:
    verdict = f"no lens that was found is better than `{REFERENCE}` by more than twice the error; the best, `{best}`, differs by {difference:+.2f} ± {error:.2f} dB of score."
print(f"**Verdict.** Of {len(found)} searches, {verdict}\n")
clear = differences.get("clear-focus")
if clear and "clear-mid" in differences:
    of_mid = differences["clear-mid"]
    print(f"The clear lens with a searched focus has a score of {clear[0] - of_mid[0]:+.2f} dB against `clear-mid`.\n")
print("Each search moves radii, phases and focus along the gradient of the PSNR through the network (`edof optics design --through`).")
print("A step that lowers the score by more than 0.02 dB is taken back and shortened.")
print("It uses eight training photographs, five ψ, and σ = 0 and 0.01. The score is the mean of the average over ψ and of the worst ψ.")
print("`outer`, `2018` and `clear-focus` begin with `ring-outer`, `ring-2018` and `clear-mid`; the others begin at random.\n")
print("Then each lens has networks trained from scratch by one short recipe, the same for all. dB: mean PSNR over validation windows")
print(f"({len(reference)} photographs, five ψ; no test and no held-back photograph) / mean over photographs at the worst ψ.")
print(f"Difference: score minus that of `{REFERENCE}`, paired by photograph. Its ± is the standard error over photographs and seeds.")
print(f"The score's standard deviation over {len(SEEDS)} seeds of `{REFERENCE}` is {spread:.3f} dB; every other lens has one seed.\n")
print("| lens | no noise | σ = 0.01 | σ = 0.02 | score | difference |")
print("|---|---|---|---|---|---|")
for lens, (_, levels) in lenses.items():
    cells = []
    for level in LEVELS:
        rows = summed(levels, level).values()
        cells.append("%.2f / %.2f" % tuple(mean(row[i] for row in rows) for i in (0, 1)))
    plus = "–" if lens == REFERENCE else "%+.2f ± %.2f" % differences[lens]
    print(f"| `{lens}` | {' | '.join(cells)} | {mean(scores(levels).values()):.2f} | {plus} |")
print("\nThe lenses (radii as shares of the aperture's, phases at 460 nm, focus in ψ):\n")
print("| lens | mask and focus | score in the search's first round | in its best |")
print("|---|---|---|---|")
for lens, (camera, _) in lenses.items():
    search = folder / f"{lens}.search.json"
    ends = ["–", "–"]
    if search.exists():
        result = json.loads(search.read_text())
        ends = ["%.2f" % db for db in (result["history"][0]["score_db"], result["score_db"])]
    print(f"| `{lens}` | {lens_words(camera)} | {ends[0]} | {ends[1]} |")
