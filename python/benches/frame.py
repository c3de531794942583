"""CPU seconds of a 1080p frame through `edof.reconstruct`: least and median. `scripts/bench-python.sh` runs it in turn with the program's pipeline."""

import sys
import time

import numpy as np

import edof

frames = int(sys.argv[1]) if len(sys.argv) > 1 else 10
network = edof.FixedNetwork.load("edof-t4w12-outer-light")
rows, columns = np.indices((1080, 1920))
raw = ((rows * 2003 + columns * 331) % 4096).astype(np.uint16)
edof.reconstruct(raw, network, bit_depth=12)
seconds = []
for _ in range(frames):
    before = time.process_time()
    edof.reconstruct(raw, network, bit_depth=12)
    seconds.append(time.process_time() - before)
seconds.sort()
print(f"{seconds[0]:.4f} {seconds[frames // 2]:.4f}")
