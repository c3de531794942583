"""Routers between sets of weights, fitted to and judged by what `depth_aware frames` and `errors` wrote.

depth_aware.py fit FRAMES OUT NET,NET[,NET] [side=12] [patches=1]   a router that chooses the network with the smaller squared error
depth_aware.py table FRAMES BASE LINE...                             PSNR of each line and its gain over BASE; a line is NET, best:NET,NET (an oracle), depth:NET,NET@4,5/6,8
                                                                     (by the depth), or ROUTER.json:NET,NET
"""
import json
import sys
from pathlib import Path

import numpy as np
import scipy.optimize

PATCH = 8
OUTPUTS = 192
# Patches that a router is fitted to at most.
MOST_ROWS = 150_000


class Frames:
    """Index, features and patch grid of a folder of frames."""

    def __init__(self, folder):
        self.folder = Path(folder)
        index = json.loads((self.folder / "index.json").read_text())
        self.names, self.shots = index["names"], index["shots"]
        n = index["features"]
        words = np.fromfile(self.folder / "features.f32", np.float32)
        at, self.first = 0, [0]
        self.features = {12: [], 16: []}
        for shot in self.shots:
            shot["grid"] = (shot["height"] // PATCH, shot["width"] // PATCH)
            patches = shot["grid"][0] * shot["grid"][1]
            for side in (12, 16):
                self.features[side].append(words[at : at + patches * n].reshape(patches, n))
                at += patches * n
            self.first.append(self.first[-1] + patches)
        assert at == len(words)

    def errors(self, network):
        """Patches × (squared error, non-zeros), one array a frame."""
        rows = np.fromfile(Path(network).with_suffix(".errors"), np.float32).reshape(-1, 4)
        assert len(rows) == self.first[-1], network
        return [rows[a:b] for a, b in zip(self.first, self.first[1:])]

    def summed(self, i, side, patches):
        """Features of frame i, those of the patches around added."""
        f = self.features[side][i]
        if patches == 1:
            return f
        rows, columns = self.shots[i]["grid"]
        reach = patches // 2
        grid = np.pad(f.reshape(rows, columns, -1).astype(np.float64), ((reach, reach), (reach, reach), (0, 0)), mode="edge")
        for axis in (0, 1):
            total = np.cumsum(grid, axis)
            total = np.concatenate([np.zeros_like(total.take([0], axis)), total], axis)
            length = grid.shape[axis] - patches + 1
            grid = total.take(range(patches, patches + length), axis) - total.take(range(length), axis)
        return grid.reshape(rows * columns, -1).astype(np.float32)

    def inner(self, i):
        """Whether each patch is none of the border's."""
        rows, columns = self.shots[i]["grid"]
        inside = np.zeros((rows, columns), bool)
        inside[1:-1, 1:-1] = True
        return inside.ravel()


def basis(f, noise):
    """What scores are linear in."""
    s = np.full((len(f), 1), noise, np.float32)
    return np.hstack([f, s * f, np.ones_like(s), s, s * s])


def choose(router, frames, i):
    """The class of each patch of frame i."""
    f = frames.summed(i, router["side"], router["patches"])
    scores = basis(f, frames.shots[i]["noise"]) @ np.array(router["scores"], np.float32).T
    return scores.argmax(1)


def softmax(s):
    p = np.exp(s - s.max(1, keepdims=True))
    return p / p.sum(1, keepdims=True)


def descend(z, k, start, loss, steps):
    """Weights with the least of a loss of scores, which gives its value and its gradient for the scores."""

    def of(flat):
        value, g = loss(z @ flat.reshape(-1, k).astype(np.float32))
        return float(value), (z.T @ g.astype(np.float32)).ravel().astype(np.float64) + 1e-6 * flat

    return scipy.optimize.minimize(of, start.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": steps}).x.reshape(-1, k)


def minimise(z, cost):
    """Linear scores of classes: a logistic regression in which each row weighs what a wrong choice costs, then the least expected cost itself."""
    k, n = cost.shape[1], len(z)
    weights = cost.max(1, keepdims=True) - cost
    total = weights.sum(1, keepdims=True)
    unit = total.mean()

    def logistic(s):
        p = softmax(s)
        return -(weights * np.log(p + 1e-9)).sum() / n / unit, (total * p - weights) / n / unit

    def expected(s):
        p = softmax(s)
        mean = (p * cost).sum(1, keepdims=True)
        return mean.mean() / unit, p * (cost - mean) / n / unit

    w = descend(z, k, np.zeros((z.shape[1], k)), logistic, 150)
    # Sharper, so that the expected cost is nearly that of the choice.
    return descend(z, k, 2.0 * w, expected, 150)


def samples(frames, networks, side, patches, electrons=0):
    """Features, normalised costs of the networks, and noise, of the patches of all frames of one kind."""
    errors = [frames.errors(n) for n in networks]
    xs, costs = [], []
    for i, shot in enumerate(frames.shots):
        if shot["judged"] or electrons not in (0, shot["electrons"]):
            continue
        inside = frames.inner(i)
        e = np.stack([errors[k][i][:, 0] for k in range(len(networks))], 1)[inside]
        # Each frame counts alike, as in a mean of PSNR.
        costs.append(e / e.min(1).mean())
        xs.append(basis(frames.summed(i, side, patches), shot["noise"])[inside])
    return np.vstack(xs), np.vstack(costs)


def fit(frames, networks, side=12, patches=1, keep=None, seed=0, balance=0, electrons=0):
    """A router; `keep` are the features that it may use."""
    x, cost = samples(frames, networks, side, patches, electrons)
    n = len(frames.names)
    used = np.ones(x.shape[1], bool)
    if keep is not None:
        used[: 2 * n] = False
        for name in keep:
            used[[frames.names.index(name), n + frames.names.index(name)]] = True
    middle, spread = x.mean(0), x.std(0) + 1e-9
    middle[2 * n] = 0
    spread[2 * n] = 1
    # Where all frames have one noise, its columns say nothing.
    used[x.std(0) < 1e-4 * np.abs(middle)] = False
    if electrons:
        used[n : 2 * n] = used[2 * n + 1 :] = False
    used[2 * n] = True
    spread[~used] = np.inf
    some = np.random.default_rng(seed).permutation(len(x))[:MOST_ROWS]
    z = ((x - middle) / spread).astype(np.float32)
    w = minimise(z[some], cost[some])
    base, picked = cost.min(1).mean(), (z @ w).argmax(1)
    mean = cost[np.arange(len(cost)), picked].mean()
    w = w / spread[:, None]
    w[2 * n] -= middle @ w
    if balance:
        level(x, w, n)
    blind = cost.mean(0).min()
    told = {
        "cost_single": float(blind), "cost_oracle": float(base), "cost_router": float(mean),
        "kept": float((blind - mean) / (blind - base)),
    }
    print(json.dumps(told), file=sys.stderr)
    return {"side": side, "patches": patches, "scores": w.T.tolist()}


def level(x, w, n):
    """Moves the constants of two classes so that each gets half of the patches at every noise: a first choice that is none by noise alone."""
    noises = np.unique(x[:, 2 * n + 1])
    gaps = []
    for noise in noises:
        s = x[x[:, 2 * n + 1] == noise] @ w
        gaps.append(np.median(s[:, 0] - s[:, 1]))
    terms = len(noises)
    w[2 * n : 2 * n + terms, 1] += np.linalg.solve(np.vander(noises, terms, increasing=True), gaps)


def db(frames, i, errors):
    inside = frames.inner(i)
    return -10 * np.log10(errors[inside].mean() / OUTPUTS)


def measure(frames, line):
    """PSNR of each judged frame, share of classes, share of non-best choices, mean non-zeros."""
    kind, _, rest = line.rpartition(":")
    rest, _, depths = rest.partition("@")
    networks = rest.split(",")
    errors = [frames.errors(n) for n in networks]
    router = json.loads(Path(kind).read_text()) if kind.endswith(".json") else None
    out = {}
    for i, shot in enumerate(frames.shots):
        if not shot["judged"]:
            continue
        e = np.stack([errors[k][i][:, 0] for k in range(len(networks))], 1)
        if router:
            picked = choose(router, frames, i)
        elif kind == "best":
            picked = e.argmin(1)
        elif kind == "depth":
            at = [str(int(shot["psi"])) in group.split(",") for group in depths.split("/")].index(True)
            picked = np.full(len(e), at)
        else:
            picked = np.zeros(len(e), int)
        take = np.arange(len(e))
        nz = np.stack([errors[k][i][:, 1:] for k in range(len(networks))], 1)[take, picked]
        inside = frames.inner(i)
        key = (shot["photo"], shot["psi"], shot["electrons"])
        out[key] = {
            "db": db(frames, i, e[take, picked]),
            "shares": np.bincount(picked[inside], minlength=len(networks)) / inside.sum(),
            "wrong": (picked != e.argmin(1))[inside].mean(),
            "nz": nz[inside].mean(0),
        }
    return out


def averages(rows, electrons, psis_weights):
    photos = sorted({k[0] for k in rows})
    w = sum(psis_weights.values())
    return np.array([sum(rows[p, psi, electrons]["db"] * x for psi, x in psis_weights.items()) / w for p in photos])


PAGE = {4.0: 1, 8.0: 2}
ALL = {4.0: 1, 6.0: 2, 8.0: 2}


def table(frames, base, lines):
    reference = measure(frames, base)
    print("| line | e- | psi 4 / 6 / 8 | avg 0,4,8 | avg 0,2,4,6,8 | gain avg5 | gain avg(0,4,8) | gain worst | classes | wrong % | nz |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for line in [base, *lines]:
        rows = measure(frames, line)
        for electrons in (10000.0, 1000.0):
            keys = [k for k in rows if k[2] == electrons]
            by_psi = [np.mean([rows[k]["db"] for k in keys if k[1] == psi]) for psi in (4.0, 6.0, 8.0)]
            cells = []
            for weights in (ALL, PAGE, {8.0: 1}):
                d = averages(rows, electrons, weights) - averages(reference, electrons, weights)
                cells.append(f"{d.mean():+.2f}±{d.std(ddof=1) / len(d) ** 0.5:.2f}")
            shares = np.mean([rows[k]["shares"] for k in keys], 0)
            # The worst depth is the one with the least mean over photographs, of each line its own.
            worst = min(by_psi) - min(np.mean([reference[k]["db"] for k in keys if k[1] == psi]) for psi in (4.0, 6.0, 8.0))
            print(
                f"| {line.replace('target/depth/', '')} | {electrons:.0f} | {' / '.join(f'{v:.2f}' for v in by_psi)} "
                f"| {averages(rows, electrons, PAGE).mean():.2f} | {averages(rows, electrons, ALL).mean():.2f} | {cells[0]} | {cells[1]} "
                f"| {worst:+.2f} ({cells[2]}) | {' '.join(f'{s:.2f}' for s in shares)} | {100 * np.mean([rows[k]['wrong'] for k in keys]):.0f} "
                f"| {' '.join(f'{v:.0f}' for v in np.mean([rows[k]['nz'] for k in keys], 0))} |"
            )


def main():
    command, folder, *rest = sys.argv[1:]
    frames = Frames(folder)
    if command == "fit":
        out, networks, *options = rest
        options = dict(o.split("=") for o in options)
        keep = options.pop("keep", None)
        router = fit(frames, networks.split(","), **{k: int(v) for k, v in options.items()}, keep=keep and keep.split(","))
        Path(out).write_text(json.dumps(router))
    else:
        table(frames, *rest[:1], rest[1:])


if __name__ == "__main__":
    main()
