#!/usr/bin/env python3
"""Runs the real `edof reconstruct --board --words` and compares every word and code with contract.py.

    tests/oracles/check.py target/debug/edof [--photos DIR]

Frames: photographs (16-bit light behind a Bayer mosaic), black, white, random full range, pixels at the ends of their range.
Networks: all fixed ones in weights/, natural and extreme ones that the program draws.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

import numpy as np
from PIL import Image

import contract

PHASES = ["rggb", "grbg", "gbrg", "bggr"]
PROJECT = Path(__file__).resolve().parents[2]


def drawn_values(kind, shape, depth, seed):
    """Sensor values of a frame that no camera gave."""
    most = (1 << depth) - 1
    random = np.random.default_rng(seed)
    if kind == "black":
        return np.zeros(shape, np.int64)
    if kind == "white":
        return np.full(shape, most, np.int64)
    if kind == "ends":
        return random.choice([0, most], shape)
    return random.integers(0, most, shape, endpoint=True)


def photo_values(path, phase, depth, crop=None):
    """A photograph's codes as light, each pixel its filter's colour."""
    with Image.open(path) as image:
        colours = np.asarray(image.convert("RGB")).astype(np.int64)
    height, width = (side & ~1 for side in colours.shape[:2])
    if crop:
        height, width = crop
    dr, dc = contract.RED_SITE[phase]
    rows, columns = np.indices((height, width))
    red_or_green = (rows + dr) % 2 + (columns + dc) % 2
    codes = np.take_along_axis(colours[:height, :width], red_or_green[..., None], axis=2)[..., 0]
    return codes * 257 >> (16 - depth)


def write_raw(path, values, depth):
    """Writes the frame as its ending says; gives the options that reading it takes (section 1)."""
    height, width = values.shape
    if path.suffix == ".png":
        Image.fromarray((values << (16 - depth)).astype(np.uint16)).save(path)
        return ["--bit-depth", str(depth)]
    if path.suffix == ".pgm":
        header = f"P5\n{width} {height}\n{(1 << depth) - 1}\n".encode()
        samples = values.astype(">u2") if depth > 8 else values.astype(np.uint8)
        path.write_bytes(header + samples.tobytes())
        return ["--bit-depth", str(depth)] if depth == 8 else []
    if path.suffix == ".npy":
        np.save(path, np.asfortranarray(values) if depth == 16 else values.astype(">u2"))
        return ["--bit-depth", str(depth)]
    path.write_bytes(values.astype("<u2").tobytes())
    return ["--bit-depth", str(depth), "--size", f"{width}x{height}"]


class Differs(Exception):
    pass


class Checker:
    def __init__(self, edof, folder):
        self.edof, self.folder, self.numbers = edof, Path(folder), count()
        self.words = 0

    def run(self, *arguments):
        done = subprocess.run([self.edof, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder)
        if done.returncode != 0:
            raise Differs(f"edof {' '.join(map(str, arguments))}: {done.stderr.strip()}")

    def same(self, case, what, ours, theirs):
        ours, theirs = np.asarray(ours), np.asarray(theirs)
        if ours.shape != theirs.shape:
            raise Differs(f"{case}: {what} has shape {theirs.shape}, expected {ours.shape}")
        if not np.array_equal(ours, theirs):
            wrong = np.argwhere(ours != theirs)
            at = tuple(wrong[0])
            raise Differs(
                f"{case}: {what} differs at {len(wrong)} of {ours.size} places, first at {tuple(map(int, at))}: "
                f"got {theirs[at]}, expected {ours[at]}"
            )
        self.words += ours.size

    def network(self, name, *options):
        path = self.folder / f"{name}.fixed.safetensors"
        self.run("random-network", *options, "--out", path)
        return path

    def reconstructed(self, network, raw_words, phase):
        """From raw pixel words to overlap-added ones."""
        pixels, stride = contract.red_first(raw_words, phase), network.fixed["stride"]
        y = contract.windows(pixels, network.form["window"], stride)
        words, stages = contract.run(network, y)
        planes, saturated_sums = contract.overlap_add(words["f"], stride, *pixels.shape)
        return y, words, stages, planes, saturated_sums

    def check(self, case):
        """One frame through one network: every boundary, the codes, the pictures and the counters."""
        label, weights, values, depth, phase, ending, mode, gamma = case
        folder = self.folder / f"case{next(self.numbers)}"
        folder.mkdir()
        raw = folder / f"raw{ending}"
        options = write_raw(raw, values, depth)
        board, report = folder / "board.png", folder / "report.json"
        command = ["reconstruct", raw, *options, "--phase", phase, "--weights", weights, "--display", mode]
        command += ["--gamma", gamma, "--json", report]
        self.run(*command, "--board", "--words", folder, "--out", board)

        network = contract.Network.load(weights)
        raw_words = contract.encoded(contract.raw_words(values, depth), network.values)
        y, words, stages, planes, saturated_sums = self.reconstructed(network, contract.carried(raw_words), phase)
        codes, shown = contract.display(planes, phase, values.shape, mode, gamma, network.values)
        words |= dict(zip(("luma", "cb", "cr"), planes)) | dict(zip(("y_code", "cb_code", "cr_code"), codes))

        with np.load(folder / "words.npz") as theirs:
            if sorted(theirs) != sorted(words):
                raise Differs(f"{label}: words.npz holds {sorted(theirs)}, expected {sorted(words)}")
            for name, ours in words.items():
                self.same(label, name, ours, theirs[name])
        bytes_of = lambda data: np.frombuffer(data, np.uint8)
        self.same(label, "board.yuyv", bytes_of(contract.yuyv(codes)), bytes_of(board.with_suffix(".yuyv").read_bytes()))
        with Image.open(board) as image:
            self.same(label, "board.png", contract.shown(codes), np.asarray(image))

        told = json.loads(report.read_text())
        patches = y.shape[0] * y.shape[1]
        expected = {
            "counters": {"patches": patches, "stages": stages, "saturated_sums": saturated_sums},
            "display": {"mode": mode, **shown},
            "multiplications": contract.multiplications(network, patches, stages),
        }
        for field, ours in expected.items():
            if told[field] != ours:
                raise Differs(f"{label}: --json {field} is {told[field]}, expected {ours}")
        if gamma == "linear":
            # Without --board the network sees all bits.
            planes = self.reconstructed(network, raw_words, phase)[3]
            self.linear_picture(label, command, planes, phase, (values.shape, network.values), folder)
        for file in folder.iterdir():
            file.unlink()
        return saturated_sums + sum(stage["saturated_results"] for stage in stages)

    def linear_picture(self, label, command, planes, phase, of, folder):
        (size, values), picture = of, folder / "picture.png"
        self.run(*command, "--out", picture)
        ours = contract.linear_picture(planes, phase, size, 255, values)
        with Image.open(picture) as image:
            theirs = np.asarray(image)
        if values != "linear":
            # Light of encoded values is exact to 1e-7, so a code may round the other way.
            apart = ours.astype(np.int64) - theirs
            if np.abs(apart).max() > 1 or np.count_nonzero(apart) > apart.size / 1000:
                raise Differs(f"{label}: picture differs by up to {np.abs(apart).max()}")
            theirs = ours
        self.same(label, "picture", ours, theirs)

    def cable(self, weights, depth, phase):
        """A frame that `capture` writes for a playout card, and what the board makes of it without a word about how it was taken."""
        names = ["raw.png", "frame.2vuy", "alone.2vuy"]
        raw, video, alone = (self.folder / f"{depth}-{name}" for name in names)
        size = ["--size", "80x66", "--phase", phase]
        self.run("capture", "leaves", "--camera", "ring-outer", *size, "--bit-depth", depth, "--no-measure", "--out", raw, "--video", video)
        with Image.open(raw) as image:
            words = np.asarray(image).astype(np.int64)
        label = f"cable, {depth} bits, {phase}"
        array = self.folder / f"{depth}-array.npy"
        self.run("capture", "leaves", "--camera", "ring-outer", *size, "--bit-depth", depth, "--out", array)
        self.same(label, "npy", words >> (16 - depth), np.load(array))
        self.same(label, "2vuy", *(np.frombuffer(file, np.uint8) for file in (contract.playout(words), video.read_bytes())))
        alone.write_bytes(video.read_bytes())
        network = contract.Network.load(weights)
        y = self.reconstructed(network, contract.encoded(contract.carried(words), network.values), phase)[0]
        for file, options in [(video, ["--camera", "ring-outer"]), (alone, size)]:
            self.run("reconstruct", "--video", file, *options, "--weights", weights, "--words", self.folder, "--out", "x.png")
            with np.load(self.folder / "words.npz") as theirs:
                self.same(label, f"y of {file.name}", y, theirs["y"])

    def least_sides(self, weights):
        """Frames below the least sides are refused alike in all phases, by their own size."""
        least = contract.least_side(contract.Network.load(weights).form["window"])
        raw = self.folder / "small.pgm"
        for side, phase in [(side, phase) for side in (least - 2, least) for phase in PHASES]:
            options = write_raw(raw, np.zeros((side, side), np.int64), 8)
            command = [self.edof, "reconstruct", raw, *options, "--phase", phase, "--weights", weights, "--out", "x.png"]
            done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder)
            named = f"frame {side}x{side}" in done.stderr
            if (done.returncode, named) != ((1, True) if side < least else (0, False)):
                raise Differs(f"{side}x{side} {phase}: exit status {done.returncode}, {done.stderr.strip()}")


def drawn_cases(checker):
    """Every stride, window, recurrence, shrinkage, phase, depth, kind of file and display mode, on small frames."""
    forms = [
        "one-sided,w8,t2,c12", "two-sided,w8,t4,c24,difference", "one-sided,w12,t4,c32,r", "two-sided,w16,t3,c20,r,tied",
        "one-sided,w12,t6,c16,r,tied,difference", "two-sided,w8,t10,c9,r", "one-sided,w16,t2,c40,r", "two-sided,w12,t5,c33,difference,r",
        "firm,w8,t4,c24,r", "firm,w12,t5,c20,difference",
    ]  # fmt: skip
    kinds, endings = ["ends", "full", "white", "black"], [".png", ".pgm", ".npy", ".bin"]
    for index in range(60):
        stride = [8, 4, 2][index % 3]
        bits = 8 + index % 9
        form = forms[index % len(forms)]
        weights = checker.network(f"extreme{index}", "--form", form, "--bits", bits, "--stride", stride, "--seed", index)
        depth, phase, kind = 8 + index * 5 % 9, PHASES[(index + index // 4) % 4], kinds[index // 2 % 4]
        shape = (14 + 2 * (index % 5), 14 + 2 * (index * 3 % 11))
        values = drawn_values(kind, shape, depth, index)
        mode, gamma = ["colour", "luma"][index // 3 % 2], ["srgb", "linear", "bt709"][index % 7 % 3]
        label = f"extreme {index}: {form}, {bits} bits, stride {stride}, {kind} {shape}, {depth} bits, {phase}, {mode}, {gamma}"
        yield label, weights, values, depth, phase, endings[index % 4], mode, gamma
    for index, (stride, window) in enumerate([(8, 12), (4, 8), (2, 16), (4, 12), (2, 8)]):
        form = f"one-sided,w{window},r"
        options = ["--kind", "natural", "--form", form, "--stride", stride, "--seed", index]
        weights = checker.network(f"natural{index}", *options)
        for mode in ("colour", "luma"):
            phase = PHASES[index % 4]
            values = drawn_values("full", (36, 50), 10, index) // 2
            yield f"natural {index}: stride {stride}, {phase}, {mode}", weights, values, 10, phase, ".bin", mode, "srgb"


def shipped():
    networks = sorted((PROJECT / "weights").glob("*.fixed.safetensors"))
    if not networks:
        raise Differs("no fixed networks in weights/")
    return networks


def shipped_cases():
    """Every network that is shipped, on frames without photographs."""
    for index, weights in enumerate(shipped()):
        for kind in ("full", "ends", "white", "black"):
            phase, mode = PHASES[index % 4], ["colour", "luma"][index % 2]
            values = drawn_values(kind, (48, 62), 12, index)
            yield f"{weights.name}, {kind}, {phase}, {mode}", weights, values, 12, phase, ".png", mode, "srgb"


def photo_cases(checker, photos):
    """Every shipped network on whole photographs, natural ones at strides 4 and 2 on parts of them."""
    for index, weights in enumerate(shipped()):
        path, phase = photos[(5 * index) % len(photos)], PHASES[index % 4]
        mode, depth = ["colour", "luma"][index % 2], [16, 12, 10, 14][index % 4]
        label = f"{weights.name}, {path.name}, {phase}, {depth} bits, {mode}"
        yield label, weights, photo_values(path, phase, depth), depth, phase, ".png", mode, ["srgb", "linear"][index // 2 % 2]
    for index, stride in enumerate([4, 2]):
        options = ["--kind", "natural", "--form", "one-sided,w12,r", "--stride", stride, "--seed", 40 + index]
        weights = checker.network(f"photo{stride}", *options)
        path, phase = photos[-1 - index], PHASES[1 + index]
        values = photo_values(path, phase, 12, (128, 190))
        for mode in ("colour", "luma"):
            yield f"natural, stride {stride}, {path.name}, {mode}", weights, values, 12, phase, ".pgm", mode, "srgb"


def find_photos(given):
    folders = [given, os.environ.get("EDOF_KODAK"), PROJECT / "../shared/data/kodak"]
    folder = next(Path(folder) for folder in folders if folder)
    return sorted(folder.glob("*.png")), folder


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("edof", help="the program")
    arguments.add_argument("--photos", help="folder of PNG photographs [default: EDOF_KODAK, else ../shared/data/kodak]")
    given = arguments.parse_args()
    photos, folder = find_photos(given.photos)
    with tempfile.TemporaryDirectory() as scratch:
        checker = Checker(Path(given.edof).resolve(), scratch)
        cases = [*drawn_cases(checker), *shipped_cases()]
        for case in cases[:3]:
            checker.least_sides(case[1])
        for depth, phase in [(16, "gbrg"), (14, "rggb"), (12, "bggr"), (15, "grbg")]:
            checker.cable(PROJECT / "weights/edof-t4w12-outer-light.fixed.safetensors", depth, phase)
        if photos:
            cases += photo_cases(checker, photos)
        else:
            print(f"\n*** SKIPPED: NO PHOTOGRAPHS IN {folder}; set EDOF_KODAK. Nothing natural was compared. ***\n", flush=True)
        with ThreadPoolExecutor(2) as pool:
            saturated = sum(pool.map(checker.check, cases))
        if not saturated:
            raise Differs("no word saturated anywhere: the extremes are none")
        print(f"{len(cases)} frames, {checker.words:,} words and codes: no difference; {saturated:,} saturations among them")


if __name__ == "__main__":
    try:
        main()
    except Differs as difference:
        sys.exit(f"DIFFERENT: {difference}")
