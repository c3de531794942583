"""edof-t4w12 in PyTorch on the CPU: the same form, loss and optimiser as edof-train, on windows that edof-train drew.

Usage: train_pytorch.py DATA.safetensors THREADS BATCH. Prints one JSON line like the Rust example does.
"""

import json
import sys
import time

import torch
from safetensors.torch import load_file

CODES, PIXELS, OUTPUTS = 192, 144, 192
SECONDS = 10.0
LAMBDA = 3e-5


def split(flat):
    """The flat weight vector's matrices, in the order of edof_float::parameters."""
    shapes = [(CODES, PIXELS)] + [(CODES,)] * 3 + [(CODES, CODES)] * 2 + [(OUTPUTS, CODES), (OUTPUTS, PIXELS)]
    parts, at = [], 0
    for shape in shapes:
        size = torch.Size(shape).numel()
        parts.append(flat[at : at + size].view(shape).clone().requires_grad_())
        at += size
    return parts


def loss_of(parts, y, x):
    a, t1, t2, t3, s1, s2, d, r = parts
    b1 = y @ a.T
    z1 = torch.relu(b1 - t1)
    z2 = torch.relu(torch.addmm(b1, z1, s1.T) - t2)
    z3 = torch.relu(torch.addmm(b1, z2, s2.T) - t3)
    error = z3 @ d.T + y @ r.T - x
    fit = 0.5 * (error * error).sum(1).mean()
    sparsity = sum((z.abs().sum(0) * m.norm(dim=0)).sum() for z, m in ((z1, s1), (z2, s2), (z3, d))) / len(y)
    return fit + LAMBDA * sparsity


def main():
    path, threads, batch = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    torch.set_num_threads(threads)
    data = load_file(path)
    parts = split(data["weights"])
    inputs, targets = data["inputs"], data["targets"]
    optimiser = torch.optim.Adam(parts, lr=1e-5, fused=True)

    def step(i):
        at = i * batch % (len(inputs) - batch + 1)
        optimiser.zero_grad(set_to_none=True)
        loss = loss_of(parts, inputs[at : at + batch], targets[at : at + batch])
        loss.backward()
        optimiser.step()

    for i in range(50):
        step(i)
    start, steps = time.perf_counter(), 0
    while time.perf_counter() - start < SECONDS:
        step(steps)
        steps += 1
    rate = steps * batch / (time.perf_counter() - start)
    print(json.dumps({"method": f"pytorch {torch.__version__}", "threads": threads, "batch": batch, "patches_per_second": rate}))


main()
