#!/usr/bin/env python3
"""Holds pursuits, k-SVD, demosaicing and metrics to other people's programs (scikit-learn, dictlearn, ksvd, colour-demosaicing,
scikit-image), and optics and the float network to a few lines of NumPy.

    scripts/test-peers.sh            (builds the programs and the environment)
    tests/oracles/peers.py target/release
"""

import json
import struct
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

warnings.filterwarnings("ignore")
from colour_demosaicing import demosaicing_CFA_Bayer_Malvar2004, demosaicing_CFA_Bayer_Menon2007  # noqa: E402
from dictlearn import DictionaryLearning  # noqa: E402
from ksvd import ApproximateKSVD  # noqa: E402
from PIL import Image  # noqa: E402
from skimage.color import deltaE_ciede2000, rgb2lab  # noqa: E402
from skimage.metrics import peak_signal_noise_ratio, structural_similarity  # noqa: E402
from sklearn.linear_model import Lasso, orthogonal_mp  # noqa: E402

PROGRAMS = Path(sys.argv[1])
ROOT = Path(__file__).resolve().parents[2]
failures = []


def check(what, holds, told):
    print(f"{'ok  ' if holds else 'FAIL'} {what}: {told}")
    if not holds:
        failures.append(what)


def words(values):
    return " ".join(repr(float(v)) for v in np.asarray(values).ravel())


def run(program, text):
    done = subprocess.run([PROGRAMS / "examples" / program], input=text, capture_output=True, text=True, check=True)
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


def edof(*arguments):
    done = subprocess.run([PROGRAMS / "edof", *map(str, arguments)], capture_output=True, text=True, check=True)
    return done.stdout


def ms_ssim(a, b):
    """MS-SSIM of two planes after Wang, Simoncelli and Bovik, "Multi-scale structural similarity for image quality assessment", 2003,
    with the program of the authors' defaults: 11x11 Gaussian of sigma 1.5, means of 2x2 pixels, and the published exponents."""
    ramp = np.arange(-5, 6)
    window = np.exp(-(ramp[:, None] ** 2 + ramp[None, :] ** 2) / (2 * 1.5**2))
    window /= window.sum()

    def blurred(plane):
        return np.einsum("ijkl,kl->ij", np.lib.stride_tricks.sliding_window_view(plane, window.shape), window)

    def reduced(plane):
        padded = np.pad(plane, [(0, side % 2) for side in plane.shape], mode="symmetric")
        return padded.reshape(padded.shape[0] // 2, 2, -1, 2).mean(axis=(1, 3))

    product = 1.0
    for weight in (0.0448, 0.2856, 0.3001, 0.2363, 0.1333):
        mean_a, mean_b = blurred(a), blurred(b)
        contrast = (2 * (blurred(a * b) - mean_a * mean_b) + 0.03**2) / (blurred(a * a) - mean_a**2 + blurred(b * b) - mean_b**2 + 0.03**2)
        luminance = (2 * mean_a * mean_b + 0.01**2) / (mean_a**2 + mean_b**2 + 0.01**2)
        term = (luminance * contrast if weight == 0.1333 else contrast).mean()
        product *= max(term, 0) ** weight
        a, b = reduced(a), reduced(b)
    return product


def metrics(folder):
    random = np.random.default_rng(11)
    height, width, border = 193, 210, 8
    smooth = np.cumsum(random.standard_normal((height, width, 3)), axis=1)
    truth = (smooth - smooth.min()) / np.ptp(smooth)
    for name, noise in [("little noise", 0.01), ("much", 0.2)]:
        pair = [truth, np.clip(truth + noise * random.standard_normal(truth.shape), 0, 1)]
        pair = [np.round(255 * picture).astype(np.uint8) for picture in pair]
        files = [folder / "a.png", folder / "b.png"]
        for file, picture in zip(files, pair):
            Image.fromarray(picture).save(file)
        ours = json.loads(edof("compare", *files, "--border", border, "--json", "-"))
        a, b = (picture[border:-border, border:-border] / 255 for picture in pair)
        psnr = peak_signal_noise_ratio(a, b, data_range=1)
        # Wang's window of 11x11 pixels; scikit-image cuts it where it sticks out, as we do.
        ssim = structural_similarity(
            a, b, data_range=1, channel_axis=2, gaussian_weights=True, sigma=1.5, use_sample_covariance=False
        )
        error = abs(ours["psnr_db"] - psnr), abs(ours["ssim"] - ssim)
        check(f"PSNR and SSIM, {name}", max(error) < 1e-5, f"{psnr:.3f} dB and {ssim:.4f}, within {error[0]:.0e} and {error[1]:.0e}")
        scales = np.mean([ms_ssim(a[..., colour], b[..., colour]) for colour in range(3)])
        error = abs(ours["ms_ssim"] - scales)
        check(f"MS-SSIM, {name}", error < 1e-6, f"{scales:.5f}, within {error:.0e}")
        # Its matrix and white have six and five digits.
        colour = deltaE_ciede2000(rgb2lab(a), rgb2lab(b)).mean()
        error = abs(ours["ciede2000"] - colour)
        check(f"CIEDE2000, {name}", error < 1e-3 * colour, f"{colour:.4f}, within {error:.0e}")


def pupil(camera, nm, psi, across):
    """The lens's pupil on a grid of `across` by `across` points, its diameter half of that: an autocorrelation fits."""
    axis = (np.arange(across) - across // 2) / (across / 4)
    radius = np.hypot(axis[:, None], axis[None, :])
    # Points at the rim count by the share of them that lies inside.
    inside = np.clip((1 - radius) * across / 4 + 0.5, 0, 1)
    phase = camera["defocus_sign"] * (psi - camera["focus_psi"]) * camera["reference_wavelength_nm"] / nm * radius**2
    for ring in camera["rings"]:
        delay = ring["delay"]["phase"]
        phase = phase + delay["rad"] * delay["at_nm"] / nm * ((radius >= ring["inner"]) & (radius <= ring["outer"]))
    return inside * np.exp(1j * phase)


def otf(camera, nm, psi, across=1024):
    """Real transfer function by frequency in units of the cut-off, from -1 to nearly 1 along each axis."""
    spectrum = np.abs(np.fft.fft2(np.fft.ifftshift(pupil(camera, nm, psi, across)))) ** 2
    plane = np.fft.fftshift(np.fft.ifft2(spectrum)).real
    return plane / plane[across // 2, across // 2]


def optics(folder):
    psis = [0.0, 3.0, 8.0]
    for name in ["clear", "ring-2018"]:
        camera = json.loads((ROOT / "cameras" / f"{name}.json").read_text())
        edof("optics", name, "--out", folder, "--psi", ",".join(map(str, psis)), "--exact", "--json", folder / "told.json")
        mtf, psf = np.load(folder / "mtf.npz"), np.load(folder / "psf.npz")["psf"]
        f_number = camera["focal_length_mm"] / (2 * camera["aperture_radius_mm"])
        pitch = camera["pixel_pitch_um"]
        worst_mtf = worst_psf = worst_known = 0.0
        for depth, psi in enumerate(psis):
            for channel, nm in enumerate(camera["spectra"]):
                plane = otf(camera, nm, psi)
                across = len(plane)
                cutoff = 1 / (nm * 1e-3 * f_number)  # cycles a micrometre
                share = (np.arange(across) - across // 2) / (across / 2)
                at = mtf["lens_cycles_per_mm"] * 1e-3 / cutoff
                ours = mtf["lens_otf"][depth, channel]
                worst_mtf = max(worst_mtf, np.abs(ours - np.interp(at, share, plane[across // 2])).max())
                if name == "clear" and psi == 0:
                    s = np.minimum(at, 1)
                    worst_known = max(worst_known, np.abs(ours - 2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s * s))).max())
                # A pixel's share of the light: the transfer function, the pixel's own, and back at the pixels' places.
                f = share * cutoff
                seen = plane * np.outer(np.sinc(f * pitch), np.sinc(f * pitch))
                places = np.arange(-8, 9)
                back = np.exp(2j * np.pi * np.outer(places * pitch, f))
                theirs = (back @ seen @ back.T).real * ((f[1] - f[0]) * pitch) ** 2
                middle = psf.shape[-1] // 2
                mine = psf[depth, channel, middle - 8 : middle + 9, middle - 8 : middle + 9]
                worst_psf = max(worst_psf, np.abs(mine - theirs).max() / theirs.max())
        # A ring's rim among points of a grid is worth half of that.
        check(f"MTF of {name} against its pupil's autocorrelation", worst_mtf < 1e-2, f"within {worst_mtf:.1e}")
        check(f"PSF of {name} against the same", worst_psf < 1e-2, f"within {worst_psf:.1e} of the peak")
        if name == "clear":
            check("MTF in focus against the known form", worst_known < 2e-3, f"within {worst_known:.1e}")


def tensors(path):
    """A weight file: its form, and its matrices by name."""
    data = path.read_bytes()
    (length,) = struct.unpack("<Q", data[:8])
    header, body = json.loads(data[8 : 8 + length]), data[8 + length :]
    form = json.loads(header.pop("__metadata__")["edof"])["form"]
    matrix = lambda t: np.frombuffer(body[slice(*t["data_offsets"])], "<f4").reshape(t["shape"]).astype(float)  # noqa: E731
    return form, {name: matrix(tensor) for name, tensor in header.items()}


def forward(form, weights, windows):
    """network.rs's first page of documentation, in NumPy: windows (one a row) to patches."""
    shrink = {
        "two-sided": lambda b, theta: np.sign(b) * np.maximum(np.abs(b) - theta, 0),
        "one-sided": lambda b, theta: np.maximum(b - theta, 0),
        "firm": lambda b, theta: np.sign(b) * np.clip(2 * (np.abs(b) - theta), 0, np.abs(b)),
    }[form["shrinkage"]]
    first = b = windows @ weights["analysis"].T
    before = np.zeros_like(b)
    for t in range(form["layers"] - 2):
        z = shrink(b, weights[f"threshold.{t}"])
        s = weights["recurrent.0" if form["tied"] else f"recurrent.{t}"]
        b = first + z @ s.T if form["recurrence"] == "direct" else b + (z - before) @ s.T
        before = z
    z = shrink(b, weights[f"threshold.{form['layers'] - 2}"])
    linear = windows @ weights["linear_path"].T if form["linear_path"] else 0
    return z @ weights["dictionary"].T + linear


def network(folder):
    random = np.random.default_rng(13)
    height, width = 48, 64
    smooth = np.cumsum(np.cumsum(random.standard_normal((height, width)), 0), 1)
    smooth = (smooth - smooth.min()) / np.ptp(smooth)
    raw = np.round(65535 * np.clip(0.2 + 0.6 * smooth + 0.03 * random.standard_normal((height, width)), 0, 1))
    raw.astype("<u2").tofile(folder / "frame.raw")
    for name in ["paper-t4", "edof-t4w12"]:
        file = ROOT / "weights" / f"{name}.safetensors"
        form, weights = tensors(file)
        side = form["window"]
        reach = (side - 8) // 2
        padded = np.pad(raw / 65536, reach, mode="reflect")
        corners = [(r, c) for r in range(0, height, 8) for c in range(0, width, 8)]
        windows = np.array([padded[r : r + side, c : c + side].ravel() for r, c in corners])
        theirs = np.zeros((height, width, 3))
        for (r, c), patch in zip(corners, forward(form, weights, windows)):
            theirs[r : r + 8, c : c + 8] = np.moveaxis(patch.reshape(3, 8, 8), 0, -1)
        out = folder / "out.ppm"
        edof(
            "reconstruct", folder / "frame.raw", "--size", f"{width}x{height}", "--phase", "rggb", "--bit-depth", 16,
            "--weights", file, "--float", "--stride", 8, "--tone", "linear", "--bits", 16, "--out", out, "--quiet",
        )  # fmt: skip
        words = out.read_bytes()[-6 * height * width :]
        ours = np.frombuffer(words, ">u2").reshape(height, width, 3)
        error = np.abs(ours - 65535 * np.clip(theirs, 0, 1)).max()
        check(f"{name} in floating point against NumPy", error < 1.01, f"within {error:.2f} of 65535 steps")


started = time.perf_counter()
for test in [omp, lasso, k_svd, demosaicing, omp_speed]:
    test()
for test in [metrics, optics, network]:
    with tempfile.TemporaryDirectory() as made:
        test(Path(made))
print(f"{len(failures)} failed, {time.perf_counter() - started:.0f} seconds")
sys.exit(bool(failures))
