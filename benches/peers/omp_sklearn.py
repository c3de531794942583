"""OMP of 5000 signals in a dictionary of 64x1515, sparsity 8, in double precision: edof_numerics::sparse against scikit-learn, in turn.

Usage: omp_sklearn.py PURSUE THREADS ROUNDS OUT.json (PURSUE: the example of edof_numerics::sparse). Both tell the time of the pursuit alone.
"""

import json
import os
import subprocess
import sys
import time

threads = sys.argv[2]
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[name] = threads

import numpy as np
import sklearn
from sklearn.linear_model import orthogonal_mp

LENGTH, ATOMS, COUNT, LIMIT = 64, 1515, 5000, 8


def words(values):
    return " ".join(repr(float(v)) for v in np.asarray(values).ravel())


def main():
    pursue, _, rounds, out = sys.argv[1:]
    random = np.random.default_rng(9)
    dictionary = random.standard_normal((LENGTH, ATOMS))
    dictionary /= np.linalg.norm(dictionary, axis=0)
    signals = random.standard_normal((COUNT, LENGTH))
    text = f"omp {LENGTH} {ATOMS} {COUNT} {LIMIT} 0.0 0\n{words(dictionary)}\n{words(signals)}\n"
    cpu = next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name"))
    result = {"cpu": cpu, "threads": int(threads), "versions": {"scikit-learn": sklearn.__version__, "numpy": np.__version__}, "rounds": []}
    for _ in range(int(rounds)):
        done = subprocess.run([pursue], input=text, capture_output=True, text=True, check=True)
        start = time.perf_counter()
        codes = orthogonal_mp(dictionary, signals.T, n_nonzero_coefs=LIMIT, precompute=True).T
        result["rounds"].append({"edof": float(done.stderr), "scikit-learn": time.perf_counter() - start})
        ours = np.array(done.stdout.split(), float).reshape(COUNT, ATOMS)
    result["largest_difference"] = float(np.abs(ours - codes).max())
    ratios = sorted(one["scikit-learn"] / one["edof"] for one in result["rounds"])
    print(f"OMP on {threads} threads: scikit-learn takes {ratios[len(ratios) // 2]:.1f} times ({ratios[0]:.1f} to {ratios[-1]:.1f}) as long; "
          f"codes within {result['largest_difference']:.1e}")
    with open(out, "w") as file:
        json.dump(result, file, indent=1)


main()
