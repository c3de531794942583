"""What `edof stream` does, by the float network in ONNX Runtime: frames packed as 12p in, y4m of 4:2:2 out.

Usage: stream_onnx.py WEIGHTS.safetensors WIDTH HEIGHT THREADS FIGURES.json <frames >pictures

The network is of those that compute encoded values (`"values": "srgb"`). Everything around it is NumPy on whole frames; FIGURES has the time of the
network alone beside that of all, from the first frame to the last.
"""

import json
import sys
import time

import numpy as np
from onnx_network import STRIDE, graph
from safetensors import safe_open

# BT.709 in 8 bits of studio range.
LUMA = np.array([0.2126, 0.7152, 0.0722], np.float32)


def encoded(light):
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def unpacked(frame, table, height, width):
    """The encoded values of a frame: two pixels in three bytes, the first pixel's low bits first."""
    low, both, high = frame.reshape(-1, 3).astype(np.uint16).T
    pixels = np.empty(height * width, np.uint16)
    pixels[::2] = low | (both & 15) << 8
    pixels[1::2] = both >> 4 | high << 4
    return table[pixels].reshape(height, width)


def planes(picture):
    """Luma and both differences of an encoded picture, these at every second column between its neighbours."""
    red, green, blue = np.clip(picture, 0, 1, out=picture)
    luma = LUMA[0] * red + LUMA[1] * green + LUMA[2] * blue
    differences = [(blue - luma) / 1.8556, (red - luma) / 1.5748]
    halved = [0.5 * (one[:, ::2] + one[:, 1::2]) for one in differences]
    return [(16.5 + 219 * luma).astype(np.uint8)] + [(128.5 + 224 * one).astype(np.uint8) for one in halved]


def main():
    path, width, height, threads, out = sys.argv[1], *map(int, sys.argv[2:5]), sys.argv[5]
    with safe_open(path, "numpy") as file:
        if json.loads(file.metadata()["edof"])["origin"].get("values") != "srgb":
            sys.exit(f"{path}: the network does not compute encoded values")
        weights = {name: file.get_tensor(name) for name in file.keys()}
    margin = (int(weights["analysis"].shape[1] ** 0.5) - STRIDE) // 2
    network = graph(weights, height, width, True, threads)
    table = encoded(np.arange(4096) / 4095).astype(np.float32)
    source, target = sys.stdin.buffer, sys.stdout.buffer
    target.write(f"YUV4MPEG2 W{width} H{height} F30:1 Ip A1:1 C422\n".encode())
    frames = computing = 0
    begin = None
    while frame := source.read(height * width * 3 // 2):
        begin = begin or time.perf_counter()
        raw = unpacked(np.frombuffer(frame, np.uint8), table, height, width)
        at = time.perf_counter()
        picture = network.run(None, {"y": np.pad(raw, margin, mode="reflect")[None, None]})[0][0]
        computing += time.perf_counter() - at
        target.write(b"FRAME\n")
        for plane in planes(picture):
            target.write(plane.tobytes())
        frames += 1
    target.flush()
    seconds = time.perf_counter() - begin
    with open(out, "w") as file:
        json.dump({"frames": frames, "per_second": frames / seconds, "network_per_second": frames / computing}, file)


main()
