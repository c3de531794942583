#!/usr/bin/env python3
"""Holds pursuits, k-SVD and demosaicing to other people's programs: scikit-learn, dictlearn, ksvd, colour-demosaicing.

    scripts/test-peers.sh            (builds the two example programs and the environment)
    tests/oracles/peers.py target/release/examples
"""

import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np

warnings.filterwarnings("ignore")
from colour_demosaicing import demosaicing_CFA_Bayer_Malvar2004, demosaicing_CFA_Bayer_Menon2007  # noqa: E402
from dictlearn import DictionaryLearning  # noqa: E402
from ksvd import ApproximateKSVD  # noqa: E402
from sklearn.linear_model import Lasso, orthogonal_mp  # noqa: E402

EXAMPLES = Path(sys.argv[1])
failures = []


def check(what, holds, told):
    print(f"{'ok  ' if holds else 'FAIL'} {what}: {told}")
    if not holds:
        failures.append(what)


def words(values):
    return " ".join(repr(float(v)) for v in np.asarray(values).ravel())


def run(program, text):
    done = subprocess.run([EXAMPLES / program], input=text, capture_output=True, text=True, check=True)
    return np.array(done.stdout.split(), float), done.stderr


def pursue(method, dictionary, signals, limit, penalty=0.0, rounds=0):
    """Codes (or k-SVD's dictionary), and the seconds that they took."""
    (length, atoms), count = dictionary.shape, len(signals)
    head = f"{method} {length} {atoms} {count} {limit} {penalty!r} {rounds}\n"
    numbers, seconds = run("pursue", head + words(dictionary) + "\n" + words(signals) + "\n")
    return numbers.reshape(-1, atoms), float(seconds)


def drawn(seed, length, atoms, count):
    random = np.random.default_rng(seed)
    dictionary = random.standard_normal((length, atoms))
    dictionary /= np.linalg.norm(dictionary, axis=0)
    return dictionary, random.standard_normal((count, length))


def omp():
    for seed, (length, atoms, count, limit) in enumerate([(64, 192, 400, 8), (64, 1515, 200, 8), (30, 40, 200, 15)]):
        dictionary, signals = drawn(seed, length, atoms, count)
        ours, _ = pursue("omp", dictionary, signals, limit)
        theirs = orthogonal_mp(dictionary, signals.T, n_nonzero_coefs=limit, precompute=True).T
        same = np.array_equal(ours != 0, theirs != 0)
        error = np.abs(ours - theirs).max()
        check(f"OMP, {length}x{atoms}", same and error < 1e-6, f"supports {'equal' if same else 'differ'}, codes within {error:.1e}")


def omp_speed():
    dictionary, signals = drawn(9, 64, 1515, 1000)
    _, ours = pursue("omp", dictionary, signals, 8)
    start = time.perf_counter()
    orthogonal_mp(dictionary, signals.T, n_nonzero_coefs=8, precompute=True)
    theirs = time.perf_counter() - start
    print(f"     OMP of 1000 signals on one thread, f64: {ours:.2f} s, scikit-learn {theirs:.2f} s, {theirs / ours:.1f} times as fast")


def lasso():
    for seed, (length, atoms, mu) in enumerate([(40, 24, 0.5), (32, 96, 0.3)]):
        dictionary, signals = drawn(20 + seed, length, atoms, 12)
        for method in ["fista", "ista"]:
            ours, _ = pursue(method, dictionary, signals, 20_000, mu)
            model = Lasso(alpha=mu / length, fit_intercept=False, tol=1e-12, max_iter=1_000_000)
            theirs = np.array([model.fit(dictionary, x).coef_ for x in signals])
            error = np.abs(ours - theirs).max()
            check(f"{method.upper()}, {length}x{atoms}, against Lasso", error < 1e-5, f"codes within {error:.1e}")


def k_svd():
    """Patches of drawn pictures of edges, the same start and rounds; the error that OMP leaves in the end."""
    random = np.random.default_rng(5)
    picture = np.cumsum(random.standard_normal((200, 200)) * (random.random((200, 200)) < 0.02), axis=0)
    picture += np.cumsum(random.standard_normal((200, 200)) * (random.random((200, 200)) < 0.02), axis=1)
    corners = random.integers(0, 193, (3000, 2))
    patches = np.array([picture[r : r + 8, c : c + 8].ravel() for r, c in corners])
    patches -= patches.mean(axis=1, keepdims=True)
    start = patches[np.argsort(-np.linalg.norm(patches, axis=1))[:96]].T

    def error(dictionary):
        dictionary = dictionary / np.maximum(np.linalg.norm(dictionary, axis=0), 1e-12)
        codes = orthogonal_mp(dictionary, patches.T, n_nonzero_coefs=5, precompute=True)
        return np.sqrt(np.mean((patches.T - dictionary @ codes) ** 2))

    ours, _ = pursue("ksvd", start, patches, 5, rounds=15)
    model = ApproximateKSVD(n_components=96, max_iter=15, tol=0, transform_n_nonzero_coefs=5)
    model._initialize = lambda X: start.T / np.linalg.norm(start.T, axis=1)[:, np.newaxis]
    peers = {"ksvd": model.fit(patches).components_.T}
    first = start.T / np.linalg.norm(start.T, axis=1)[:, np.newaxis]
    for algorithm in ["ksvd", "aksvd"]:
        model = DictionaryLearning(
            96, fit_algorithm=algorithm, n_nonzero_coefs=5, max_iter=15, dict_init=first, random_state=0
        )
        peers[f"dictlearn's {algorithm}"] = model.fit(patches).components_.T
    ours = error(ours)
    for name, theirs in peers.items():
        theirs = error(theirs)
        check(f"k-SVD, 96 atoms, 5 a patch, against {name}", ours <= 1.02 * theirs, f"leaves {ours:.4f}, {name} {theirs:.4f}")


def demosaicing():
    random = np.random.default_rng(3)
    for phase in ["rggb", "grbg", "gbrg", "bggr"]:
        smooth = np.cumsum(np.cumsum(random.standard_normal((48, 60)), 0), 1)
        smooth = (smooth - smooth.min()) / np.ptp(smooth)
        values = np.round(60_000 * np.clip(smooth + 0.05 * random.standard_normal((48, 60)), 0, 1)).astype(int)
        inside = (slice(8, -8), slice(8, -8))
        for name, theirs, most in [
            ("malvar", demosaicing_CFA_Bayer_Malvar2004, 0.0),
            ("directional", demosaicing_CFA_Bayer_Menon2007, 0.002),
        ]:
            ours, _ = run("demosaic", f"{name} {phase} 48 60\n" + " ".join(map(str, values.ravel())) + "\n")
            other = np.moveaxis(theirs(values / 65536, phase.upper()), -1, 0)
            differ = np.abs(ours.reshape(3, 48, 60) - other)[(slice(None), *inside)] > 1e-6
            # Where both directions vary alike, the last bit decides.
            check(f"demosaicing, {name}, {phase}", differ.mean() <= most, f"{differ.mean():.2%} of values differ by more than 1e-6")


started = time.perf_counter()
for test in [omp, lasso, k_svd, demosaicing, omp_speed]:
    test()
print(f"{len(failures)} failed, {time.perf_counter() - started:.0f} seconds")
sys.exit(bool(failures))
