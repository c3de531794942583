"""The table of layers in scripts/results.sh: layers.py FOLDER."""
import json
import sys
from pathlib import Path
from statistics import mean


def networks(folder):
    """Of each network T, its best validation, and what its float and fixed rows say on average: T ascending."""
    header, *rows = map(json.loads, (folder / "rows.jsonl").read_text().splitlines())
    rows = [row for row in rows if row["family"] == "network"]
    for layers in sorted({row["layers"] for row in rows}):
        seeds = json.loads((folder / f"paper-t{layers}-short.json").read_text())["seeds"]
        own = {kind: [row for row in rows if (row["layers"], row["format"]) == (layers, kind)] for kind in ("float", "fixed")}
        yield layers, max(at["validation_db"] for at in seeds[0]["history"]), own["float"], own["fixed"]


def of(rows, field):
    return mean(row[field] for row in rows)


folder = Path(sys.argv[1])
header = json.loads((folder / "rows.jsonl").read_text().splitlines()[0])
host = header["host"]
machine = f"{host['cpu']} (family {host.get('family')}, model {host.get('model')}), {host['threads']} threads"
print("# Layers of the network\n")
print(f"Made by `scripts/results.sh layers` (revision `{header['revision']}`).\n")
print("Short trainings (8,000 steps, seed 1, camera `ring-2018`) of the paper's form (`paper-t4`: two-sided, windows of 8, 192 codes) with T = 3 to 10:")
print("one recipe for all, a fifth of the steps of the committed `paper-t4`'s first round and none of its second, at half its rate (at the whole of it T = 10 came to 36.13 dB on")
print("validation windows, after 28.83 at the first look, where T = 3 to 8 came to 37.94 to 38.24). Validation: mean PSNR over all sets of validation windows (photographs of both")
print("kinds, five ψ, without noise and with σ = 0.01). All else is of the eight test photographs, ψ = 8, no noise, stride 8.")
print("Nothing was trained on the eight test photographs (Kodak 3, 6, … 24). Three choices were made with them in view: the weights of windows, the length of the second")
print("training round, and the headroom of fixed point (docs/decisions, 0005 and 0002).")
print("Fixed: 16-bit integers, quantized on drawn scenes. Non-zeros a patch after each shrinkage and multiplications a pixel are those of the integers, executed and dense.")
print(f"CPU seconds a megapixel are those of all threads together on {machine}, beside other work.\n")
print("| T | validation dB | float dB | SSIM | fixed dB | SSIM | CPU s, float | CPU s, fixed | non-zeros | multiplications | dense |")
print("|---|---|---|---|---|---|---|---|---|---|---|")
for layers, validation, floating, fixed in networks(folder):
    quality = " | ".join(f"{of(rows, 'psnr_db'):.2f} | {of(rows, 'ssim'):.3f}" for rows in (floating, fixed))
    seconds = " | ".join(f"{of(rows, 'cpu_seconds_per_megapixel'):.3f}" for rows in (floating, fixed))
    non_zeros = ", ".join(f"{mean(all):.0f}" for all in zip(*(row["nonzeros_a_patch"] for row in fixed)))
    work = " | ".join(f"{of(fixed, kind + '_multiplications_a_pixel'):.0f}" for kind in ("executed", "dense"))
    print(f"| {layers} | {validation:.2f} | {quality} | {seconds} | {non_zeros} | {work} |")
