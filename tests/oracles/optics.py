#!/usr/bin/env python3
"""Compares the PSFs of `edof optics` with a plain two-dimensional FFT of the pupil.

    tests/oracles/optics.py target/debug/edof

The pupil is sampled finely, its rim by area. Its padded transform, squared, is the light on a grid of a fraction of a pixel; a box filter of one
pixel and every so many samples of it are the PSF. Nothing is shared with the program: no symmetry, no folding, no soft samples.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

PROJECT = Path(__file__).resolve().parents[2]
GLASS = [1.458, 0.00354]
# Grid steps per pixel, and the most that a kernel may differ from the oracle's, as a share of its peak.
STEPS = 5
TOLERANCE = 2e-3

WEAK = [(3, 0, 2.3), (0, 3, 2.3), (2, 1, 0.2), (1, 2, 0.2)]
FIFTH = [(3, 0, 5.8), (0, 3, 5.8), (2, 1, 1.2), (1, 2, 1.2), (4, 1, -2.2), (1, 4, -2.2), (3, 2, 3.3), (2, 3, 3.3)]
# Name, powers of x and y with radians at 460 nm, glass, ring of the camera (inner radius, outer radius, radians at 460 nm).
MASKS = [
    ("cubic-weak", WEAK, GLASS, None),
    ("cubic-fifth", FIFTH, None, None),
    ("cubic-strong", [(3, 0, 20.0), (0, 3, 20.0)], GLASS, None),
    ("skew-and-ring", [(3, 0, 4.0), (1, 1, 1.5), (0, 5, -3.0)], GLASS, (0.6, 0.85, -2.5)),
]
PSIS = [0.0, 5.0]


def camera(name, terms, glass, ring):
    """A camera file with a mask."""
    base = json.loads((PROJECT / "cameras/clear-mid.json").read_text())
    polynomial = {"at_nm": 460, "terms": [{"x": x, "y": y, "rad": rad} for x, y, rad in terms]}
    if glass:
        polynomial["cauchy"] = glass
    rings = []
    if ring:
        inner, outer, rad = ring
        rings = [{"inner": inner, "outer": outer, "delay": {"phase": {"rad": rad, "at_nm": 460}}}]
    return base | {"name": name, "rings": rings, "mask": [{"polynomial": polynomial}]}


def contrast_of_glass(glass, nm):
    """n(λ) − 1."""
    return glass[0] + glass[1] / (nm * 1e-3) ** 2 - 1


def psf(camera, terms, glass, ring, nm, psi, pixels):
    """The PSF about the middle of an array of `pixels` squared, the first row on top."""
    wave_um = nm * 1e-3 * camera["focal_length_mm"] / (2 * camera["aperture_radius_mm"])
    pitch = camera["pixel_pitch_um"]
    size = pixels * STEPS
    step = 2 * wave_um * STEPS / (size * pitch)  # of the pupil, in radii
    fine = 6 * 256 // pixels
    reach = int(np.ceil(1 / step)) + 1
    centres = np.arange(-reach, reach + 1) * step
    parts = (np.arange(fine) + 0.5) / fine - 0.5
    x = (centres[:, None] + parts * step).ravel()
    x, y = x[None, :], -x[:, None]
    rho = np.hypot(x, y)
    phase = sum(rad * x**i * y**j for i, j, rad in terms) * 460 / nm
    if glass:
        phase = phase * contrast_of_glass(glass, nm) / contrast_of_glass(glass, 460)
    if ring:
        inner, outer, rad = ring
        phase = phase + np.where((rho > inner) & (rho < outer), rad * 460 / nm, 0)
    phase = phase + camera["defocus_sign"] * (psi - camera["focus_psi"]) * rho**2 * camera["reference_wavelength_nm"] / nm
    pupil = np.where(rho < 1, np.exp(1j * phase), 0)
    side = 2 * reach + 1
    pupil = pupil.reshape(side, fine, side, fine).mean(axis=(1, 3))
    padded = np.zeros((size, size), complex)
    at = np.arange(-reach, reach + 1) % size
    padded[np.ix_(at, at)] = pupil
    light = np.abs(np.fft.fft2(padded)) ** 2
    frequency = np.fft.fftfreq(size) * STEPS  # cycles per pixel
    box = np.sinc(frequency)
    collected = np.fft.ifft2(np.fft.fft2(light) * box[:, None] * box[None, :]).real[::STEPS, ::STEPS]
    return np.fft.fftshift(collected) / collected.sum()


def main():
    program = sys.argv[1]
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, terms, glass, ring in MASKS:
            file = folder / f"{name}.json"
            lens = camera(name, terms, glass, ring)
            file.write_text(json.dumps(lens))
            out = folder / name
            depths = ",".join(str(psi) for psi in PSIS)
            subprocess.run([program, "-q", "optics", file, "--psi", depths, "--out", out], check=True, stdout=subprocess.DEVNULL)
            bank = np.load(out / "psf.npz")
            for psi, kernels in zip(bank["psi"], bank["psf"]):
                for nm, kernel in zip(lens["spectra"], kernels):
                    expected = psf(lens, terms, glass, ring, nm, psi, 256 if len(kernel) < 200 else 512)
                    half, middle = kernel.shape[0] // 2, expected.shape[0] // 2
                    part = slice(middle - half, middle + half + 1)
                    expected = expected[part, part]
                    kept = kernel > 0 if kernel.min() == 0 else np.ones_like(kernel, bool)
                    expected = np.where(kept, expected, 0) / expected[kept].sum()
                    difference = np.abs(kernel - expected).max() / expected.max()
                    worst = max(worst, difference)
                    assert difference < TOLERANCE, f"{name}, psi {psi}, {nm} nm: {difference:.2e} of the peak"
    print(f"PSFs of {len(MASKS)} masks are those of a plain FFT: at most {worst:.1e} of the peak apart")


main()
