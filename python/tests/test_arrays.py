"""Layout, memory, threads and signals."""

import os
import signal
import subprocess
import threading
import time
import tracemalloc
from pathlib import Path
from typing import Any, Union

import numpy as np
import pytest
from numpy.typing import NDArray

import edof


def test_strides_of_any_sign_give_the_result_of_a_copy(network: edof.FixedNetwork) -> None:
    large = np.random.default_rng(0).integers(0, 4096, (64, 96)).astype(np.uint16)
    views = [large[::-1], large[:, ::-1], large[::-2, ::-2], large[4:36, 8:56], large.T[::2], np.asfortranarray(large)]
    for view in views:
        found = edof.reconstruct(view, network, bit_depth=12)
        expected = edof.reconstruct(np.ascontiguousarray(view), network, bit_depth=12)
        assert found.tobytes() == expected.tobytes()
    colours = np.random.default_rng(1).random((32, 48, 3), np.float32)
    planes = colours.transpose(2, 0, 1)
    assert edof.encode(planes).tobytes() == edof.encode(planes.copy()).tobytes()
    kernel = edof.psf("ring-outer", 4.0)[1]
    assert edof.blur(planes[0, ::-1], kernel).tobytes() == edof.blur(planes[0, ::-1].copy(), kernel).tobytes()


def unaligned(array: NDArray[Any]) -> NDArray[Any]:
    """The array at an odd address."""
    memory = np.zeros(array.nbytes + 1, np.uint8)
    view = memory[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


def test_arrays_of_every_type_give_the_result_of_the_native_type(network: edof.FixedNetwork, light: NDArray[np.float32]) -> None:
    raw = np.random.default_rng(0).integers(0, 256, (32, 48)).astype(np.uint16)
    expected = edof.reconstruct(raw, network, bit_depth=12)
    for kind in ["u1", "<u2", ">u2", "<i2", ">i4", "i8", ">u8", "f2", "<f4", ">f8"]:
        for view in [raw.astype(kind), raw[::-1].astype(kind)[::-1], unaligned(raw.astype(kind))]:
            assert edof.reconstruct(view, network, bit_depth=12).tobytes() == expected.tobytes(), kind
    coarse = light.astype(np.float16).astype(np.float32)
    expected = edof.encode(coarse)
    for kind in ["<f2", ">f2", "<f4", ">f4", "<f8", ">f8", "g"]:
        for view in [coarse.astype(kind), coarse.astype(kind).transpose(1, 2, 0).copy().transpose(2, 0, 1), unaligned(coarse.astype(kind))]:
            assert edof.encode(view).tobytes() == expected.tobytes(), kind
    # Numbers between those of float32 are rounded to the nearest, as NumPy does.
    fine = light.astype(np.float64) + 1e-9
    assert edof.encode(fine).tobytes() == edof.encode(fine.astype(np.float32)).tobytes()
    bank = np.stack([np.stack([edof.psf("clear", 0.0)[1]] * 3)] * 2)
    camera = edof.Camera("clear")
    assert camera.with_psfs(np.arange(2), bank.astype(np.float64)) == camera.with_psfs(np.array([0.0, 1.0]), bank)


def test_arrays_of_the_native_type_are_read_in_place() -> None:
    raw = np.zeros((1, 1 << 22), np.uint16)
    peaks = []
    for view in [raw, raw.view(np.int16)]:
        tracemalloc.start()
        with pytest.raises(edof.EdofError, match="4194304x1"):
            edof.demosaic(view)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # A conversion passes through a copy.
    assert peaks[0] < 1 << 20 < raw.nbytes < peaks[1]


def test_read_only_arrays_are_read_and_results_are_writable(network: edof.FixedNetwork) -> None:
    raw = np.full((32, 48), 700, np.uint16)
    raw.flags.writeable = False
    sharp = edof.reconstruct(raw, network, bit_depth=12)
    assert sharp.flags.writeable and sharp.flags.c_contiguous
    before = edof.reconstruct(raw, network, bit_depth=12)
    sharp[...] = 0.0
    assert edof.reconstruct(raw, network, bit_depth=12).tobytes() == before.tobytes()


def test_results_have_the_memory_that_rust_made(light: NDArray[np.float32]) -> None:
    # Moved, not copied: the array has an owner behind it that is no array.
    kernel = edof.psf("ring-outer", 4.0)[1]
    for array in [edof.blur(light[0], kernel), edof.encode(light), kernel]:
        assert not array.flags.owndata
        assert array.base is not None and not isinstance(array.base, np.ndarray)


def test_the_adjoint_is_one(light: NDArray[np.float32]) -> None:
    rng = np.random.default_rng(4)
    other = rng.random(light.shape, np.float32)
    aberrated = edof.Camera("ring-outer").with_aberrations({7: 120.0, 5: -80.0})
    for camera in [edof.Camera("ring-2018"), aberrated]:
        kernels = edof.psf(camera, 5.0)
        forward = np.vdot(edof.blur(light, kernels).astype(np.float64), other)
        back = np.vdot(light.astype(np.float64), edof.blur_adjoint(other, kernels))
        assert forward == pytest.approx(back, rel=1e-5)
        plane = edof.blur(light[1], kernels[1])
        assert plane.tobytes() == edof.blur(light, kernels)[1].tobytes()


def test_cameras_can_be_changed(light: NDArray[np.float32]) -> None:
    camera = edof.Camera("ring-outer")
    bank = np.stack([np.stack([np.pad(k, (31 - k.shape[0]) // 2) if k.shape[0] < 31 else k[:31, :31] for k in edof.psf(camera, psi)]) for psi in (0.0, 1.0)])
    banked = camera.with_psfs(np.array([0.0, 1.0]), bank.astype(np.float32))
    assert banked.psi_range == (0.0, 1.0) and banked != camera
    assert edof.Camera.from_json(camera.json()) == camera and hash(edof.Camera.from_json(camera.json())) == hash(camera)
    flat = camera.with_height_map(np.zeros((16, 16), np.float32), white_um=1.0, cauchy=(1.5, 0.004))
    assert not flat.same_lens(camera)
    wedge = np.tile(np.linspace(0, 1, 16, dtype=np.float32), (16, 1))
    moved = camera.with_height_map(wedge, white_um=4.0, cauchy=(1.5, 0.0))
    kernel = edof.psf(moved, 0.0)[1]
    columns = np.arange(kernel.shape[1]) - kernel.shape[1] // 2
    # A wedge that is higher on the right moves the picture to the right.
    assert (kernel.sum(axis=0) * columns).sum() > 0.5
    ring = {"inner": 0.6, "outer": 0.9, "delay": {"phase": {"rad": 3.0, "at_nm": 500}}}
    ringed = camera.with_mask([{"ring": ring}])
    assert ringed == edof.Camera.from_json(ringed.json()) and not ringed.same_lens(camera)
    assert '"rings": []' in camera.with_mask([]).json()
    metres = camera.metres_at(4.0, nominal_m=10.0)
    assert metres is not None and camera.psi_at(metres, nominal_m=10.0) == pytest.approx(4.0)


def test_a_bank_beside_its_middle_is_shifted_back(tmp_path: Path) -> None:
    psf = np.zeros((2, 3, 23, 24))
    psf[:, :, 9, 15] = 1.0
    np.savez(tmp_path / "lens.npz", psi=[0.0, 1.0], psf=psf)
    sides = [edof.psf(edof.Camera("clear", psf_bank=tmp_path / "lens.npz", centre=centre), 0.0)[1].shape for centre in (False, True)]
    assert sides == [(7, 7), (1, 1)]
    with pytest.raises(edof.EdofError, match="centre: shifts a PSF bank"):
        edof.Camera("clear", centre=True)


def test_scenes_of_layers_and_drawn_ones_are_captured() -> None:
    scene = edof.Scene.draw("chart-4", 64, 96, camera="ring-outer")
    assert scene.psi == [0.0, pytest.approx(8 / 3), pytest.approx(16 / 3), 8.0] and scene.shape == (64, 96)
    shot = edof.capture(scene, "ring-outer")
    assert (shot.raw.shape, shot.raw.dtype, shot.bit_depth, shot.phase) == ((64, 96), np.uint16, 12, "rggb")
    assert len(shot.kernels) == 4 and shot.kernels[0]["psi"] == 0.0
    sharp, matte = scene.sharp(), (scene.psi_map() > 4.0).astype(np.float32)
    layered = edof.Scene.from_layers([(sharp, None, 0.0), (sharp, matte, 6.0)])
    assert edof.capture(layered, "ring-outer").raw.shape == (64, 96)


def test_a_capture_as_a_raw_frame_states_how_it_was_taken(network: edof.FixedNetwork, light: NDArray[np.float32]) -> None:
    shot = edof.capture(light, "ring-outer", 6.0, bit_depth=10, phase="gbrg", black_level=32)
    assert (shot.bit_depth, shot.phase, shot.black_level, shot.camera.name) == (10, "gbrg", 32, "ring-outer")
    assert repr(shot) == "Capture(ring-outer, 10 bits, gbrg, 1 depths)"
    stated = {"bit_depth": 10, "phase": "gbrg", "black_level": 32, "camera": "ring-outer"}
    for call in [edof.reconstruct, edof.board_picture, edof.words]:
        found, expected, agreed = call(shot, network), call(shot.raw, network, **stated), call(shot, network, **stated)
        for value in [found, agreed]:
            if isinstance(value, dict):
                assert all(value[name].tobytes() == words.tobytes() for name, words in expected.items())
            else:
                assert pixels(value).tobytes() == pixels(expected).tobytes()
    tiny = edof.Design("tiny")
    flat = np.full((3, *tiny.shape), 0.5, np.float32)
    shots = [edof.capture(flat, "ring-outer", psi, bit_depth=12) for psi in (0.0, 8.0)]
    measured = tiny.estimate(tiny.random_network(1), shots)
    assert measured == tiny.estimate(tiny.random_network(1), [shot.raw for shot in shots], bit_depth=12)
    assert measured == tiny.estimate(tiny.random_network(1), shots, bit_depth=12)


def pixels(made: Union[NDArray[np.float32], edof.BoardPicture]) -> NDArray[Any]:
    """All numbers of a picture or of the board's."""
    return made.yuyv() if isinstance(made, edof.BoardPicture) else made


@pytest.mark.parametrize("kind", [edof.Network, edof.FixedNetwork])
def test_a_network_for_another_lens_is_refused_with_the_words_of_the_shell(
    program: Path, tmp_path: Path, picture: NDArray[np.float32], kind: type[Union[edof.Network, edof.FixedNetwork]]
) -> None:
    edof.save_picture(tmp_path / "photo.png", picture, curve="linear")
    words = "capture photo.png --camera ring-2018 --psi 4 --out raw.png -q".split()
    subprocess.run([program, *words], cwd=tmp_path, check=True)
    words = "reconstruct raw.png --weights edof-t4w12-outer-light --out no.png".split()
    shell = subprocess.run([program, *words], cwd=tmp_path, capture_output=True, text=True).stderr
    both = " trained for the camera ring-outer, but raw{} was taken by ring-2018, another lens or mask (they differ in defocus_sign, focus_psi, rings)"
    assert both.format(".png") in shell
    network = kind.load("edof-t4w12-outer-light")
    light = edof.decode(edof.load_picture(tmp_path / "photo.png"))
    shot = edof.capture(light, "ring-2018", 4.0)
    calls = [edof.reconstruct] if kind is edof.Network else [edof.reconstruct, edof.board_picture, edof.words]
    for call in calls:
        with pytest.raises(edof.EdofError) as caught:
            call(shot, network)
        assert str(caught.value).startswith("network edof-t4w12-outer-light:" + both.format("") + "; use network edof-t4w12")
        with pytest.raises(edof.EdofError, match="but camera is ring-2018, another lens or mask"):
            call(shot.raw, network, bit_depth=12, camera="ring-2018")
        with pytest.raises(edof.EdofError, match="^camera clear: the capture states ring-2018 .they differ in .*rings.; leave camera out$"):
            call(shot, network, camera="clear")
        call(shot.raw, network, bit_depth=12)
    renamed = edof.Camera.from_json(network.camera.json().replace('"ring-outer"', '"mine"'))
    assert renamed.name == "mine"
    edof.reconstruct(edof.capture(light, renamed, 4.0), network)


def test_deconvolution_and_pursuits_do_what_they_are_for(light: NDArray[np.float32]) -> None:
    kernel = edof.psf("clear-mid", 6.0)[1]
    blurred = edof.blur(light[1], kernel)
    wrong = float(np.mean((blurred - light[1])[16:-16, 16:-16] ** 2))
    for sharp in [
        edof.wiener(blurred, kernel, noise_to_contrast=1e-4),
        edof.richardson_lucy(blurred, kernel, steps=40),
        edof.hyper_laplacian(blurred, kernel),
    ]:
        assert np.mean((sharp - light[1])[16:-16, 16:-16] ** 2) < 0.7 * wrong
    picture, found = edof.blind_deconvolution(blurred, side=9)
    assert picture.shape == blurred.shape and found.sum() == pytest.approx(1.0, abs=1e-4)
    rng = np.random.default_rng(0)
    atoms = rng.normal(size=(12, 20)).astype(np.float32)
    atoms /= np.linalg.norm(atoms, axis=0)
    signals = (atoms[:, [3, 7]] @ np.array([[2.0], [-1.0]], np.float32)).T.astype(np.float32)
    codes = edof.omp(signals, atoms, atoms=2)
    assert np.flatnonzero(codes[0]).tolist() == [3, 7]
    assert np.allclose(codes @ atoms.T, signals, atol=1e-4)
    for method in ["fista", "ista"]:
        minimum = edof.lasso(signals, atoms, 0.01, method=method, steps=5000, tolerance=1e-7)
        assert np.abs(minimum @ atoms.T - signals).max() < 0.1
    assert edof.ksvd(np.repeat(signals, 8, axis=0), atoms, atoms=2, rounds=2).shape == atoms.shape
    raw = edof.capture(light, "clear", 0.0, bit_depth=16).raw
    for method in ["malvar", "directional"]:
        assert edof.psnr(light, edof.demosaic(raw, method=method)) > 20.0


def test_a_simulated_board_is_loaded_and_shows_the_golden_picture() -> None:
    design = edof.Design("tiny")
    old, new = design.random_network(1), design.random_network(2)
    raw = np.random.default_rng(5).integers(0, 4096, design.shape).astype(np.uint16)
    with edof.Board.simulated(design, old, raw, bit_depth=12) as board:
        assert board.get("id") == 0x45444F46 and board.bank == "a" and board.shape == design.shape
        loaded = board.load(new)
        assert (loaded["bank"], loaded["in_use"], board.bank) == ("b", "b", "b")
        assert board.verify(new) == [] and board.verify(old, bank="b") != []
        board.set("scratch", 0x1234)
        assert board.get("scratch") == 0x1234 == board.registers()["scratch"]
        board.run(0.2)
        shown = board.screen()
        assert shown is not None
        golden = edof.board_picture(raw, new, bit_depth=12)
        assert shown[0].tobytes() == golden.y_code.tobytes()
        assert shown[1][:, 0::2].tobytes() == golden.cb_code.tobytes()
        assert shown[1][:, 1::2].tobytes() == golden.cr_code.tobytes()
        board.reset()
        assert board.design.name == "tiny" and not board.closed
    assert board.closed


def test_designs_are_measured_and_explored_on_frames() -> None:
    design = edof.Design("tiny")
    network = design.random_network(1)
    raw = np.random.default_rng(5).integers(0, 65536, design.shape).astype(np.uint16)
    measured = design.estimate(network, [raw, raw[::-1, ::-1]], phase="bggr")
    assert [picture["picture"] for picture in measured["pictures"]] == ["raw[0]", "raw[1]"]
    front = design.explore(network, raw, fps=1e-3)
    assert front and all(row["design"].name == network.name for row in front)
    cycles = [row["cycles_per_patch"] for row in front]
    assert min(cycles) <= measured["cycles_per_patch"]


def test_the_gil_is_released(light: NDArray[np.float32]) -> None:
    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    edof.blind_deconvolution(light[1], side=15)
    seconds = time.monotonic() - start
    stop.set()
    thread.join()
    assert counted > 20 * seconds


def test_ctrl_c_ends_a_call() -> None:
    network = edof.Network.load("edof-t4w12-outer-light")
    # A shell starts its background jobs with SIGINT ignored, and Python then leaves it so.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.7, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            # Minutes, if nobody ends it.
            network.quantize(stride=8)
    finally:
        signal.signal(signal.SIGINT, before)
    # Seconds on a busy machine; without an end it takes minutes.
    assert time.monotonic() - start < 30.0
