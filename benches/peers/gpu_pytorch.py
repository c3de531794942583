"""1080p frames a second of the networks by OpenCL beside the float network in PyTorch on the same GPU, raw frame and picture in the processor's memory, in turn.

Usage: gpu_pytorch.py THROUGHPUT WEIGHTS-STEM RAW.png ROUNDS OUT.json

THROUGHPUT is `cargo build --release -p edof-gpu --example throughput`; RAW.png what golden_float.sh makes. PyTorch's products are of single precision, as
ours are; its faster ones of 10-bit fractions (TF32) stand beside them. "resident" leaves the frame and the picture on the GPU.
"""

import json
import subprocess
import sys
import tempfile
import time

import numpy as np
import torch
from PIL import Image
from safetensors.numpy import load_file

FRAMES = 50
STRIDE = 8


class Network:
    """The network by matrix products on rows of windows, all on the GPU."""

    def __init__(self, weights, height, width):
        self.side = int(weights["analysis"].shape[1] ** 0.5)
        self.size, self.middle = (height, width), sum(name.startswith("recurrent") for name in weights)
        self.w = {k: torch.from_numpy(np.ascontiguousarray(v.T, dtype=np.float32)).cuda() for k, v in weights.items()}

    def codes(self, b, t):
        return torch.relu_(b - self.w[f"threshold.{t}"])

    def __call__(self, raw):
        """Picture (3, height, width) of sensor words on the GPU."""
        margin = (self.side - STRIDE) // 2
        light = torch.nn.functional.pad(raw[None, None].float() / 65536, [margin] * 4, mode="reflect")[0, 0]
        y = light.unfold(0, self.side, STRIDE).unfold(1, self.side, STRIDE).reshape(-1, self.side**2)
        b = first = y @ self.w["analysis"]
        for t in range(self.middle):
            b = torch.addmm(first, self.codes(b, t), self.w[f"recurrent.{t}"])
        out = torch.addmm(y @ self.w["linear_path"], self.codes(b, self.middle), self.w["dictionary"])
        height, width = self.size
        blocks = out.reshape(height // STRIDE, width // STRIDE, 3, STRIDE, STRIDE)
        return blocks.permute(2, 0, 3, 1, 4).reshape(3, height, width)


def rate(run):
    run()
    torch.cuda.synchronize()
    start = time.perf_counter()
    for _ in range(FRAMES):
        run()
    torch.cuda.synchronize()
    return FRAMES / (time.perf_counter() - start)


def main():
    program, stem, raw_path, rounds, out = sys.argv[1:]
    raw = np.asarray(Image.open(raw_path), dtype=np.uint16)
    words = torch.from_numpy(raw.astype(np.int16))
    height, width = raw.shape
    network = Network(load_file(stem + ".safetensors"), height, width)

    def there(words):
        return network(words.cuda().int() & 0xFFFF)

    resident = words.cuda()
    result = {"network": stem, "size": [height, width], "gpu": torch.cuda.get_device_name(), "torch": torch.__version__, "rounds": []}
    with tempfile.NamedTemporaryFile() as frame, tempfile.NamedTemporaryFile() as file, torch.inference_mode():
        raw.tofile(frame.name)
        args = [program, stem, frame.name, str(width), str(FRAMES), file.name]
        for _ in range(int(rounds)):
            one = json.loads(subprocess.run(args, check=True, capture_output=True, text=True).stdout)
            for name, tf32 in (("float32", False), ("TF32", True)):
                torch.backends.cuda.matmul.allow_tf32 = tf32
                one[f"PyTorch, {name}"] = rate(lambda: there(words).cpu())
                one[f"PyTorch, {name}, resident"] = rate(lambda: there(resident))
            result["rounds"].append(one)
            print(json.dumps(one), file=sys.stderr)
        torch.backends.cuda.matmul.allow_tf32 = False
        ours = np.fromfile(file.name, dtype="<f4").reshape(3, height, width)
        result["largest_difference"] = float(np.abs(ours - there(words).cpu().numpy()).max())
    for name in [n for n in result["rounds"][0] if n.startswith("PyTorch")]:
        for ours in ("float_frames_per_second", "fixed_frames_per_second"):
            ratios = sorted(one[ours] / one[name] for one in result["rounds"])
            print(f"{ours.split('_')[0]} against {name}: {ratios[len(ratios) // 2]:.2f} times ({ratios[0]:.2f} to {ratios[-1]:.2f}) as many frames a second")
    print("largest difference of the pictures:", result["largest_difference"])
    with open(out, "w") as file:
        json.dump(result, file, indent=1)


main()
