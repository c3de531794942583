"""Every result equals the program's: words and codes bit for bit, floats to the last bit."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import Run, extreme, raw_file
from numpy.typing import NDArray

import edof

PHASES = ["rggb", "grbg", "gbrg", "bggr"]
KINDS = ["dark", "full", "checked", "noise"]
Picture = NDArray[np.float32]


def same(found: NDArray[np.generic], expected: NDArray[np.generic]) -> None:
    """Equal in type, shape and every bit."""
    assert found.dtype == expected.dtype
    assert found.shape == expected.shape
    assert found.tobytes() == expected.tobytes()


def npz(path: Path) -> dict[str, NDArray[np.generic]]:
    with np.load(path) as file:
        return {name: np.ascontiguousarray(file[name]) for name in file.files}


@pytest.mark.parametrize("camera", ["ring-outer", "ring-2018", "clear"])
def test_psf_and_otf_are_those_of_the_program(run: Run, tmp_path: Path, camera: str) -> None:
    run("optics", camera, "--psi", "0,3,8", "--out", "out", "-q")
    expected = npz(tmp_path / "out" / "psf.npz")["psf"]
    for depth, psi in enumerate([0.0, 3.0, 8.0]):
        for channel, kernel in enumerate(edof.psf(camera, psi)):
            margin = (expected.shape[2] - kernel.shape[0]) // 2
            whole = np.pad(kernel, margin)
            same(whole, np.ascontiguousarray(expected[depth, channel]))
    numbers = npz(tmp_path / "out" / "mtf.npz")
    frequencies = numbers["lens_cycles_per_mm"].astype(np.float64)
    for channel, name in enumerate(["red", "green", "blue"]):
        _, values = edof.otf(camera, 3.0, name, cycles_per_mm=frequencies)
        same(values, np.ascontiguousarray(numbers["lens_otf"][1, channel]))
        _, magnitudes = edof.mtf(camera, 3.0, name, cycles_per_mm=frequencies)
        same(magnitudes, np.abs(values))
    pixels = numbers["sensor_cycles_per_pixel"].astype(np.float64)
    response = edof.sampled_otf(edof.psf(camera, 3.0)[1], pixels)
    same(np.ascontiguousarray(response.real), np.ascontiguousarray(numbers["sensor_otf_real"][1, 1]))
    same(np.ascontiguousarray(response.imag), np.ascontiguousarray(numbers["sensor_otf_imaginary"][1, 1]))


@pytest.mark.parametrize("phase", PHASES)
def test_capture_gives_the_frame_of_the_program(run: Run, tmp_path: Path, picture: Picture, phase: str) -> None:
    edof.save_picture(tmp_path / "photo.png", picture, curve="linear")
    noise = "sensor:gain=4"
    run("capture", "photo.png", "--camera", "ring-outer", "--psi", 5, "--phase", phase, "--bit-depth", 12, "--noise", noise, "--seed", 7,
        "--black-level", 64, "--out", "raw.pgm", "-q")  # fmt: skip
    light = edof.decode(edof.load_picture(tmp_path / "photo.png"))
    shot = edof.capture(light, "ring-outer", 5.0, phase=phase, noise=noise, seed=7, black_level=64)
    raw_file(tmp_path / "own.pgm", shot.raw, 12)
    assert read_pgm(tmp_path / "raw.pgm").tobytes() == read_pgm(tmp_path / "own.pgm").tobytes()


def read_pgm(path: Path) -> NDArray[np.uint16]:
    """Values of a PGM of 16 bits."""
    words = path.read_bytes().split(maxsplit=4)
    assert words[0] == b"P5"
    columns, rows, most = (int(word) for word in words[1:4])
    data = path.read_bytes()[-2 * rows * columns :]
    values = np.frombuffer(data, ">u2").reshape(rows, columns).astype(np.uint16)
    return values if most == 65535 else (values.astype(np.uint32) * 65535 // most).astype(np.uint16)


def test_capture_of_a_depth_map_is_that_of_the_program(run: Run, tmp_path: Path, picture: Picture) -> None:
    edof.save_picture(tmp_path / "photo.png", picture, curve="linear")
    rows, columns = picture.shape[1:]
    ramp = np.tile(np.linspace(0.0, 1.0, columns, dtype=np.float32), (rows, 1))
    ramp = np.round(ramp * 4.0) / np.float32(4.0)
    edof.save_picture(tmp_path / "map.png", np.stack([ramp] * 3), curve="linear", bits=16)
    run("capture", "photo.png", "--camera", "ring-outer", "--depth-map", "map.png", "--range", "8:0", "--layers", 5,
        "--out", "raw.pgm", "-q")  # fmt: skip
    nearness = edof.load_picture(tmp_path / "map.png")[0].astype(np.float64)
    scene = edof.Scene.from_depths(edof.decode(edof.load_picture(tmp_path / "photo.png")), (nearness * 8.0).astype(np.float32), layers=5)
    shot = edof.capture(scene, "ring-outer")
    raw_file(tmp_path / "own.pgm", shot.raw, 12)
    same(read_pgm(tmp_path / "own.pgm"), read_pgm(tmp_path / "raw.pgm"))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("phase", PHASES)
def test_words_at_every_boundary_are_those_of_the_program(run: Run, tmp_path: Path, kind: str, phase: str) -> None:
    raw = extreme(kind)
    raw_file(tmp_path / "raw.pgm", raw, 16)
    run("reconstruct", "raw.pgm", "--weights", "edof-t4w12-outer-light", "--phase", phase, "--words", "words",
        "--out", "sharp.png", "-q")  # fmt: skip
    expected = npz(tmp_path / "words" / "words.npz")
    found = edof.words(raw, "edof-t4w12-outer-light", phase=phase)
    assert sorted(found) == sorted(expected)
    for name, words in expected.items():
        same(found[name], words)


def test_words_of_a_photograph_are_those_of_the_program(run: Run, tmp_path: Path, light: Picture) -> None:
    raw = edof.capture(light, "ring-outer", 8.0, bit_depth=16, noise=0.01, seed=2).raw
    raw_file(tmp_path / "raw.pgm", raw, 16)
    run("reconstruct", "raw.pgm", "--weights", "edof-t4w12-outer-light", "--words", "words", "--out", "sharp.png", "-q")
    expected = npz(tmp_path / "words" / "words.npz")
    for name, words in edof.words(raw, "edof-t4w12-outer-light").items():
        same(words, expected[name])


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("display", ["colour", "luma"])
def test_board_codes_are_those_of_the_program(run: Run, tmp_path: Path, light: Picture, phase: str, display: str) -> None:
    raw = edof.capture(light, "ring-outer", 4.0, phase=phase, seed=1).raw
    raw_file(tmp_path / "raw.pgm", raw, 12)
    run("reconstruct", "raw.pgm", "--weights", "edof-t4w12-outer-light", "--bit-depth", 12, "--phase", phase, "--board", "--display", display,
        "--out", "board.png", "-q")  # fmt: skip
    made = edof.board_picture(raw, "edof-t4w12-outer-light", bit_depth=12, phase=phase, display=display)
    assert made.yuyv().tobytes() == (tmp_path / "board.yuyv").read_bytes()
    edof.save_picture(tmp_path / "own.png", made.shown(), curve="linear")
    same(edof.load_picture(tmp_path / "own.png"), edof.load_picture(tmp_path / "board.png"))
    same(made.y_code, np.ascontiguousarray(made.yuyv()[0::2].reshape(raw.shape)))


@pytest.mark.parametrize("stride", [2, 4, 8])
@pytest.mark.parametrize("kind", ["noise", "checked", "photograph"])
def test_float_pictures_are_those_of_the_program(run: Run, tmp_path: Path, light: Picture, kind: str, stride: int) -> None:
    raw = edof.capture(light, "ring-outer", 6.0, bit_depth=16).raw if kind == "photograph" else extreme(kind)
    raw_file(tmp_path / "raw.pgm", raw, 16)
    run("reconstruct", "raw.pgm", "--float", "--weights", "edof-t4w12-outer-light", "--stride", stride, "--tone", "linear",
        "--bits", 16, "--out", "sharp.tif", "-q")  # fmt: skip
    network = edof.Network.load("edof-t4w12-outer-light")
    sharp = edof.reconstruct(raw, network, stride=stride)
    edof.save_picture(tmp_path / "own.tif", sharp, curve="linear", bits=16)
    assert (tmp_path / "own.tif").read_bytes() == (tmp_path / "sharp.tif").read_bytes()


@pytest.mark.parametrize("phase", PHASES)
def test_fixed_pictures_and_levels_are_those_of_the_program(run: Run, tmp_path: Path, light: Picture, phase: str) -> None:
    raw = edof.capture(light, "ring-outer", 6.0, phase=phase, black_level=64).raw
    raw_file(tmp_path / "raw.pgm", raw, 12)
    run("reconstruct", "raw.pgm", "--weights", "edof-t4w12-outer-light", "--bit-depth", 12, "--phase", phase, "--black-level", 64,
        "--white-level", 4000, "--bits", 16, "--out", "sharp.tif", "-q")  # fmt: skip
    sharp = edof.reconstruct(raw, "edof-t4w12-outer-light", bit_depth=12, phase=phase, black_level=64, white_level=4000.0)
    edof.save_picture(tmp_path / "own.tif", sharp, bits=16)
    assert (tmp_path / "own.tif").read_bytes() == (tmp_path / "sharp.tif").read_bytes()


def test_a_sensor_is_measured_and_corrected_as_by_the_program(run: Run, tmp_path: Path, light: Picture) -> None:
    rng = np.random.default_rng(2)
    shape = light.shape[1:]
    offsets = 200 + rng.normal(0.0, 5.0, shape[1])[None, :] + np.where(rng.random(shape) < 0.002, 900.0, 0.0)

    def frames(level: float) -> NDArray[np.uint16]:
        values = offsets + level + rng.normal(0.0, 3.0, (6, *shape))
        return np.clip(np.rint(values), 0, 4095).astype(np.uint16)

    dark, flat = frames(0.0), frames(1800.0)
    flat[:, :, 31] = 0
    for kind, all in (("dark", dark), ("flat", flat)):
        (tmp_path / f"{kind}.raw").write_bytes(all.astype("<u2").tobytes())
    size = f"{shape[1]}x{shape[0]}"
    run("sensor", "--dark", "dark.raw", "--flat", "flat.raw", "--size", size, "--bit-depth", 12, "--phase", "gbrg",
        "--out", "sensor.safetensors", "--json", "sensor.json", "-q")  # fmt: skip
    sensor = edof.Sensor.measure(dark, flat, bit_depth=12, phase="gbrg")
    report = json.loads((tmp_path / "sensor.json").read_text())
    for field, value in sensor.report.items():
        assert report[field] == value, field
    assert (sensor.shape, sensor.phase, sensor.bit_depth) == (shape, "gbrg", 12)
    assert bool(sensor.defects[:, 31].all())
    assert bool(sensor.defects[offsets > 900].all())

    raw = np.clip(offsets + 3000 * light[1], 0, 4095).astype(np.uint16)
    loaded = edof.Sensor.load(tmp_path / "sensor.safetensors")
    same(loaded.light(raw), sensor.light(raw))
    sensor.save(tmp_path / "own.safetensors")
    raw_file(tmp_path / "raw.pgm", raw, 12)
    name = "edof-t4w12-outer-light"
    run("reconstruct", "raw.pgm", "--weights", name, "--phase", "gbrg", "--sensor", "own.safetensors", "--bits", 16, "--out", "sharp.tif", "-q")
    sharp = edof.reconstruct(raw, name, bit_depth=12, phase="gbrg", sensor=sensor)
    same(edof.reconstruct(sensor.light(raw), name, phase="gbrg"), sharp)
    same(edof.reconstruct(raw, name, bit_depth=12, phase="gbrg", sensor=tmp_path / "sensor.safetensors"), sharp)
    edof.save_picture(tmp_path / "own.tif", sharp, bits=16)
    assert (tmp_path / "own.tif").read_bytes() == (tmp_path / "sharp.tif").read_bytes()


@pytest.mark.parametrize("bits,stride", [(16, 8), (12, 4), (8, 2)])
def test_quantization_gives_the_words_of_the_program(run: Run, tmp_path: Path, bits: int, stride: int) -> None:
    rng = np.random.default_rng(bits)
    form = "one-sided,w8,t3,c16,r"
    arrays = {
        "analysis": rng.normal(0.0, 0.2, (16, 64)).astype(np.float32),
        "thresholds": rng.uniform(0.0, 0.05, (2, 16)).astype(np.float32),
        "recurrent": rng.normal(0.0, 0.1, (1, 16, 16)).astype(np.float32),
        "dictionary": rng.normal(0.0, 0.1, (192, 16)).astype(np.float32),
        "linear_path": rng.normal(0.0, 0.05, (192, 64)).astype(np.float32),
    }
    network = edof.Network.from_arrays(form, arrays, camera="ring-outer", name="small")
    network.save(tmp_path / "small.safetensors")
    run("quantize", "small.safetensors", "--bits", bits, "--stride", stride, "--out", "own.fixed.safetensors", "-q")
    loaded = edof.Network.load(tmp_path / "small.safetensors")
    for name, array in arrays.items():
        same(loaded.arrays()[name], array)
    expected = edof.FixedNetwork.load(tmp_path / "own.fixed.safetensors")
    found = loaded.quantize(bits=bits, stride=stride)
    assert (found.fractions, found.code_bits, found.stride) == (expected.fractions, bits, stride)
    for name, words in expected.arrays().items():
        same(found.arrays()[name], words)
    raw = extreme("noise", 24, 40)
    same(edof.reconstruct(raw, found), edof.reconstruct(raw, expected))


def test_quality_is_that_of_the_program(run: Run, tmp_path: Path, picture: Picture) -> None:
    other = np.clip(picture + np.random.default_rng(0).normal(0, 0.05, picture.shape), 0, 1).astype(np.float32)
    edof.save_picture(tmp_path / "a.png", picture, curve="linear", bits=16)
    edof.save_picture(tmp_path / "b.png", other, curve="linear", bits=16)
    run("compare", "a.png", "b.png", "--json", "compared.json", "-q")
    expected = json.loads((tmp_path / "compared.json").read_text())
    a, b = (edof.load_picture(tmp_path / f"{name}.png") for name in "ab")
    found = edof.quality(a, b, tone="srgb")
    assert {"psnr_db", "ssim"} < set(found) <= {metric["name"] for metric in edof.metrics()}
    for field, number in found.items():
        assert number == expected[field], field
    assert edof.psnr(a, b) == expected["psnr_db"]
    assert edof.psnr(a, a) == float("inf") == edof.quality(a, a)["psnr_db"]


@pytest.mark.parametrize("design", ["tiny", "paper", "kc705"])
def test_estimates_are_those_of_the_program(run: Run, tmp_path: Path, design: str) -> None:
    run("estimate", "--design", design, "--json", "estimate.json", "-q")
    expected = json.loads((tmp_path / "estimate.json").read_text())
    found = edof.Design(design).estimate()
    assert {name: expected[name] for name in found} == found


def test_generated_sources_are_those_of_the_program(run: Run, tmp_path: Path) -> None:
    design = edof.Design("tiny")
    network = design.random_network(3)
    network.save(tmp_path / "random.fixed.safetensors")
    run("generate", "--design", "tiny", "--weights", "random.fixed.safetensors", "--out", "theirs", "-q")
    manifest = design.generate(edof.FixedNetwork.load(tmp_path / "random.fixed.safetensors"), tmp_path / "ours")
    assert manifest == json.loads((tmp_path / "theirs" / "manifest.json").read_text())
    theirs = {p.relative_to(tmp_path / "theirs"): p.read_bytes() for p in (tmp_path / "theirs").rglob("*") if p.is_file()}
    ours = {p.relative_to(tmp_path / "ours"): p.read_bytes() for p in (tmp_path / "ours").rglob("*") if p.is_file()}
    assert ours == theirs
    with pytest.raises(edof.EdofError, match="holds what no earlier run wrote"):
        (tmp_path / "ours" / "files.f").write_text("mine\n")
        design.generate(network, tmp_path / "ours")


def test_a_training_gives_the_weights_of_the_program(run: Run, tmp_path: Path) -> None:
    photos = [edof.Scene.draw("leaves", 192, 256, psi=[0.0], seed=seed).sharp() for seed in (1, 2)]
    (tmp_path / "photos").mkdir()
    for index, photo in enumerate(photos):
        edof.save_picture(tmp_path / "photos" / f"p{index}.png", photo, bits=16)
    run("train", "--form", "one-sided,w8,t3,c16,r", "--camera", "ring-outer", "--images", "photos", "--photos", "all", "--steps", 30, "--batch", 64,
        "--validate-every", 15, "--depths", 2, "--seed", 5, "--threads", 1, "--no-cache", "--out", "theirs.safetensors", "-q")  # fmt: skip
    pictures = [edof.load_picture(tmp_path / "photos" / f"p{index}.png") for index in (0, 1)]
    recipe = {"steps": 30, "batch": 64, "validate_every": 15, "seed": 5}
    network, reports = edof.train("one-sided,w8,t3,c16,r", pictures, "ring-outer", recipe=recipe, psi=[0.0, 8.0], threads=2)
    assert [report["step"] for report in reports] == [15, 30]
    expected = edof.Network.load(tmp_path / "theirs.safetensors").arrays()
    for name, array in network.arrays().items():
        same(array, expected[name])


def test_a_pair_is_taken_and_reconstructed_as_by_the_program(run: Run, tmp_path: Path, picture: Picture) -> None:
    edof.save_picture(tmp_path / "photo.png", picture, curve="linear")
    lens = edof.Camera("clear-mid")
    recipe = {"steps": 10, "batch": 8, "validate_every": 10}
    photos = [edof.Scene.draw("leaves", 192, 256, psi=[0.0], seed=seed).sharp() for seed in (1, 2)]
    network, _ = edof.train("one-sided,w8,t3,c16,r,e2", photos, lens, recipe=recipe, psi=[3.0], focus=[2.0, 6.0], name="two")
    assert network.foci == [2.0, 6.0]
    network.save(tmp_path / "two.safetensors")
    run("capture", "photo.png", "--psi", 3, "--camera", "clear-mid", "--focus", "2,6", "--noise", "sensor:gain=2", "--seed", 7, "--out", "o.npy", "-q")
    light = edof.decode(edof.load_picture(tmp_path / "photo.png"))
    pair = [edof.capture(light, lens.with_focus(psi), 3.0, noise="sensor:gain=4", seed=seed) for psi, seed in [(2.0, 7), (6.0, 8)]]
    for number, shot in enumerate(pair, 1):
        same(shot.raw, np.load(tmp_path / f"o-{number}.npy"))
    run("reconstruct", "o-1.npy", "o-2.npy", "--weights", "two.safetensors", "--tone", "srgb", "--bits", 16, "--out", "sharp.tif", "-q")
    arrays = [shot.raw for shot in pair]
    for sharp in [edof.reconstruct(pair, network), edof.reconstruct(arrays, network, bit_depth=12, camera="clear-mid")]:
        edof.save_picture(tmp_path / "own.tif", sharp, bits=16)
        assert (tmp_path / "own.tif").read_bytes() == (tmp_path / "sharp.tif").read_bytes()
    with pytest.raises(edof.EdofError, match="they differ in focus_psi"):
        edof.reconstruct(pair[::-1], network)
    with pytest.raises(edof.EdofError, match="two: got 1 raw frame of one scene, expected 2"):
        edof.reconstruct(pair[0], network)
    with pytest.raises(edof.EdofError, match="got 2 raw frames of one scene, expected 1"):
        edof.reconstruct(pair, "edof-t4w12-clear-light")
    with pytest.raises(edof.EdofError, match=r"raw\[1\]: bit depth 10, expected 12 as raw\[0\]"):
        edof.reconstruct([pair[0], edof.capture(light, lens.with_focus(6.0), 3.0, bit_depth=10)], network)
