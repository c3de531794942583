#!/usr/bin/env python3
"""`edof sensor` and `--sensor` against docs/sensor.md: a sensor with known faults is measured, its file is applied here in NumPy, and what the
real program makes of its frames must be what it makes of the frames that were corrected here, word by word. Pictures of a frame with 400 hot
pixels, a dead column, shading and offsets must be within 3 dB of the clean frame's in every window of 32x32.

    tests/oracles/sensor.py target/debug/edof [--photos DIR]
"""

import argparse
import json
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

PROJECT = Path(__file__).resolve().parents[2]
WEIGHTS = PROJECT / "weights/edof-t4w12-outer-light.fixed.safetensors"
DEPTH, BLACK, SIDE, HOT = 12, 256, 32, 400


class Differs(Exception):
    pass


# What docs/sensor.md defines


class SensorFile:
    """The tables of a sensor file."""

    def __init__(self, path):
        data = path.read_bytes()
        length = struct.unpack("<Q", data[:8])[0]
        header = json.loads(data[8 : 8 + length])
        fields = json.loads(header.pop("__metadata__")["edof_sensor"])
        kinds = {"I16": "<i2", "U16": "<u2", "U32": "<u4"}
        tables = {}
        for name, what in header.items():
            start, end = (8 + length + at for at in what["data_offsets"])
            tables[name] = np.frombuffer(data[start:end], kinds[what["dtype"]]).reshape(what["shape"]).astype(np.int64)
        self.width, self.height = (int(side) for side in fields["size"].split("x"))
        self.phase, self.depth, self.black = fields["phase"], fields["bit_depth"], fields["black"]
        self.tables = tables

    def defects(self):
        bad = np.zeros((self.height, self.width), bool)
        bad[tuple(self.tables["defective_pixels"].T)] = True
        bad[:, self.tables["defective_columns"]] = True
        bad[self.tables["defective_rows"], :] = True
        return bad

    def light(self, values):
        """Sensor values as light of 16 bits."""
        rows, columns = np.indices(values.shape)
        place = 2 * (rows % 2) + columns % 2
        offset = np.array(self.black)[place] + self.tables["columns"][None, :] + self.tables["rows"][:, None]
        offset = np.clip(offset + self.tables.get("pixels", 0), 0, 65535)
        above = np.maximum((values << (16 - self.depth)) - offset, 0)
        i, j, y, x = rows // 32, columns // 32, rows % 32, columns % 32
        g = self.tables["gains"]
        upper = (32 - x) * g[place, i, j] + x * g[place, i, j + 1]
        lower = (32 - x) * g[place, i + 1, j] + x * g[place, i + 1, j + 1]
        gain = ((32 - y) * upper + y * lower + 512) >> 10
        return repaired(np.minimum((above * gain + 8192) >> 14, 65535), self.defects(), self.phase)


def repaired(words, bad, phase):
    """Each defect as the median of the nearest good pixels of its colour, at most four rows and columns away."""
    height, width = words.shape
    source, words = words, words.copy()
    for row, column in np.argwhere(bad):
        is_green = phase[2 * (row % 2) + column % 2] == "g"
        found = {}
        for r in range(max(row - 4, 0), min(row + 5, height)):
            for c in range(max(column - 4, 0), min(column + 5, width)):
                dr, dc = abs(r - row), abs(c - column)
                same = (dr % 2, dc % 2) == (0, 0) or (is_green and (dr % 2, dc % 2) == (1, 1))
                if same and not bad[r, c]:
                    found.setdefault(dr * dr + dc * dc, []).append(int(source[r, c]))
        if found:
            nearest = sorted(found[min(found)])
            a, b = nearest[(len(nearest) - 1) // 2], nearest[len(nearest) // 2]
            words[row, column] = (a + b + 1) >> 1
    return words


# A sensor with known faults


class Planted:
    def __init__(self, shape, seed):
        height, width = shape
        random = np.random.default_rng(seed)
        self.random = random
        self.columns = np.where(random.random(width) < 0.2, 10.0, 0.0) + random.normal(0, 1.5, width)
        self.rows = random.normal(0, 1.5, height)
        self.pixels = random.normal(0, 4, shape)
        y, x = np.meshgrid(np.linspace(-1, 1, height), np.linspace(-1, 1, width), indexing="ij")
        rows, columns = np.indices(shape)
        self.shading = 1 - np.array([0.15, 0.17, 0.17, 0.2])[2 * (rows % 2) + columns % 2] * (y * y + x * x)
        self.hot = np.zeros(shape, bool)
        self.hot.flat[random.choice(height * width, HOT, replace=False)] = True
        self.hot_value = random.integers(300, 4096, shape)
        self.dead_column = width // 3 + 1
        self.hot[:, self.dead_column] = False

    def frame(self, light, noise):
        """Sensor values of light (0 to 4095 above black), with noise of the sensor."""
        value = BLACK + self.columns[None, :] + self.rows[:, None] + self.pixels + self.shading * light
        value = value + self.random.normal(0, noise, light.shape) + np.where(self.hot, self.hot_value, 0)
        value[:, self.dead_column] = 0
        return np.clip(np.rint(value), 0, 4095).astype(np.int64)

    def defects(self):
        bad = self.hot.copy()
        bad[:, self.dead_column] = True
        return bad


class Checker:
    def __init__(self, edof, folder):
        self.edof, self.folder = edof, Path(folder)

    def run(self, *arguments):
        done = subprocess.run([self.edof, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder)
        if done.returncode != 0:
            raise Differs(f"edof {' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return done.stdout

    def write(self, name, values, depth):
        Image.fromarray((values << (16 - depth)).astype(np.uint16)).save(self.folder / name)
        return name

    def picture(self, raw, *options):
        """The picture of a frame, and the words at every boundary."""
        self.run("reconstruct", raw, *options, "--weights", WEIGHTS, "--words", "words", "--out", "picture.png")
        with np.load(self.folder / "words/words.npz") as words:
            words = {name: words[name] for name in words}
        with Image.open(self.folder / "picture.png") as picture:
            return np.asarray(picture.convert("RGB")).astype(np.float64), words

    def measure(self, planted, shape, frames):
        """Makes sensor.safetensors; returns what the program says of it."""
        dark = [self.write(f"dark{i}.png", planted.frame(np.zeros(shape), 3), DEPTH) for i in range(frames)]
        flat = [self.write(f"flat{i}.png", planted.frame(np.full(shape, 2000.0), 12), DEPTH) for i in range(frames)]
        files = ["--dark", *dark, "--flat", *flat, "--bit-depth", DEPTH, "--phase", "rggb"]
        self.run("sensor", *files, "--out", "sensor.safetensors", "--json", "sensor.json")
        report = json.loads((self.folder / "sensor.json").read_text())
        return SensorFile(self.folder / "sensor.safetensors"), report

    def check(self, photo, seed):
        self.run("capture", photo, "--camera", "ring-outer", "--psi", 4, "--noise", "sensor:gain=2", "--bit-depth", DEPTH, "--black-level", 0,
                 "--no-measure", "--out", "clean.png", "--sharp", "sharp.png")  # fmt: skip
        with Image.open(self.folder / "clean.png") as image:
            clean = np.asarray(image).astype(np.int64) >> (16 - DEPTH)
        with Image.open(self.folder / "sharp.png") as image:
            sharp = np.asarray(image.convert("RGB")).astype(np.float64)
        (self.folder / "clean.png.json").unlink()
        planted = Planted(clean.shape, seed)
        # Full light of the clean frame becomes full light above black.
        dirty = planted.frame(clean * (4096 - BLACK) / 4096, 0)
        sensor, report = self.measure(planted, clean.shape, 16)
        missed = int((planted.defects() & ~sensor.defects()).sum())
        false = int((sensor.defects() & ~planted.defects()).sum())
        if missed or false > 5 or report["defective_columns"] != [planted.dead_column] or report["lost"]:
            raise Differs(f"{photo}: {missed} defects missed, {false} found that are none: {report}")

        # The same words from the program's correction and from the one here.
        stated = ["--phase", "rggb"]
        ours = self.write("corrected.png", sensor.light(dirty), 16)
        theirs = self.write("dirty.png", dirty, DEPTH)
        _, expected = self.picture(ours, *stated)
        found, found_words = self.picture(theirs, *stated, "--bit-depth", DEPTH, "--sensor", "sensor.safetensors")
        for name, words in expected.items():
            if not np.array_equal(words, found_words[name]):
                at = np.argwhere(words != found_words[name])
                raise Differs(f"{photo}: {name} differs at {len(at)} places, first at {at[0]}")
        self.streams(sensor, dirty)

        # Every window against that of the clean frame.
        plain, _ = self.picture("clean.png", *stated, "--bit-depth", DEPTH)
        raw, _ = self.picture(theirs, *stated, "--bit-depth", DEPTH, "--black-level", BLACK)
        worst = (windows(sharp, found) - windows(sharp, plain)).min()
        without = (windows(sharp, raw) - windows(sharp, plain)).min()
        print(f"{Path(photo).name}: {report['defective_pixels']} pixels and {len(report['defective_columns'])} column; worst window "
              f"{worst:.2f} dB against the clean frame, without the correction {without:.2f} dB")  # fmt: skip
        if worst < -3 or without > -10:
            raise Differs(f"{photo}: worst window {worst:.2f} dB, without the correction {without:.2f} dB")

    def streams(self, sensor, dirty):
        """A stream of the frame is that of the frame corrected here."""
        size = f"{dirty.shape[1]}x{dirty.shape[0]}"
        (self.folder / "dirty.raw").write_bytes(dirty.astype("<u2").tobytes())
        (self.folder / "corrected.raw").write_bytes(sensor.light(dirty).astype("<u2").tobytes())
        line = ["--size", size, "--weights", WEIGHTS]
        self.run("stream", "dirty.raw", *line, "--bit-depth", DEPTH, "--sensor", "sensor.safetensors", "--out", "dirty.y4m")
        self.run("stream", "corrected.raw", *line, "--out", "corrected.y4m")
        if (self.folder / "dirty.y4m").read_bytes() != (self.folder / "corrected.y4m").read_bytes():
            raise Differs("edof stream --sensor differs from the stream of the corrected frame")


def windows(truth, picture):
    """PSNR of each window, in dB of 8-bit codes."""
    height, width = (side // SIDE * SIDE for side in truth.shape[:2])
    error = ((truth - picture) ** 2)[:height, :width].mean(axis=2)
    error = error.reshape(height // SIDE, SIDE, width // SIDE, SIDE).mean(axis=(1, 3))
    return 10 * np.log10(255**2 / np.maximum(error, 1e-3))


def clusters(checker):
    """Neighbouring defects, whole blocks and lines, and the border: repairs equal those here, and what is lost is said."""
    random = np.random.default_rng(5)
    shape = (40, 50)
    values = random.integers(0, 4096, shape)
    bad = random.random(shape) < 0.25
    bad[12:22, 8:19] = True
    lines = [f"{r},{c}" for r, c in np.argwhere(bad)] + ["*,30", "*,31", "*,32", "7,*", "8,*"]
    (checker.folder / "list.txt").write_text("# planted\n" + "\n".join(lines))
    for phase in ["rggb", "grbg", "gbrg", "bggr"]:
        size = ["--size", "50x40", "--bit-depth", DEPTH, "--phase", phase]
        checker.run("sensor", "--list", "list.txt", *size, "--out", "sensor.safetensors", "--json", "sensor.json")
        sensor = SensorFile(checker.folder / "sensor.safetensors")
        lost = json.loads((checker.folder / "sensor.json").read_text())["lost"]
        if not lost:
            raise Differs("clusters: a block of 10x11 was repaired whole")
        expected = checker.picture(checker.write("ours.png", sensor.light(values), 16), "--phase", phase)[1]
        raw = checker.write("theirs.png", values, DEPTH)
        found = checker.picture(raw, "--phase", phase, "--bit-depth", DEPTH, "--sensor", "sensor.safetensors")[1]
        if any(not np.array_equal(words, found[name]) for name, words in expected.items()):
            raise Differs(f"clusters: {phase}: words differ")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("edof", help="the program")
    arguments.add_argument("--photos", help="folder of PNG photographs [default: EDOF_KODAK, else ../shared/data/kodak]")
    given = arguments.parse_args()
    folders = [given.photos, os.environ.get("EDOF_KODAK"), PROJECT / "../shared/data/kodak"]
    folder = next(Path(folder).resolve() for folder in folders if folder)
    photos = sorted(folder.glob("*.png"))[4::9] or ["leaves"]
    if photos == ["leaves"]:
        print(f"\n*** SKIPPED: NO PHOTOGRAPHS IN {folder}; set EDOF_KODAK. A synthetic scene takes their place. ***\n", flush=True)
    with tempfile.TemporaryDirectory() as scratch:
        checker = Checker(Path(given.edof).resolve(), scratch)
        clusters(checker)
        for seed, photo in enumerate(photos):
            checker.check(photo, seed)


if __name__ == "__main__":
    try:
        main()
    except Differs as difference:
        sys.exit(f"DIFFERENT: {difference}")
