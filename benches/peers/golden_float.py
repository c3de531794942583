"""The float network in ONNX Runtime, PyTorch and NumPy, raw frame in and picture out, beside the golden pipeline: same frame, same threads, in turn.

Usage: golden_float.py THROUGHPUT WEIGHTS-STEM RAW.png SHARP.png THREADS ROUNDS OUT.json

WEIGHTS-STEM.safetensors is the float network, WEIGHTS-STEM.fixed.safetensors what the golden pipeline runs; stride 8. Every method runs
FRAMES frames a round; ratios are taken round by round. Processor time is what a busy machine does not add to.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

threads = int(sys.argv[5])
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = str(threads)

import numpy as np
import onnxruntime
import torch
from onnx_network import STRIDE, graph
from PIL import Image
from safetensors.numpy import load_file

FRAMES = 5


def padded(raw, side):
    margin = (side - STRIDE) // 2
    return np.pad(raw.astype(np.float32) / 65536, margin, mode="reflect")


def windows(raw, side):
    view = np.lib.stride_tricks.sliding_window_view(padded(raw, side), (side, side))[::STRIDE, ::STRIDE]
    return view.reshape(-1, side * side)


def assembled(patches, height, width):
    blocks = patches.reshape(height // STRIDE, width // STRIDE, 3, STRIDE, STRIDE)
    return np.ascontiguousarray(blocks.transpose(2, 0, 3, 1, 4)).reshape(3, height, width)


def in_numpy(weights, y):
    b = first = y @ weights["analysis"].T
    middle = sum(name.startswith("recurrent") for name in weights)
    for t in range(middle):
        b = first + np.maximum(b - weights[f"threshold.{t}"], 0) @ weights[f"recurrent.{t}"].T
    z = np.maximum(b - weights[f"threshold.{middle}"], 0)
    return z @ weights["dictionary"].T + y @ weights["linear_path"].T


class InTorch(torch.nn.Module):
    """The network in PyTorch: by convolutions on a padded raw frame, or by matrix products on rows of windows."""

    def __init__(self, weights, height, width, convolve):
        super().__init__()
        self.middle = sum(name.startswith("recurrent") for name in weights)
        self.size, self.convolve = (height, width), convolve
        self.side = int(weights["analysis"].shape[1] ** 0.5)
        for name, value in weights.items():
            value = torch.from_numpy(np.ascontiguousarray(value, dtype=np.float32))
            if convolve and value.ndim == 2:
                side = self.side if name in ("analysis", "linear_path") else 1
                value = value.reshape(len(value), -1, side, side).contiguous(memory_format=torch.channels_last)
            elif convolve:
                value = value.reshape(1, -1, 1, 1)
            elif value.ndim == 2:
                value = value.T.contiguous()
            self.register_buffer(name.replace(".", "_"), value)

    def product(self, of, name):
        w = getattr(self, name)
        if not self.convolve:
            return of @ w
        return torch.nn.functional.conv2d(of, w, stride=STRIDE if w.shape[-1] > 1 else 1)

    def plus(self, base, of, name):
        return base + self.product(of, name) if self.convolve else torch.addmm(base, of, getattr(self, name))

    def codes(self, b, t):
        return torch.relu_(b - getattr(self, f"threshold_{t}"))

    def forward(self, y):
        height, width = self.size
        if not self.convolve:
            y = y.unfold(0, self.side, STRIDE).unfold(1, self.side, STRIDE).reshape(-1, self.side**2)
        else:
            y = y[None, None]
        b = first = self.product(y, "analysis")
        for t in range(self.middle):
            b = self.plus(first, self.codes(b, t), f"recurrent_{t}")
        out = self.plus(self.product(y, "linear_path"), self.codes(b, self.middle), "dictionary")
        if self.convolve:
            return torch.nn.functional.pixel_shuffle(out, STRIDE)[0].contiguous()
        blocks = out.reshape(height // STRIDE, width // STRIDE, 3, STRIDE, STRIDE)
        return blocks.permute(2, 0, 3, 1, 4).reshape(3, height, width)


def in_torch(module, raw, side):
    with torch.inference_mode():
        return module(torch.from_numpy(padded(raw, side))).numpy()


def psnr(picture, sharp):
    return float(-10 * np.log10(np.mean((np.clip(picture, 0, 1) - sharp) ** 2)))


def timed(run):
    start, cpu = time.perf_counter(), time.process_time()
    for _ in range(FRAMES):
        run()
    return {
        "frames_per_second": FRAMES / (time.perf_counter() - start),
        "processor_seconds_per_frame": (time.process_time() - cpu) / FRAMES,
    }


def main():
    program, stem, raw_path, sharp_path, _, rounds, out = sys.argv[1:]
    weights = load_file(stem + ".safetensors")
    side = int(weights["analysis"].shape[1] ** 0.5)
    raw = np.asarray(Image.open(raw_path), dtype=np.uint16)
    height, width = raw.shape
    code = np.asarray(Image.open(sharp_path).convert("RGB")).transpose(2, 0, 1) / 255.0
    sharp = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    by_convolution, by_product = (graph(weights, height, width, convolve, threads) for convolve in (True, False))
    torch.set_num_threads(threads)
    torch_convolution, torch_product = (InTorch(weights, height, width, convolve).eval() for convolve in (True, False))
    torch_compiled = torch.compile(torch_product)
    methods = {
        "ONNX Runtime, convolutions": lambda: by_convolution.run(None, {"y": padded(raw, side)[None, None]})[0][0],
        "ONNX Runtime, matrix products": lambda: assembled(by_product.run(None, {"y": windows(raw, side)})[0], height, width),
        "PyTorch, convolutions": lambda: in_torch(torch_convolution, raw, side),
        "PyTorch, matrix products": lambda: in_torch(torch_product, raw, side),
        "PyTorch, compiled": lambda: in_torch(torch_compiled, raw, side),
        "NumPy": lambda: assembled(in_numpy(weights, windows(raw, side)), height, width),
    }
    result = {
        "network": os.path.basename(stem),
        "size": [height, width],
        "threads": threads,
        "cpu": next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")),
        "versions": {"onnxruntime": onnxruntime.__version__, "torch": torch.__version__, "numpy": np.__version__},
        "psnr_db": {name: psnr(run(), sharp) for name, run in methods.items()},
        "rounds": [],
    }
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(int(rounds)):
            picture = os.path.join(folder, "picture.f32")
            args = [program, stem + ".fixed.safetensors", raw_path, str(threads), str(4 * FRAMES), picture]
            one = {"golden": json.loads(subprocess.run(args, check=True, capture_output=True, text=True).stdout)}
            one |= {name: timed(run) for name, run in methods.items()}
            result["rounds"].append(one)
            print(json.dumps(one), file=sys.stderr)
        golden = np.fromfile(picture, dtype="<f4").reshape(3, height, width)
        result["psnr_db"]["golden"] = psnr(golden, sharp)
    cpu, rate = "processor_seconds_per_frame", "frames_per_second"
    for name in methods:
        by_cpu = sorted(one[name][cpu] / one["golden"][cpu] for one in result["rounds"])
        by_wall = sorted(one["golden"][rate] / one[name][rate] for one in result["rounds"])
        print(f"golden against {name}: {by_cpu[len(by_cpu) // 2]:.2f} times ({by_cpu[0]:.2f} to {by_cpu[-1]:.2f}) as many frames a second of "
              f"processor time, {by_wall[len(by_wall) // 2]:.2f} times ({by_wall[0]:.2f} to {by_wall[-1]:.2f}) by the clock")
    print("PSNR in linear light, dB:", {name: round(db, 2) for name, db in result["psnr_db"].items()})
    with open(out, "w") as file:
        json.dump(result, file, indent=1)


main()
