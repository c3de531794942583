"""A four-depth capture by `edof capture` against SciPy doing the same: blur of each layer and matte, layers over each other, mosaic.

Usage: optics_scipy.py EDOF WIDTH HEIGHT THREADS ROUNDS OUT.json

Both get the same drawn layers and the same PSFs. The whole of `edof capture` is timed: reading seven PNG files, PSFs, writing the raw frame.
Of SciPy only what happens between arrays is. Ratios round by round; processor time is what a busy machine does not add to.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy
from PIL import Image
from scipy.fft import set_workers
from scipy.signal import oaconvolve

edof, width, height, threads, rounds, out = sys.argv[1], *map(int, sys.argv[2:6]), sys.argv[6]
Image.MAX_IMAGE_PIXELS = None
PSIS = [0, 3, 6, 8]
CAMERA = "ring-2018"


def draw(folder):
    """Four layers of soft patterns, three of them in disks; their files and their light, 0 to 1."""
    random = np.random.default_rng(1)
    rows, columns = np.mgrid[:height, :width].astype(np.float32)
    layers, listed = [], []
    for i, psi in enumerate(PSIS):
        small = random.integers(0, 256, (height // 8, width // 8, 3), dtype=np.uint8)
        picture = Image.fromarray(small).resize((width, height), Image.Resampling.BICUBIC)
        picture.save(f"{folder}/{i}.png", compress_level=1)
        entry, matte = {"picture": f"{i}.png", "depth": psi}, None
        if i:
            y, x, r = height * (0.2 + 0.2 * i), width * (0.15 + 0.2 * i), height * 0.3
            inside = ((rows - y) ** 2 + (columns - x) ** 2 < r * r).astype(np.uint8) * 255
            Image.fromarray(inside).save(f"{folder}/{i}-matte.png", compress_level=1)
            entry["matte"], matte = f"{i}-matte.png", inside.astype(np.float32) / 255
        light = np.asarray(picture, dtype=np.float32).transpose(2, 0, 1) / 255
        layers.append((light if matte is None else light * matte, matte))
        listed.append(entry)
    with open(f"{folder}/scene.json", "w") as file:
        json.dump({"layers": listed}, file)
    return layers


def blur(plane, kernel):
    reach = [side // 2 for side in kernel.shape]
    around = np.pad(plane, [(r, r) for r in reach], mode="reflect")
    return oaconvolve(around, kernel, mode="valid")


def capture(layers, psfs):
    """12-bit values behind red-first filters."""
    raw = np.empty((height, width), dtype=np.uint16)
    with set_workers(threads):
        for channel in range(3):
            total = 0
            for (light, matte), kernels in zip(layers, psfs):
                if matte is not None:
                    total *= 1 - blur(matte, kernels[channel])
                total = total + blur(light[channel], kernels[channel])
            for row, column in {0: [(0, 0)], 1: [(0, 1), (1, 0)], 2: [(1, 1)]}[channel]:
                part = total[row::2, column::2]
                raw[row::2, column::2] = np.clip(np.floor(part * 4096 + 0.5), 0, 4095)
    return raw


def trimmed(kernel):
    """Without the zeros around it that only larger kernels of the bank need."""
    reach = max(abs(np.argwhere(kernel) - kernel.shape[0] // 2).max(), 1)
    middle = kernel.shape[0] // 2
    return np.ascontiguousarray(kernel[middle - reach : middle + reach + 1, middle - reach : middle + reach + 1], dtype=np.float32)


def ours(folder):
    args = [edof, "-q", "capture", f"{folder}/scene.json", "--camera", CAMERA, "--tone", "linear", "--noise", "0", "--no-measure", "--out", f"{folder}/raw.png"]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(args, check=True, stdout=subprocess.DEVNULL, env={**os.environ, "RAYON_NUM_THREADS": str(threads)})
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return {"seconds": wall, "processor_seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}


def theirs(layers, psfs):
    start, cpu = time.perf_counter(), time.process_time()
    raw = capture(layers, psfs)
    return raw, {"seconds": time.perf_counter() - start, "processor_seconds": time.process_time() - cpu}


def main():
    result = {"size": [height, width], "threads": threads, "versions": {"scipy": scipy.__version__, "numpy": np.__version__}, "rounds": []}
    result["cpu"] = next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name"))
    with tempfile.TemporaryDirectory() as folder:
        layers = draw(folder)
        subprocess.run([edof, "-q", "optics", CAMERA, "--psi", ",".join(map(str, PSIS)), "--out", folder], check=True, stdout=subprocess.DEVNULL)
        bank = np.load(f"{folder}/psf.npz")
        assert np.allclose(bank["psi"], PSIS)
        psfs = [[trimmed(kernel) for kernel in depth] for depth in bank["psf"]]
        result["kernels"] = [[kernel.shape[0] for kernel in depth] for depth in psfs]
        for _ in range(rounds):
            edof_time = ours(folder)
            raw, scipy_time = theirs(layers, psfs)
            result["rounds"].append({"edof": edof_time, "scipy": scipy_time})
            print(json.dumps(result["rounds"][-1]), file=sys.stderr)
        made = np.asarray(Image.open(f"{folder}/raw.png"), dtype=np.uint16) >> 4
    apart = np.abs(made.astype(int) - raw.astype(int))
    result["codes_apart"] = {"largest": int(apart.max()), "mean": float(apart.mean())}
    for what in ("processor_seconds", "seconds"):
        ratios = sorted(one["scipy"][what] / one["edof"][what] for one in result["rounds"])
        print(f"SciPy takes {ratios[len(ratios) // 2]:.2f} times ({ratios[0]:.2f} to {ratios[-1]:.2f}) the {what.replace('_', ' ')} of edof capture")
    print(f"values of 12 bits apart: {apart.max()} at most, {apart.mean():.4f} in the mean; kernels {result['kernels']}")
    with open(out, "w") as file:
        json.dump(result, file, indent=1)


main()
