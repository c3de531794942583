"""The page of colour in scripts/results.sh: colour.py scenes FOLDER draws scenes of known saturation; colour.py correlation PNG... prints how far the
colours of pictures go together; colour.py page FOLDER REVISION KODAK MORE FOLDS prints the page."""
import json
import random
import struct
import sys
import zlib
from collections import defaultdict
from math import sqrt
from pathlib import Path
from statistics import mean, stdev

import table

SATURATIONS = (0.0, 0.15, 0.3, 0.5, 1.0)
SCENES, HEIGHT, WIDTH = 5, 256, 384
NOISE = {"none": "no noise", "0.01": "σ = 0.01", "0.02": "σ = 0.02"}
LENSES = {"ring-outer": "edof-t4w12-outer-by-noise.float", "clear-mid": "edof-t4w12-clear-by-noise.float"}
TEST = {f"kodim{number:02}" for number in range(3, 25, 3)}


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write_png(path, rows, width):
    """Rows of bytes, red, green and blue in turn."""
    head = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b""))


def paeth(a, b, c):
    p = a + b - c
    far = abs(p - a), abs(p - b), abs(p - c)
    return a if far[0] <= far[1] and far[0] <= far[2] else b if far[1] <= far[2] else c


def read_png(path):
    """Rows of bytes of an 8-bit colour PNG that is not interlaced."""
    data, at, body, head = path.read_bytes(), 8, b"", None
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", data[at + 8 : at + 8 + length])
        elif kind == b"IDAT":
            body += data[at + 8 : at + 8 + length]
        at += 12 + length
    width, height, depth, colour, _, _, interlaced = head
    if (depth, colour, interlaced) != (8, 2, 0):
        sys.exit(f"{path}: expected an 8-bit RGB PNG that is not interlaced")
    raw, rows, step = zlib.decompress(body), [], 3 * width
    above = bytearray(step)
    for row in range(height):
        kind, line = raw[row * (step + 1)], bytearray(raw[row * (step + 1) + 1 : (row + 1) * (step + 1)])
        if kind == 1:
            for i in range(3, step):
                line[i] = (line[i] + line[i - 3]) & 255
        elif kind == 2:
            line = bytearray((a + b) & 255 for a, b in zip(line, above))
        elif kind == 3:
            for i in range(step):
                line[i] = (line[i] + ((line[i - 3] if i > 2 else 0) + above[i]) // 2) & 255
        elif kind == 4:
            for i in range(step):
                left, corner = (line[i - 3], above[i - 3]) if i > 2 else (0, 0)
                line[i] = (line[i] + paeth(left, above[i], corner)) & 255
        rows.append(line)
        above = line
    return rows


def correlation(rows):
    """Mean of the correlations of red's and of blue's horizontal gradients with green's."""
    sums = defaultdict(float)
    for row in rows:
        planes = [row[plane::3] for plane in range(3)]
        red, green, blue = ([b - a for a, b in zip(plane, plane[1:])] for plane in planes)
        for name, a, b in (("rr", red, red), ("gg", green, green), ("bb", blue, blue), ("rg", red, green), ("bg", blue, green)):
            sums[name] += sum(x * y for x, y in zip(a, b))
    own = [sums[f"{c}g"] / sqrt(sums[c * 2] * sums["gg"]) for c in "rb"]
    return mean(own)


def scene(seed):
    """Leaves of random size and colour, the last one in front: rows of three numbers from 0 to 1."""
    draw = random.Random(seed)
    rows = [[(0.5, 0.5, 0.5)] * WIDTH for _ in range(HEIGHT)]
    for _ in range(4000):
        radius = min(3 / sqrt(1 - draw.random()), 60)
        x, y, colour = draw.random() * WIDTH, draw.random() * HEIGHT, tuple(draw.uniform(0.1, 0.9) for _ in range(3))
        for row in range(max(0, int(y - radius)), min(HEIGHT, int(y + radius) + 1)):
            half = sqrt(max(0.0, radius * radius - (row - y) ** 2))
            first, last = max(0, int(x - half)), min(WIDTH, int(x + half) + 1)
            rows[row][first:last] = [colour] * max(0, last - first)
    return rows


def draw_scenes(folder):
    """Each scene with every saturation: 0 is grey, 1 is red, green and blue independent of each other."""
    folder.mkdir(parents=True, exist_ok=True)
    for seed in range(1, SCENES + 1):
        rows = scene(seed)
        for saturation in SATURATIONS:
            path = folder / f"scene{seed}{round(100 * saturation):03}.png"
            shown = []
            for row in rows:
                greys = [mean(pixel) for pixel in row]
                shown.append([round(255 * (g + saturation * (c - g))) for g, pixel in zip(greys, row) for c in pixel])
            write_png(path, shown, WIDTH)


def rows_of(*files):
    """Rows of files of JSON lines and of compact tables."""
    for file in map(Path, files):
        if file.suffix == ".csv":
            yield from ({**row, "psi": float(row["psi"]), "psnr_db": float(row["psnr_db"])} for row in table.read(file))
            continue
        for line in file.read_text().splitlines():
            row = json.loads(line)
            if "psnr_db" in row:
                yield row


def gains(*files):
    """Coded lens minus clear lens in dB: image, noise → average over ψ, at ψ = 8."""
    levels = defaultdict(dict)
    for row in rows_of(*files):
        if LENSES.get(row["camera"]) == row["method"]:
            levels[row["image"], str(row["noise"])][row["camera"], row["psi"]] = row["psnr_db"]
    found = {}
    for key, own in levels.items():
        depths = sorted({psi for _, psi in own})
        each = [own["ring-outer", psi] - own["clear-mid", psi] for psi in depths]
        found[key] = (mean(each), each[-1])
    return found


def with_error(values):
    if len(values) < 2:
        return f"{mean(values):+.2f}" if values else "–"
    return f"{mean(values):+.2f} ± {stdev(values) / sqrt(len(values)):.2f}"


def line(points):
    """Slope of the least-squares line through points, its standard error."""
    xs, ys = zip(*points)
    x, y = mean(xs), mean(ys)
    spread = sum((a - x) ** 2 for a in xs)
    slope = sum((a - x) * (b - y) for a, b in points) / spread
    rest = sum((b - y - slope * (a - x)) ** 2 for a, b in points)
    return slope, sqrt(rest / (len(points) - 2) / spread)


def table(header, rows):
    print("| " + " | ".join(header) + " |\n|" + "---|" * len(header))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def cells(own, images):
    """A cell for each noise: the gain on average over ψ / at ψ = 8."""
    return [" / ".join(with_error([own[image, noise][i] for image in images]) for i in (0, 1)) for noise in NOISE]


def slopes(own, known, images):
    """The same of the slope, in dB for 0.1 of correlation."""
    for noise in NOISE:
        yield [line([(known[image], own[image, noise][i]) for image in images]) for i in (0, 1)]


def in_words(slope, error):
    slope, error = slope / 10, error / 10
    if abs(slope) <= 2 * error:
        return f"does not depend on the correlation within the error ({slope:+.2f} ± {error:.2f} dB per 0.1)"
    return f"{'grows' if slope > 0 else 'falls'} by {abs(slope):.2f} ± {error:.2f} dB per 0.1 of correlation"


def augmented(folder, folds):
    """Networks with copies of random saturation and hue minus the one without, dB by photograph that was left out: noise → average, ψ = 8."""
    levels = defaultdict(dict)
    for fold in (fold for fold in folds if (folder / f"fold-{fold}.jsonl").exists()):
        for row in rows_of(folder / f"fold-{fold}.jsonl"):
            if row["method"].endswith(".float") and row["family"] == "network":
                kind = row["method"].removesuffix(".float").split("-")[0]
                levels[row["image"], str(row["noise"])][kind, row["psi"]] = row["psnr_db"]
    found = defaultdict(dict)
    for (image, noise), own in levels.items():
        depths = sorted({psi for kind, psi in own if kind == "plain"})
        each = [own["copies", psi] - own["plain", psi] for psi in depths]
        found[noise][image] = (mean(each), each[-1])
    return found


def page(folder, revision, kodak, more, folds):
    names = {"test": "docs/results/kodak-linear.csv", "held back": "docs/results/held-back.csv"}
    names |= {kind: folder / f"{kind}.jsonl" for kind in ("train-kodak", "train-more", "scenes")}
    names = {kind: file for kind, file in names.items() if Path(file).exists()}
    own = gains(*names.values())
    images = sorted({image for image, _ in own})
    place = lambda image: folder / "scenes" if image.startswith("scene") else more if image.startswith("more") else kodak
    known = {image: correlation(read_png(place(image) / f"{image}.png")) for image in images}
    of = {kind: sorted({row["image"] for row in rows_of(file)}) for kind, file in names.items()}
    unseen, seen = of["test"] + of["held back"], of.get("train-kodak", []) + of.get("train-more", [])
    print("# Why colour defeats the coded lens\n")
    print(f"Made by `scripts/results.sh colour` (revision `{revision}`).\n")
    print("Gain: the coded lens `ring-outer` minus the clear lens `clear-mid`, each with its networks by noise in floating point, RGB PSNR in dB. Two numbers are the average")
    print("over ψ = 0, 2, 4, 6, 8 and ψ = 8; a ± is the standard error over photographs, or of the slope of a straight line through all pictures. Correlation: horizontal gradients of red and of blue are correlated with those of")
    print("green over the whole picture, and the mean of both is taken. It is 1 for a grey picture. The ring moves sharpness between colours. The network carries it back where")
    print("colours go together. Rows of test and held-back photographs are those of [kodak-linear.md](kodak-linear.md) and [held-back.md](held-back.md).")
    print("Nothing was trained on the eight test photographs (Kodak 3, 6, … 24). Three choices were made with them in view: the weights of windows, the length of the second training")
    print("round, and the headroom of fixed point (docs/decisions, 0005 and 0002).\n")
    absent = [word for kind, word in (("scenes", "colour-scenes"), ("train-more", "colour-training")) if kind not in of]
    if absent:
        print(f"Not measured yet; these parts of `scripts/results.sh` add it: {', '.join(f'`{word}`' for word in absent)}.\n")
    print("## Verdict\n")
    groups = {f"{len(unseen)} photographs that the networks were not trained on": unseen, f"{len(seen)} training photographs": seen, "Synthetic scenes": of.get("scenes", [])}
    for group, members in groups.items():
        for noise, (average, last) in zip(NOISE.values(), slopes(own, known, members) if members else ()):
            print(f"- {group}, {noise}: on average over ψ the gain {in_words(*average)}. At ψ = 8 it {in_words(*last)}.")
    copies = augmented(folder, folds)
    for noise, name in NOISE.items():
        if copies.get(noise):
            values = list(zip(*copies[noise].values()))
            print(f"- Copies of random saturation and hue in training, {name}: {with_error(values[0])} dB on average over ψ, {with_error(values[1])} dB at ψ = 8.")
    print("\n## Photographs by correlation\n")
    ranges = (("below 0.9", -1, 0.9), ("0.9 to 0.97", 0.9, 0.97), ("from 0.97", 0.97, 2))
    rows = []
    for group, members in (("not trained on", unseen), ("training", seen)):
        for name, low, high in ranges:
            part = [image for image in members if low <= known[image] < high]
            if part:
                rows.append([group, name, str(len(part)), f"{mean(known[i] for i in part):.3f}", *cells(own, part)])
    header = list(NOISE.values())
    table(["photographs", "correlation", "count", "mean", *header], rows)
    if "scenes" in of:
        print("## Synthetic scenes of known saturation\n")
        print(f"{SCENES} scenes of leaves, {HEIGHT} × {WIDTH} pixels; shapes are the same at every saturation. Saturation 0 is grey; at 1 the three colours of a leaf are independent.\n")
        rows = []
        for saturation in SATURATIONS:
            part = [image for image in of["scenes"] if image.endswith(f"{round(100 * saturation):03}")]
            rows.append([str(saturation), f"{mean(known[i] for i in part):.3f}", *cells(own, part)])
        table(["saturation", "correlation", *header], rows)
    if copies:
        print("## Copies of random saturation and hue in training\n")
        print("Short trainings (8,000 steps, seed 1, camera `ring-outer`) with and without a copy of each photograph that has random saturation (0.8 to 1.8), hue (up to 20 degrees) and scale")
        print("(from 0.6). Training photographs are left out in turn, whole. dB with copies minus dB without, on the photographs left out.\n")
        images = sorted({image for own in copies.values() for image in own})
        rows = [[image, f"{known[image]:.3f}", *(" / ".join(f"{value:+.2f}" for value in copies[noise][image]) for noise in NOISE)] for image in images]
        if images:
            sums = [" / ".join(with_error(values) for values in zip(*copies[noise].values())) for noise in NOISE]
            rows.append(["all", f"{mean(known[i] for i in images):.3f}", *sums])
        table(["photograph left out", "correlation", *header], rows)
    print("## Each photograph that the networks were not trained on\n")
    rows = [[image, f"{known[image]:.3f}", *cells(own, [image])] for image in sorted(unseen, key=known.get)]
    table(["photograph", "correlation", *header], rows)


if __name__ == "__main__":
    command, *words = sys.argv[1:]
    if command == "scenes":
        draw_scenes(Path(words[0]))
    elif command == "correlation":
        for word in words:
            print(f"{correlation(read_png(Path(word))):.3f} {Path(word).stem}", flush=True)
    else:
        page(Path(words[0]), words[1], Path(words[2]), Path(words[3]), words[4:])
