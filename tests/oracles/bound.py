#!/usr/bin/env python3
"""Runs the real `edof optics bound` and compares every number with NumPy, written from the definition in docs/results/bound.md.

    tests/oracles/bound.py target/debug/edof

The lens: scalar diffraction, 16 mm at F/3.48, 3 um pixels, 610/535/460 nm, psi at 460 nm. The optical transfer function is the pupil's
correlation with itself, times the pixel's footprint, aliases folded. The estimate: Wiener's, on a torus of 32 pixels.
"""

import itertools
import json
import subprocess
import sys
import tempfile

import numpy as np

M, L, REFERENCE, PITCH, F_NUMBER = 32, 64, 460.0, 3.0, 16.0 / 4.6
WAVELENGTHS = (610.0, 535.0, 460.0)
RING = (0.8765, 1.0, -3.78)
PLACES = ((0, 0), (0, 1), (1, 0), (1, 1))
COLOURS = (0, 1, 1, 2)


def cutoff(nm, stops):
    """Cycles per pixel."""
    return PITCH / (nm * 1e-3 * F_NUMBER) * 2 ** (-stops / 2)


def transfer(nm, psi, stops, ring):
    """Transfer of lens and pixel, M x M; psi from focus, of the open aperture."""
    radius = L * cutoff(nm, stops) / 2
    n = int(np.ceil(radius)) + 1
    x = np.arange(-n, n + 1) / radius
    rho = np.hypot(x[:, None], x[None, :])
    inside = lambda edge: np.clip((edge - rho) * radius + 0.5, 0, 1)
    scale = REFERENCE / nm
    mask = inside(1.0).astype(complex)
    if ring:
        low, high, phase = RING
        mask += (inside(high) - inside(low)) * (np.exp(1j * phase * scale) - 1)
    pupil = mask * np.exp(1j * psi * 2.0**-stops * scale * rho**2)
    period = 4 * L
    otf = np.fft.ifft2(np.abs(np.fft.fft2(pupil, (period, period))) ** 2)
    otf /= otf[0, 0].real
    q = np.fft.fftfreq(period) * period
    otf = otf * np.sinc(q / L)[:, None] * np.sinc(q / L)[None, :]
    out = np.zeros((M, M), complex)
    keep = np.flatnonzero(q.astype(int) % (L // M) == 0)
    index = (q[keep].astype(int) // (L // M)) % M
    np.add.at(out, (index[:, None], index[None, :]), otf[np.ix_(keep, keep)])
    return out


def natural():
    """Spectra of red, green and blue and their products, M x M x 3 x 3."""
    fine = 128
    f = np.abs(np.fft.fftfreq(fine))
    out = np.zeros((M, M, 3, 3))
    terms = ((0.126, 2.4, (1, 1, 1)), (0.0125, 2.8, (1, 0, -1)), (0.004, 2.8, (1, -2, 1)))
    for variance, exponent, axis in terms:
        s = (1 / 256 + (f[:, None] ** 0.7 + f[None, :] ** 0.7) ** (1 / 0.7)) ** -exponent
        s /= s.mean()
        step = fine // M
        weight = np.array([0.5, 1, 1, 1, 0.5]) / step
        smooth = sum(w * np.roll(s, -d, 0) for w, d in zip(weight, range(-2, 3)))
        smooth = sum(w * np.roll(smooth, -d, 1) for w, d in zip(weight, range(-2, 3)))
        axis = np.array(axis, float)
        out += variance / (axis @ axis) * smooth[::step, ::step, None, None] * np.outer(axis, axis)
    return out


S = natural()
VARIANCE = np.trace(S.mean((0, 1))) / 3


def aliases(a):
    """[..., M, M] to [..., base frequency, alias]."""
    half = M // 2
    parts = [a[..., i * half : (i + 1) * half, j * half : (j + 1) * half] for i, j in PLACES]
    return np.stack(parts, -1).reshape(*a.shape[:-2], half * half, 4)


SPECTRA = aliases(np.moveaxis(S, (2, 3), (0, 1)))
SIGNS = np.array([[0.5 * (-1.0) ** (p[0] * k[0] + p[1] * k[1]) for k in PLACES] for p in PLACES])


def mosaic(h):
    """A [frequency, place, (colour, alias)] and C_xx of the unknown numbers."""
    h = aliases(h)
    a = np.zeros((h.shape[1], 4, 3, 4), complex)
    for p, c in enumerate(COLOURS):
        a[:, p, c] = SIGNS[p] * h[c]
    return a.reshape(-1, 4, 12)


C_XX = np.zeros((M * M // 4, 3, 4, 3, 4))
for _c, _d, _k in itertools.product(range(3), range(3), range(4)):
    C_XX[:, _c, _k, _d, _k] = SPECTRA[_c, _d, :, _k]
C_XX = C_XX.reshape(-1, 12, 12)


def wiener(mean_xy, mean_yy):
    return np.linalg.solve(mean_yy.transpose(0, 2, 1), mean_xy.transpose(0, 2, 1)).transpose(0, 2, 1)


def bayer(hs, noise):
    """dB at each depth: blind, known."""
    a = [mosaic(h) for h in hs]
    xy = [C_XX @ m.conj().transpose(0, 2, 1) for m in a]
    yy = [m @ c + noise * np.eye(4) for m, c in zip(a, xy)]
    blind = wiener(np.mean(xy, 0), np.mean(yy, 0))
    error = lambda w, x, y: VARIANCE - (2 * (w * x.conj()).sum() - ((w @ y) * w.conj()).sum()).real / (3 * M * M)
    maps = [[blind] * len(a), [wiener(x, y) for x, y in zip(xy, yy)]]
    return [np.array([-10 * np.log10(error(*one)) for one in zip(w, xy, yy)]) for w in maps]


def planes(hs, noise):
    out = []
    for h in hs:
        d = np.moveaxis(h, 0, -1)
        xy = S * d.conj()[..., None, :]
        yy = d[..., :, None] * xy + noise * np.eye(3)
        w = np.linalg.solve(np.swapaxes(yy, -1, -2), np.swapaxes(xy, -1, -2)).swapaxes(-1, -2)
        out.append(-10 * np.log10(VARIANCE - (w * xy.conj()).sum().real / (3 * M * M)))
    return np.array(out)


def variance(electrons, stops, read, mean):
    e = electrons * 2.0**-stops
    return (mean * e + read**2) / e**2


def diffraction(s):
    h = np.clip(s / 2, 0, 1)
    return 2 / np.pi * (np.arccos(h) - h * np.sqrt(1 - h * h))


def limit(s, width, n=81):
    """Mean of |OTF|^2 over a range of psi: diffraction, Parseval, duality by whole eigenvalue problems."""
    half = 1 - s / 2
    if half <= 0 or s <= 0:
        return float(s <= 0)
    t = ((np.arange(n) + 0.5) / n * 2 - 1) * half
    step = 2 * half / n
    w = 2 * np.sqrt(np.maximum(1 - (np.abs(t) + s / 2) ** 2, 1e-12))
    kernel = np.sinc(s * width * (t[:, None] - t[None, :]) / np.pi) * (step / np.pi) ** 2

    def value(d):
        r = 1 / np.sqrt(d)
        values, vectors = np.linalg.eigh(kernel * r[:, None] * r[None, :])
        return values[-1] * (d * w**2).sum(), np.abs(vectors[:, -1]) * r / w

    starts = [w**-p for p in (0, 0.5, 1.0)] + [np.abs(kernel) @ w**p / w**p for p in (0.0, 1.0)]
    d = min(starts, key=lambda d: value(d)[0])
    best, reach = value(d)
    for power in np.repeat((0.3, 0.15, 0.08), 8):
        following = d * np.maximum(reach / reach.mean(), 1e-3) ** power
        found = value(following)
        if found[0] < best:
            (best, reach), d = found, following
    parseval = 8 * ((1 - s / 2) - (1 - (s / 2) ** 3) / 3) / (np.pi * s * width)
    return min(best, parseval, diffraction(s) ** 2)


def limits(width):
    """Root mean square limit of the transfer, and that in focus, [colour, M, M], at the open aperture."""
    s = np.linspace(0, 2, 61)
    f = np.fft.fftfreq(M)
    mean, focus = np.zeros((3, M, M)), np.zeros((3, M, M))
    for c, nm in enumerate(WAVELENGTHS):
        root = np.sqrt([limit(v, width * REFERENCE / nm) for v in s])
        for i, j in itertools.product(range(-2, 3), repeat=2):
            x, y = f[:, None] + i, f[None, :] + j
            at = 2 * np.hypot(x, y) / cutoff(nm, 0)
            pixel = np.abs(np.sinc(x) * np.sinc(y))
            mean[c] += pixel * np.interp(at, s, root, right=0)
            focus[c] += pixel * diffraction(at)
    return np.minimum(mean, 1), np.minimum(focus, 1)


def relaxed(mean, focus, noise, depths=5, steps=120):
    """dB of a lens whose transfers are free within the limits: steps of Adam from two starts."""
    best = []
    for start in range(2):
        random = np.random.default_rng(start)
        h = np.ones((depths, 3, M, M), complex)
        if start:
            h *= np.array([[2.0 if d == c * (depths - 1) // 2 else 0.3 for c in range(3)] for d in range(depths)])[..., None, None]
        h += 0.1 * (random.standard_normal(h.shape) + 1j * random.standard_normal(h.shape))
        h *= mean / np.sqrt((np.abs(h) ** 2).mean(0))
        slope, power, top = 0, 0, -np.inf
        for step in range(1, steps + 1):
            h *= np.minimum(1, mean / np.sqrt((np.abs(h) ** 2).mean(0)))
            h *= np.minimum(1, focus / np.maximum(np.abs(h), 1e-30))
            gradient, db = np.zeros_like(h), []
            for d in range(depths):
                a = mosaic(h[d])
                xy = C_XX @ a.conj().transpose(0, 2, 1)
                w = wiener(xy, a @ xy + noise * np.eye(4))
                db.append(-10 * np.log10(VARIANCE - (w * xy.conj()).sum().real / (3 * M * M)))
                g = w.conj().transpose(0, 2, 1) @ (C_XX - w @ xy.conj().transpose(0, 2, 1))
                g = g.reshape(-1, 4, 3, 4)
                for c in range(3):
                    own = sum(g[:, p, c] * SIGNS[p] for p in range(4) if COLOURS[p] == c)
                    for k, (i, j) in enumerate(PLACES):
                        half = M // 2
                        gradient[d, c, i * half : (i + 1) * half, j * half : (j + 1) * half] = own[:, k].reshape(half, half)
            top = max(top, np.mean(db))
            slope = 0.9 * slope + 0.1 * gradient
            power = 0.99 * power + 0.01 * np.abs(gradient) ** 2
            h += 0.04 * mean * (slope / (1 - 0.9**step)) / (np.sqrt(power / (1 - 0.99**step)) + 1e-30)
        best.append(top)
    return max(best)


def close(what, found, expected, within):
    print(f"  {what}: {found:.3f}, expected {expected:.3f}")
    assert abs(found - expected) <= within, f"{what}: {found} dB, expected {expected} within {within}"


def check(edof):
    ranges, lights = (8, 16), (100, 1000, 10000)
    with tempfile.TemporaryDirectory() as folder:
        command = [edof, "optics", "bound", "ring-outer", "--range", ",".join(f"{r}:0" for r in ranges), "--electrons"]
        command += [",".join(map(str, lights)), "--out", folder, "--json"]
        told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    rows = told["rows"]
    assert [(r["psi_range"][1], r["electrons"]) for r in rows] == list(itertools.product(ranges, lights))
    for width in ranges:
        mean, focus = limits(width)
        depths = np.linspace(0, width, 9 if width < 16 else 11)
        for row in (r for r in rows if r["psi_range"][1] == width):
            noise = lambda stops: variance(row["electrons"], stops, told["read_noise_e"], told["mean_light"])
            print(f"psi 0 to {width}, {row['electrons']} electrons")
            for name, ring in (("clear", False), ("lens", True)):
                for index, estimate in enumerate(("blind", "known")):
                    at = row[name][estimate]
                    shifted = depths - at["focus_psi"]
                    hs = [np.array([transfer(nm, psi, at["stops"], ring) for nm in WAVELENGTHS]) for psi in shifted]
                    db = bayer(hs, noise(at["stops"]))[index]
                    close(f"{name}, {estimate}, average", at["average_db"], db.mean(), 0.05)
                    close(f"{name}, {estimate}, worst", at["worst_db"], db.min(), 0.05)
            close("limit, three planes", row["ceiling"]["planes_db"], planes([mean], noise(0))[0], 0.05)
            close("limit, mosaic", row["ceiling"]["bayer_db"], relaxed(mean, focus, noise(0)), 0.1)


if __name__ == "__main__":
    check(sys.argv[1])
    print("the bound agrees with its definition")
