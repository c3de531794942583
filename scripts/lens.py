"""A camera file on standard output: lens.py NAME RANGE.

NAME is clear-STOPS, cubic-RADIANS-STOPS or a preset, whose focus goes with its range. The first two are the lens of clear-mid, closed by STOPS and focused at the middle of ψ 0 to
RANGE of the open aperture. A cubic mask has the phase RADIANS·(x³ + y³ + 0.2/2.3·(x²y + xy²)) over the aperture in use, in the glass of edof optics advise.
"""
import json
import sys
from pathlib import Path

GLASS = [1.458, 0.00354]
MIXED = 0.2 / 2.3

name, psi_range = sys.argv[1], float(sys.argv[2])
kind, *numbers = name.split("-")
if kind not in ("clear", "cubic") or not (numbers and numbers[0][0].isdigit()):
    text = Path(f"cameras/{name}.json").read_text()
    preset = json.loads(text)
    if preset["psi_range"][1] != psi_range:
        preset["focus_psi"] *= psi_range / preset["psi_range"][1]
        preset["psi_range"] = [0, psi_range]
        preset["source"] += f" Range and focus by scripts/lens.py {name} {psi_range:g}."
        text = json.dumps(preset, indent=2) + "\n"
    print(text, end="")
    sys.exit()
*strength, stops = map(float, numbers)
camera = json.loads(Path("cameras/clear-mid.json").read_text())
smaller = 2**-stops
camera |= {
    "name": name,
    "aperture_radius_mm": camera["aperture_radius_mm"] * smaller**0.5,
    "focus_psi": psi_range / 2 * smaller,
    "psi_range": [0, psi_range * smaller],
    "source": f"scripts/lens.py {name} {psi_range:g}",
}
for rad in strength:
    mixed = round(rad * MIXED, 4)
    powers = [(3, 0, rad), (0, 3, rad), (2, 1, mixed), (1, 2, mixed)]
    terms = [{"x": x, "y": y, "rad": r} for x, y, r in powers]
    camera["mask"] = [{"polynomial": {"at_nm": camera["reference_wavelength_nm"], "cauchy": GLASS, "terms": terms}}]
print(json.dumps(camera, indent=2))
