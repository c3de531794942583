"""What cannot be used raises one clear exception, of one line."""

from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import edof

ERROR = edof.EdofError
Case = tuple[str, Callable[[], Any], type[Exception], str]

RAW = np.full((32, 48), 700, np.uint16)
LIGHT = np.full((3, 32, 48), 0.5, np.float32)
PLANE = np.full((32, 48), 0.5, np.float32)
KERNEL = np.full((3, 3), 1 / 9, np.float32)
SIGNALS = np.ones((4, 6), np.float32)
ATOMS = np.eye(6, dtype=np.float32)
NET = edof.FixedNetwork.load("edof-t4w12-outer-light")
FLOAT = edof.Network.load("edof-t4w12-outer-light")
CAMERA = edof.Camera("ring-outer")
SHOT = edof.capture(LIGHT, CAMERA, 1.0)
TINY = edof.Design("tiny")
SMALL = TINY.random_network(1)
SENSOR = edof.Sensor.measure(RAW[None], bit_depth=12)


def spoilt(array: NDArray[Any], value: float) -> NDArray[Any]:
    """The array with one element that is no light."""
    copy = array.copy()
    copy[tuple(side - 1 for side in copy.shape)] = value
    return copy


def closed() -> edof.Board:
    """A board that was closed."""
    board = edof.Board.simulated(TINY, SMALL, np.zeros(TINY.shape, np.uint16))
    board.close()
    return board


def opened() -> edof.Board:
    """A board that was not."""
    return edof.Board.simulated(TINY, SMALL, np.zeros(TINY.shape, np.uint16))


def raw_cases(name: str, call: Callable[..., Any]) -> list[Case]:
    """Whatever takes a raw frame refuses the same."""
    return [
        (f"{name}: list", lambda: call([[1, 2], [3, 4]]), TypeError, "raw: list, expected a NumPy array of uint16"),
        (f"{name}: None", lambda: call(None), TypeError, "raw: NoneType, expected"),
        (f"{name}: half", lambda: call(spoilt(RAW.astype(np.float64), 0.5)), ERROR, "raw: holds 0.5 at [31, 47], expected whole numbers from 0 to 65535; light from 0 to 1 becomes sensor values by np.rint("),
        (f"{name}: NaN", lambda: call(spoilt(RAW.astype(np.float32), np.nan)), ERROR, "raw: holds NaN at [31, 47], expected whole numbers"),
        (f"{name}: negative", lambda: call(spoilt(RAW.astype(np.int16), -1)), ERROR, "raw: holds -1 at [31, 47], expected whole numbers from 0 to 65535"),
        (f"{name}: 17 bits", lambda: call(spoilt(RAW.astype(">u4"), 65536)), ERROR, "raw: holds 65536 at [31, 47], expected whole numbers from 0 to 65535"),
        (f"{name}: 64 bits", lambda: call(spoilt(RAW.astype(np.uint64), 2**64 - 1)), ERROR, "raw: holds 18446744073709551615 at [31, 47], expected"),
        (f"{name}: bool", lambda: call(RAW > 0), TypeError, "raw: array of bool, expected uint16 or other numbers"),
        (f"{name}: complex", lambda: call(RAW.astype(np.complex64)), TypeError, "raw: array of complex64, expected uint16 or other numbers"),
        (f"{name}: 3 dimensions", lambda: call(RAW[None]), ERROR, "raw: 3 dimensions, expected 2"),
        (f"{name}: 1 dimension", lambda: call(RAW[0]), ERROR, "raw: 1 dimensions, expected 2"),
        (f"{name}: odd rows", lambda: call(RAW[1:]), ERROR, "31"),
        (f"{name}: odd columns", lambda: call(RAW[:, 1:]), ERROR, "47"),
        (f"{name}: empty", lambda: call(RAW[:0]), ERROR, "0"),
        (f"{name}: bit depth 7", lambda: call(RAW, bit_depth=7), ERROR, "bit_depth 7: must be 8 to 16"),
        (f"{name}: bit depth 17", lambda: call(RAW, bit_depth=17), ERROR, "bit_depth 17: must be 8 to 16"),
        (f"{name}: bit depth -1", lambda: call(RAW, bit_depth=-1), ERROR, "bit_depth -1: must be 8 to 16"),
        (f"{name}: bit depth huge", lambda: call(RAW, bit_depth=10**30), ERROR, "must be 8 to 16"),
        (f"{name}: bit depth float", lambda: call(RAW, bit_depth=12.0), TypeError, "bit_depth: float, expected a whole number"),
        (f"{name}: bit depth bool", lambda: call(RAW, bit_depth=True), TypeError, "bit_depth: bool, expected a whole number"),
        (f"{name}: value beyond depth", lambda: call(RAW, bit_depth=8), ERROR, "is 700, more than 8 bits can hold"),
        (f"{name}: phase", lambda: call(RAW, phase="rgbg"), ERROR, "rgbg"),
    ]


def picture_cases(name: str, argument: str, call: Callable[[Any], Any]) -> list[Case]:
    """Whatever takes a picture refuses the same."""
    return [
        (f"{name}: list", lambda: call([1.0]), TypeError, f"{argument}: list, expected a NumPy array of float32"),
        (f"{name}: uint8", lambda: call(np.zeros(LIGHT.shape, np.uint8)), TypeError, f"{argument}: array of uint8, expected float32, float64 or float16"),
        (f"{name}: beyond float32", lambda: call(spoilt(LIGHT.astype(np.float64), 1e39)), ERROR, f"{argument}: holds 1e39 at [2, 31, 47], expected numbers that float32 can hold"),
        (f"{name}: rows x columns x 3", lambda: call(LIGHT.transpose(1, 2, 0)), ERROR, f"{argument}: shape (32, 48, 3), expected 3 planes"),
        (f"{name}: empty", lambda: call(LIGHT[:, :0]), ERROR, f"{argument}: shape (3, 0, 48), expected 3 planes"),
        (f"{name}: NaN", lambda: call(spoilt(LIGHT, np.nan)), ERROR, f"{argument}: holds NaN at [2, 31, 47], expected finite"),
        (f"{name}: infinity", lambda: call(spoilt(LIGHT, np.inf)), ERROR, f"{argument}: holds inf at [2, 31, 47], expected finite"),
    ]


def cases() -> list[Case]:
    board = opened()
    found = [
        *raw_cases("reconstruct fixed", lambda raw, **how: edof.reconstruct(raw, NET, **how)),
        *raw_cases("reconstruct float", lambda raw, **how: edof.reconstruct(raw, FLOAT, **how)),
        *raw_cases("board_picture", lambda raw, **how: edof.board_picture(raw, NET, **how)),
        *raw_cases("words", lambda raw, **how: edof.words(raw, NET, **how)),
        *raw_cases("demosaic", lambda raw, **how: edof.demosaic(raw, **how)),
        *picture_cases("capture", "scene", lambda light: edof.capture(light, CAMERA, 1.0)),
        *picture_cases("Scene.flat", "light", lambda light: edof.Scene.flat(light, 1.0)),
        *picture_cases("encode", "picture", edof.encode),
        *picture_cases("quality", "truth", lambda light: edof.quality(light, LIGHT)),
        *picture_cases("psnr", "estimate", lambda light: edof.psnr(LIGHT, light)),
        *picture_cases("save_picture", "light", lambda light: edof.save_picture("/nowhere/x.png", light)),
        *picture_cases("quantize", "pictures[0]", lambda light: FLOAT.quantize([light])),
        # Cameras.
        ("Camera unknown", lambda: edof.Camera("ring-2019"), ERROR, "camera 'ring-2019': no such file, and not one of the presets"),
        ("Camera number", lambda: edof.Camera(3), TypeError, "name_or_path: int, expected the name of a preset"),
        ("Camera no JSON", lambda: edof.Camera.from_json("{"), ERROR, "not a camera"),
        ("Camera fields", lambda: edof.Camera.from_json(CAMERA.json().replace("ring-outer", "x").replace("focus_psi", "fokus")), ERROR, "not a camera"),
        ("Camera bank missing", lambda: edof.Camera("clear", psf_bank="nowhere.npz"), ERROR, "nowhere.npz"),
        ("with_psfs psi NaN", lambda: CAMERA.with_psfs(np.array([np.nan]), np.ones((1, 3, 3, 3), np.float32)), ERROR, "psi"),
        ("with_psfs descending", lambda: CAMERA.with_psfs(np.array([1.0, 0.0]), np.ones((2, 3, 3, 3), np.float32)), ERROR, "psi"),
        ("with_psfs shape", lambda: CAMERA.with_psfs(np.array([0.0]), np.ones((2, 3, 3, 3), np.float32)), ERROR, "psf"),
        ("with_psfs negative", lambda: CAMERA.with_psfs(np.array([0.0]), -np.ones((1, 3, 3, 3), np.float32)), ERROR, "-1"),
        ("with_psfs dark", lambda: CAMERA.with_psfs(np.array([0.0]), np.zeros((1, 3, 3, 3), np.float32)), ERROR, "psi 0"),
        ("with_psfs dtype", lambda: CAMERA.with_psfs(np.array([0.0]), np.ones((1, 3, 3, 3), np.int32)), TypeError, "psf: array of int32, expected float32, float64 or float16"),
        ("with_height_map oblong", lambda: CAMERA.with_height_map(PLANE, white_um=1.0, cauchy=(1.5, 0.0)), ERROR, "square height map"),
        ("with_height_map range", lambda: CAMERA.with_height_map(np.full((8, 8), 2, np.float32), white_um=1.0, cauchy=(1.5, 0.0)), ERROR, "heights: holds 2"),
        ("with_height_map high", lambda: CAMERA.with_height_map(np.ones((8, 8), np.float32), white_um=1e9, cauchy=(1.5, 0.0)), ERROR, "height"),
        ("with_aberrations index", lambda: CAMERA.with_aberrations({0: 10.0}), ERROR, "aberrations"),
        ("with_aberrations NaN", lambda: CAMERA.with_aberrations({5: float("nan")}), ERROR, "aberrations"),
        ("with_mask kind", lambda: CAMERA.with_mask([{"cubic": {}}]), ERROR, "unknown value `cubic`, expected one of `ring`"),
        ("with_mask ring", lambda: CAMERA.with_mask([{"ring": {"inner": 0.9, "outer": 0.5, "delay": {"phase": {"rad": 1, "at_nm": 500}}}}]), ERROR, "rings is 0.9 to 0.5"),
        ("with_mask object", lambda: CAMERA.with_mask([object()]), TypeError, "JSON"),  # type: ignore[list-item]
        ("psi_at 0 m", lambda: CAMERA.psi_at(0.0, nominal_m=10.0), ERROR, "metres 0: must be more than 0"),
        ("psi_at NaN", lambda: CAMERA.psi_at(float("nan"), nominal_m=10.0), ERROR, "metres NaN: must be more than 0"),
        ("psi_at unknown", lambda: CAMERA.psi_at(2.0), ERROR, "give nominal_m"),
        ("metres_at infinite", lambda: CAMERA.metres_at(float("inf"), nominal_m=10.0), ERROR, "psi inf: must be a finite number"),
        # Optics.
        ("psf NaN", lambda: edof.psf(CAMERA, float("nan")), ERROR, "psi NaN: must lie within 200"),
        ("psf far", lambda: edof.psf(CAMERA, 300.0), ERROR, "psi 300: must lie within 200"),
        ("psf text", lambda: edof.psf(CAMERA, "3"), TypeError, "must be real number, not str"),
        ("psf energy 0", lambda: edof.psf(CAMERA, 1.0, energy=0.0), ERROR, "energy 0: must be more than 0"),
        ("psf energy 2", lambda: edof.psf(CAMERA, 1.0, energy=2.0), ERROR, "energy 2: must be more than 0 and at most 1"),
        ("psf energy NaN", lambda: edof.psf(CAMERA, 1.0, energy=float("nan")), ERROR, "energy NaN"),
        ("psf tolerance", lambda: edof.psf(CAMERA, 1.0, wavelength_tolerance=-0.1), ERROR, "wavelength-tolerance -0.1: must be 0 or more"),
        ("psf camera", lambda: edof.psf(7, 1.0), TypeError, "camera: int, expected a Camera"),
        ("otf channel", lambda: edof.otf(CAMERA, 1.0, "cyan"), ERROR, "channel 'cyan': must be red, green or blue"),
        ("otf frequencies", lambda: edof.otf(CAMERA, 1.0, cycles_per_mm=np.array([-1.0])), ERROR, "cycles_per_mm: holds -1"),
        ("otf dtype", lambda: edof.otf(CAMERA, 1.0, cycles_per_mm=np.array([1j])), TypeError, "cycles_per_mm: array of complex128, expected float64 or other numbers"),
        ("mtf NaN", lambda: edof.mtf(CAMERA, 1.0, cycles_per_mm=np.array([np.nan])), ERROR, "cycles_per_mm: holds NaN"),
        ("sampled_otf even", lambda: edof.sampled_otf(KERNEL[:2, :2].copy(), np.array([0.1])), ERROR, "kernel 2x2: must be square with an odd side"),
        ("blur even kernel", lambda: edof.blur(PLANE, np.full((2, 2), 0.25, np.float32)), ERROR, "kernel 2x2: must be square with an odd side"),
        ("blur oblong kernel", lambda: edof.blur(PLANE, np.full((1, 3), 1 / 3, np.float32)), ERROR, "kernel 1x3: must be square with an odd side"),
        ("blur kernel sum", lambda: edof.blur(PLANE, 2 * KERNEL), ERROR, "kernel: sums to"),
        ("blur kernel NaN", lambda: edof.blur(PLANE, spoilt(KERNEL, np.nan)), ERROR, "kernel: holds NaN at [2, 2]"),
        ("blur kernel dtype", lambda: edof.blur(PLANE, np.ones((1, 1), np.uint8)), TypeError, "kernel: array of uint8, expected float32, float64 or float16"),
        ("blur NaN", lambda: edof.blur(spoilt(PLANE, np.nan), KERNEL), ERROR, "picture: holds NaN at [31, 47]"),
        ("blur empty", lambda: edof.blur(PLANE[:0], KERNEL), ERROR, "picture: shape [0, 48]"),
        ("blur 4 dimensions", lambda: edof.blur(LIGHT[None], KERNEL), ERROR, "picture: 4 dimensions, expected 2"),
        ("blur one kernel", lambda: edof.blur(LIGHT, KERNEL), ERROR, "kernel: one array, expected three"),
        ("blur two kernels", lambda: edof.blur(LIGHT, [KERNEL, KERNEL]), ERROR, "kernel: 2 arrays, expected three"),
        ("blur_adjoint sum", lambda: edof.blur_adjoint(PLANE, 0 * KERNEL), ERROR, "kernel: sums to 0"),
        ("blur_adjoint dtype", lambda: edof.blur_adjoint(RAW, KERNEL), TypeError, "picture: array of uint16, expected float32"),
        ("encode tone", lambda: edof.encode(LIGHT, "gamma"), ERROR, "gamma"),
        ("decode tone", lambda: edof.decode(LIGHT, "log"), ERROR, "log"),
        # Scenes and captures.
        ("capture psi missing", lambda: edof.capture(LIGHT, CAMERA), ERROR, "psi: expected a number"),
        ("capture psi twice", lambda: edof.capture(edof.Scene.flat(LIGHT, 1.0), CAMERA, 2.0), ERROR, "psi 2: the scene states its depths"),
        ("capture psi NaN", lambda: edof.capture(LIGHT, CAMERA, float("nan")), ERROR, "NaN"),
        ("capture psi far", lambda: edof.capture(LIGHT, CAMERA, 1000.0), ERROR, "psi 1000: must lie within 200"),
        ("capture odd", lambda: edof.capture(LIGHT[:, 1:], CAMERA, 1.0), ERROR, "31"),
        ("capture depth", lambda: edof.capture(LIGHT, CAMERA, 1.0, bit_depth=20), ERROR, "bit_depth 20: must be 8 to 16"),
        ("capture phase", lambda: edof.capture(LIGHT, CAMERA, 1.0, phase="xyzw"), ERROR, "xyzw"),
        ("capture noise", lambda: edof.capture(LIGHT, CAMERA, 1.0, noise=-0.1), ERROR, "-0.1"),
        ("capture noise NaN", lambda: edof.capture(LIGHT, CAMERA, 1.0, noise=float("nan")), ERROR, "NaN"),
        ("capture noise word", lambda: edof.capture(LIGHT, CAMERA, 1.0, noise="loud"), ERROR, "loud"),
        ("capture noise list", lambda: edof.capture(LIGHT, CAMERA, 1.0, noise=[1]), TypeError, "noise: list, expected a number"),
        ("capture seed", lambda: edof.capture(LIGHT, CAMERA, 1.0, seed=-1), ERROR, "seed -1: must be 0 to"),
        ("capture black", lambda: edof.capture(LIGHT, CAMERA, 1.0, black_level=4096), ERROR, "black level 4096: must be less than 4096"),
        ("capture depth tolerance", lambda: edof.capture(LIGHT, CAMERA, 1.0, depth_tolerance=float("nan")), ERROR, "depth-tolerance NaN: must be 0 or more"),
        ("from_depths shape", lambda: edof.Scene.from_depths(LIGHT, PLANE[1:].copy()), ERROR, "depth map 48x31: expected 48x32"),
        ("from_depths NaN", lambda: edof.Scene.from_depths(LIGHT, spoilt(PLANE, np.nan)), ERROR, "psi: holds NaN at [31, 47]"),
        ("from_depths layers", lambda: edof.Scene.from_depths(LIGHT, PLANE, layers=0), ERROR, "layers 0: must be 1 to 64"),
        ("from_layers none", lambda: edof.Scene.from_layers([]), ERROR, "has no layers"),
        ("from_layers item", lambda: edof.Scene.from_layers([LIGHT]), TypeError, "layers[0]: ndarray, expected (light, matte or None, psi)"),
        ("from_layers background", lambda: edof.Scene.from_layers([(LIGHT, PLANE, 0.0)]), ERROR, "its first layer has a matte"),
        ("from_layers matte", lambda: edof.Scene.from_layers([(LIGHT, None, 0.0), (LIGHT, PLANE * 4, 1.0)]), ERROR, "layers[1].matte: holds 2, expected 0 to 1"),
        ("from_layers size", lambda: edof.Scene.from_layers([(LIGHT, None, 0.0), (LIGHT, PLANE[2:].copy(), 1.0)]), ERROR, "layer 1 is 48x30"),
        ("from_layers psi", lambda: edof.Scene.from_layers([(LIGHT, None, float("inf"))]), ERROR, "layers[0].psi inf: must be a finite number"),
        ("draw kind", lambda: edof.Scene.draw("circle", 64, 64, psi=[0.0]), ERROR, "circle"),
        ("draw size", lambda: edof.Scene.draw("chart", 10, 64, psi=[0.0]), ERROR, "10"),
        ("draw depths", lambda: edof.Scene.draw("chart-4", 64, 64, psi=[0.0]), ERROR, "psi: 1 values, chart-4 has 4 depths"),
        ("draw without depths", lambda: edof.Scene.draw("chart", 64, 64), ERROR, "psi: give one value per depth"),
        # Networks.
        ("Network unknown", lambda: edof.Network.load("edof-t5"), ERROR, "weights 'edof-t5': no such file"),
        ("FixedNetwork unknown", lambda: edof.FixedNetwork.load("edof-t5"), ERROR, "weights 'edof-t5': no such file"),
        ("Network of a number", lambda: edof.Network.load(5), TypeError, "name_or_path: int, expected"),
        ("Network of another file", lambda: edof.Network.load(__file__), ERROR, "test_bad_arguments.py"),
        ("reconstruct network", lambda: edof.reconstruct(RAW, 3), TypeError, "network: int, expected a Network or FixedNetwork"),
        ("reconstruct unknown", lambda: edof.reconstruct(RAW, "nothing"), ERROR, "weights 'nothing': no such file"),
        ("reconstruct stride 3", lambda: edof.reconstruct(RAW, FLOAT, stride=3), ERROR, "stride 3: must be 2, 4 or 8"),
        ("reconstruct other stride", lambda: edof.reconstruct(RAW, NET, stride=2), ERROR, "stride 2: the network is quantized for a stride of 8"),
        ("reconstruct bit depth of a capture", lambda: edof.reconstruct(SHOT, NET, bit_depth=10), ERROR, "bit_depth 10: the capture states 12; leave bit_depth out"),
        ("reconstruct phase of a capture", lambda: edof.reconstruct(SHOT, NET, phase="bggr"), ERROR, "phase bggr: the capture states rggb; leave phase out"),
        ("reconstruct black of a capture", lambda: edof.reconstruct(SHOT, NET, black_level=64), ERROR, "black_level 64: the capture states 0; leave black_level out"),
        ("reconstruct camera", lambda: edof.reconstruct(RAW, NET, camera="nothing"), ERROR, "nothing"),
        ("reconstruct tiny frame", lambda: edof.reconstruct(RAW[:2, :2], NET), ERROR, "2x2"),
        ("reconstruct black", lambda: edof.reconstruct(RAW, NET, black_level=-1.0), ERROR, "black level '-1'"),
        ("reconstruct black NaN", lambda: edof.reconstruct(RAW, NET, black_level=float("nan")), ERROR, "black level"),
        ("reconstruct black three", lambda: edof.reconstruct(RAW, NET, black_level=[1.0, 2.0, 3.0]), TypeError, "black_level: list, expected a number, or four"),
        ("reconstruct white", lambda: edof.reconstruct(RAW, NET, white_level=0.0), ERROR, "white level 0: must be more than 0"),
        ("reconstruct white below black", lambda: edof.reconstruct(RAW, NET, black_level=80, white_level=70.0), ERROR, "black level 80: must be less than the white level"),
        ("sensor of another frame", lambda: edof.reconstruct(RAW, NET, sensor=SENSOR), ERROR, "with 16 bits, expected one of 48x32 of phase rggb with 12 bits"),
        ("sensor and black", lambda: edof.reconstruct(RAW, NET, sensor=SENSOR, black_level=1), ERROR, "black_level, white_level: the sensor states them"),
        ("sensor number", lambda: edof.reconstruct(RAW, NET, sensor=3), TypeError, "sensor: int, expected a Sensor, or the path"),
        ("sensor file", lambda: edof.Sensor.load(__file__), ERROR, "test_bad_arguments.py: not a whole safetensors file"),
        ("sensor of nothing", lambda: edof.Sensor.measure(), ERROR, "dark, flat: no frames"),
        ("sensor of no frame", lambda: edof.Sensor.measure(RAW[None][:0]), ERROR, "dark: no frames, expected at least one"),
        ("sensor of one frame", lambda: edof.Sensor.measure(RAW), ERROR, "dark: 2 dimensions, expected 3"),
        ("sensor dark and black", lambda: edof.Sensor.measure(RAW[None], black_level=3), ERROR, "black_level: dark frames state it"),
        ("sensor hot", lambda: edof.Sensor.measure(RAW[None], hot=0.0), ERROR, "hot 0: must be more than 0"),
        ("sensor defect", lambda: edof.Sensor.measure(RAW[None], columns=[48]), ERROR, "defective column 48: outside of frames of 48x32"),
        ("sensor dark flat", lambda: edof.Sensor.measure(flat=RAW[None]), ERROR, "flat frames: the light of red is 1.1 % of full scale"),
        ("words of a float network", lambda: edof.words(RAW, FLOAT), TypeError, "network: Network, expected a FixedNetwork"),
        ("board display", lambda: edof.board_picture(RAW, NET, display="grey"), ERROR, "grey"),
        ("board curve", lambda: edof.board_picture(RAW, NET, curve="log"), ERROR, "curve 'log': must be linear, srgb or bt709"),
        ("forward shape", lambda: FLOAT.forward(np.zeros((2, 9), np.float32)), ERROR, "windows: shape (2, 9), expected (1 or more, 144)"),
        ("forward none", lambda: FLOAT.forward(np.zeros((0, 144), np.float32)), ERROR, "windows: shape (0, 144)"),
        ("forward NaN", lambda: FLOAT.forward(np.full((1, 144), np.nan, np.float32)), ERROR, "windows: holds NaN at [0, 0]"),
        ("from_arrays form", lambda: edof.Network.from_arrays("w9", {}, camera=CAMERA), ERROR, "window 9: must be 8, 12 or 16"),
        ("from_arrays missing", lambda: edof.Network.from_arrays("w8,t2", {}, camera=CAMERA), ERROR, "arrays: 'thresholds' is missing"),
        ("from_arrays unknown", lambda: edof.Network.from_arrays("w8,t2", {"bias": PLANE}, camera=CAMERA), ERROR, "arrays: 'bias' is none of"),
        ("from_arrays camera", lambda: edof.Network.from_arrays("w8,t2", {}), ERROR, "camera: give one"),
        ("from_arrays shape", lambda: edof.Network.from_arrays(FLOAT.form, {**FLOAT.arrays(), "analysis": PLANE}, like=FLOAT), ERROR, "analysis: 32x48, this form needs"),
        ("from_arrays NaN", lambda: edof.Network.from_arrays(FLOAT.form, {**FLOAT.arrays(), "dictionary": spoilt(FLOAT.arrays()["dictionary"], np.nan)}, like=FLOAT), ERROR, "dictionary: holds NaN"),
        ("quantize bits", lambda: FLOAT.quantize([LIGHT], bits=7), ERROR, "bits 7: must be 8 to 16"),
        ("quantize stride", lambda: FLOAT.quantize([LIGHT], stride=5), ERROR, "stride 5: must be 2, 4 or 8"),
        ("quantize headroom", lambda: FLOAT.quantize([LIGHT], headroom=0.5), ERROR, "headroom 0.5: must be 1 or more"),
        ("quantize overlap", lambda: FLOAT.quantize([LIGHT], overlap="box"), ERROR, "overlap 'box': must be hann or flat"),
        ("quantize none", lambda: FLOAT.quantize([]), ERROR, "pictures: none, expected one at least"),
        ("quantize odd", lambda: FLOAT.quantize([LIGHT[:, 1:]]), ERROR, "31"),
        ("save nowhere", lambda: NET.save("/proc/x.fixed.safetensors"), ERROR, "/proc/x.fixed.safetensors"),
        ("train field", lambda: edof.train("w8,t2", [LIGHT], CAMERA, recipe={"stepz": 3}), ERROR, "recipe: 'stepz' is no field"),
        ("train value", lambda: edof.train("w8,t2", [LIGHT], CAMERA, recipe={"batch": 7}), ERROR, "batch 7: must be a positive multiple of 8"),
        ("train small", lambda: edof.train("w8,t2", [LIGHT], CAMERA), ERROR, "training photo 0: 48x32"),
        ("train nothing", lambda: edof.train("w8,t2", [], CAMERA), ERROR, "training photos: none given"),
        ("train threads", lambda: edof.train("w8,t2", [LIGHT], CAMERA, threads=0), ERROR, "threads 0: must be 1 to 256"),
        ("train psi", lambda: edof.train("w8,t2", [LIGHT], CAMERA, psi=[]), ERROR, "psi: no value given"),
        ("cycles windows", lambda: TINY.cycles(SMALL, np.zeros((1, 9), np.int16)), ERROR, "windows: shape (1, 9), expected (1 or more, 64)"),
        ("cycles negative", lambda: TINY.cycles(SMALL, np.full((1, 64), -1, np.int16)), ERROR, "windows: holds -1, expected 0 to 32767"),
        ("cycles misfit", lambda: TINY.cycles(NET, np.zeros((1, 64), np.int16)), ERROR, "does not fit design tiny"),
        ("stall_pattern share", lambda: edof.stall_pattern(10, stalled=256), ERROR, "stalled 256: must be 0 to 255"),
        ("uartbone_read none", lambda: edof.uartbone_read(0, 0), ERROR, "words 0: must be 1 to 255"),
        ("uartbone_write none", lambda: edof.uartbone_write(0, []), ERROR, "words: 0 of them, must be 1 to 255"),
        # Pictures.
        ("load_picture missing", lambda: edof.load_picture("/nowhere/x.png"), ERROR, "/nowhere/x.png"),
        ("load_picture text", lambda: edof.load_picture(__file__), ERROR, "test_bad_arguments.py"),
        ("save_picture bits", lambda: edof.save_picture("/tmp/x.png", LIGHT, bits=12), ERROR, "12 bits a sample: must be 8 or 16"),
        ("save_picture curve", lambda: edof.save_picture("/tmp/x.png", LIGHT, curve="log"), ERROR, "curve 'log'"),
        ("save_picture ending", lambda: edof.save_picture("/tmp/x.xyz", LIGHT), ERROR, "x.xyz"),
        ("quality sizes", lambda: edof.quality(LIGHT, LIGHT[:, 2:]), ERROR, "must be equally large"),
        ("quality border", lambda: edof.quality(LIGHT, LIGHT, border=14), ERROR, "to crop 14 pixels"),
        ("quality tone", lambda: edof.quality(LIGHT, LIGHT, tone="log"), ERROR, "tone 'log': must be linear or srgb"),
        ("psnr sizes", lambda: edof.psnr(LIGHT, LIGHT[:, 2:]), ERROR, "estimate: (30, 48) pixels, expected (32, 48)"),
        ("psnr border", lambda: edof.psnr(LIGHT, LIGHT, border=16), ERROR, "border 16: leaves nothing"),
        # What people use instead.
        ("demosaic method", lambda: edof.demosaic(RAW, method="ahd"), ERROR, "method 'ahd': must be malvar or directional"),
        ("wiener NaN", lambda: edof.wiener(spoilt(PLANE, np.nan), KERNEL), ERROR, "plane: holds NaN at [31, 47]"),
        ("wiener empty", lambda: edof.wiener(PLANE[:, :0], KERNEL), ERROR, "plane: shape [32, 0]"),
        ("omp empty", lambda: edof.omp(SIGNALS[:, :0], ATOMS[:0], atoms=1), ERROR, "dictionary: shape (0, 6)"),
        ("with_psfs empty", lambda: CAMERA.with_psfs(np.zeros(0), np.ones((0, 3, 3, 3), np.float32)), ERROR, "psi"),
        ("wiener weight", lambda: edof.wiener(PLANE, KERNEL, noise_to_contrast=0.0), ERROR, "noise_to_contrast 0: must be more than 0"),
        ("wiener kernel", lambda: edof.wiener(PLANE, KERNEL[:2]), ERROR, "kernel 2x3: must have odd sides"),
        ("richardson_lucy steps", lambda: edof.richardson_lucy(PLANE, KERNEL, steps=-3), ERROR, "steps -3: must be 0 to"),
        ("richardson_lucy empty", lambda: edof.richardson_lucy(PLANE[:0], KERNEL), ERROR, "plane: shape [0, 48]"),
        ("hyper_laplacian alpha", lambda: edof.hyper_laplacian(PLANE, KERNEL, alpha=1.5), ERROR, "alpha 1.5: must be at most 1"),
        ("hyper_laplacian weight", lambda: edof.hyper_laplacian(PLANE, KERNEL, weight=-1.0), ERROR, "weight -1: must be more than 0"),
        ("blind side even", lambda: edof.blind_deconvolution(PLANE, side=4), ERROR, "side 4: must be odd"),
        ("blind side large", lambda: edof.blind_deconvolution(PLANE, side=999), ERROR, "side 999: must be 3 to 255"),
        ("omp shape", lambda: edof.omp(SIGNALS, ATOMS[:5], atoms=1), ERROR, "dictionary: shape (5, 6), expected (6, 1 or more)"),
        ("omp NaN", lambda: edof.omp(spoilt(SIGNALS, np.nan), ATOMS, atoms=1), ERROR, "signals: holds NaN at [3, 5]"),
        ("omp residual", lambda: edof.omp(SIGNALS, ATOMS, atoms=1, residual=-1.0), ERROR, "residual -1: must be 0 or more"),
        ("omp atoms", lambda: edof.omp(SIGNALS, ATOMS, atoms="1"), TypeError, "atoms: str, expected a whole number"),
        ("lasso penalty", lambda: edof.lasso(SIGNALS, ATOMS, -1.0), ERROR, "penalty: holds -1"),
        ("lasso penalties", lambda: edof.lasso(SIGNALS, ATOMS, np.ones(5, np.float32)), ERROR, "penalty: 5 numbers, expected 6"),
        ("lasso method", lambda: edof.lasso(SIGNALS, ATOMS, 1.0, method="admm"), ERROR, "method 'admm': must be fista or ista"),
        ("ksvd atoms", lambda: edof.ksvd(SIGNALS, ATOMS, atoms=0, rounds=1), ERROR, "atoms 0: must be 1 to"),
        # Designs and boards.
        ("Design unknown", lambda: edof.Design("huge"), ERROR, "design 'huge': no such file"),
        ("Design text", lambda: edof.Design.from_json("[]"), ERROR, "design"),
        ("estimate misfit", lambda: TINY.estimate(NET, RAW), ERROR, "does not fit design tiny"),
        ("estimate without frames", lambda: TINY.estimate(SMALL), ERROR, "raw: expected raw frames"),
        ("estimate without network", lambda: TINY.estimate(None, RAW), ERROR, "network: expected one"),
        ("explore fps", lambda: TINY.explore(SMALL, RAW, fps=0.0), ERROR, "fps 0: must be more than 0"),
        ("explore no frames", lambda: TINY.explore(SMALL, []), ERROR, "raw: no frames"),
        ("generate misfit", lambda: TINY.generate(NET, "/tmp/never"), ERROR, "does not fit design tiny"),
        ("Board port", lambda: edof.Board.open("/nowhere/tty"), ERROR, "/nowhere/tty"),
        ("Board timeout", lambda: edof.Board.open("/dev/null", timeout=0.0), ERROR, "timeout 0: must be above 0"),
        ("Board baud", lambda: edof.Board.open("/dev/null", baud=0), ERROR, "baud 0: must be 1 to"),
        ("Board no port", lambda: edof.Board.open("/dev/null"), ERROR, "/dev/null"),
        ("Board raw", lambda: edof.Board.simulated(TINY, SMALL, RAW[:, :-2]), ERROR, "as the design's frame"),
        ("Board register", lambda: board.get("nothing"), ERROR, "register 'nothing': there is none"),
        ("Board field", lambda: board.get("control.nothing"), ERROR, "control has the fields"),
        ("Board word", lambda: board.get("stage_counters[9999]"), ERROR, "must be a word from 0 to"),
        ("Board read only", lambda: board.set("id", 1), ERROR, "register 'id': can only be read"),
        ("Board value", lambda: board.set("scratch", 2**32), ERROR, "value 4294967296: must be 0 to 4294967295"),
        ("Board bank", lambda: board.load(SMALL, bank="c"), ERROR, "bank 'c': must be a or b"),
        ("Board misfit", lambda: board.load(NET), ERROR, "does not fit design tiny"),
        ("Board seconds", lambda: board.run(-1.0), ERROR, "seconds -1: must be more than 0"),
    ]
    calls: list[tuple[str, Callable[[edof.Board], Any]]] = [
        ("get", lambda b: b.get("scratch")),
        ("set", lambda b: b.set("scratch", 1)),
        ("registers", lambda b: b.registers()),
        ("load", lambda b: b.load(SMALL)),
        ("verify", lambda b: b.verify(SMALL)),
        ("bank", lambda b: b.bank),
        ("reset", lambda b: b.reset()),
        ("run", lambda b: b.run(0.01)),
        ("screen", lambda b: b.screen()),
        ("shape", lambda b: b.shape),
        ("design", lambda b: b.design),
    ]
    for name, call in calls:
        found.append((f"closed board: {name}", lambda call=call: call(closed()), ERROR, "board: closed"))
    return found


CASES = cases()


def test_the_table_is_long() -> None:
    names = [name for name, *_ in CASES]
    assert len(names) == len(set(names)) >= 120


@pytest.mark.parametrize("call,kind,text", [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_bad_argument_raises_one_clear_exception(call: Callable[[], Any], kind: type[Exception], text: str) -> None:
    with pytest.raises(Exception) as caught:
        call()
    assert caught.type is kind, caught.value
    message = str(caught.value)
    assert text in message
    assert "\n" not in message and 8 < len(message) < 500


def test_nothing_was_written_for_bad_arguments() -> None:
    assert not Path("/tmp/never").exists()
