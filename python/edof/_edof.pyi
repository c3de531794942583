"""What every class and function takes and gives.

Raw frames are uint16 arrays (rows x columns) of sensor values 0 to 2^bit_depth - 1, both sides even. Pictures are float32 arrays
(3 x rows x columns: red, green, blue) of linear light, full scale 1; planes are one of the three. Arrays may have any strides. Arrays of
these types are read in place. Others are converted by a copy: raw frames from any integers or whole floats, pictures from float64 or
float16, in any byte order; a number that does not fit raises EdofError. A Capture may be passed as a raw frame: it states its bit depth,
phase (else rggb), black level and camera, and arguments that contradict it are rejected. Depths are psi, the defocus parameter in radians at the camera's
reference wavelength (docs/your-own-lens.md). Whatever cannot be used raises EdofError with the program's one line, a value of another type
TypeError.
"""

from os import PathLike
from types import TracebackType
from typing import Any, Literal, Optional, Sequence, SupportsIndex, Union, final

import numpy as np
from numpy.typing import NDArray

__version__: str

_Path = Union[str, PathLike[str]]
_Camera = Union[Camera, _Path]
_Design = Union[Design, _Path]
_Net = Union[Network, FixedNetwork, _Path]
_Fixed = Union[FixedNetwork, _Path]
_Raw = NDArray[np.uint16]
_Sensor = Union[Sensor, _Path]
_Light = NDArray[np.float32]
# What is converted to them.
_Numbers = NDArray[Union[np.integer[Any], np.floating[Any]]]
_Floats = NDArray[np.floating[Any]]
# A raw frame.
_Frame = Union[Capture, _Numbers]

class EdofError(ValueError):
    """Something was rejected or failed; one line says what, where, and what would have been right."""

@final
class Camera:
    """A lens, its phase mask and a sensor (crate edof_core::camera).

    `Camera("ring-outer")`: a preset. `Camera("mine.json", psf_bank="measured.npz")`: a JSON file, with measured PSFs in place of computed
    ones; `centre` shifts them by one displacement so that the mean of their centroids is the middle pixel. Fields are described in docs/your-own-lens.md.
    """

    def __new__(cls, name_or_path: Optional[_Path] = None, *, psf_bank: Optional[_Path] = None, centre: bool = False) -> Camera: ...
    @staticmethod
    def presets() -> list[str]:
        """Names of the cameras that come with edof."""

    @staticmethod
    def from_json(text: str, *, folder: Optional[_Path] = None) -> Camera:
        """A camera from JSON text; files that it names are looked for in `folder` (default: the working directory)."""

    def json(self) -> str:
        """JSON text that `from_json` reads back."""

    def with_psfs(self, psi: _Numbers, psf: _Floats, *, name: str = "array") -> Camera:
        """The camera with a PSF bank: psi ascending (depths), psf (depths x 3 x rows x columns), 0 or more, each scaled to sum 1."""

    def with_height_map(
        self, heights: NDArray[np.float32], *, white_um: float, cauchy: tuple[float, float], name: str = "array"
    ) -> Camera:
        """The camera with a mask of that surface: square, 2 to 4096 a side, heights 0 to 1 in units of `white_um` micrometres; the glass
        has n = cauchy[0] + cauchy[1] / wavelength^2 (micrometres)."""

    def with_aberrations(self, rms_nm: dict[int, float]) -> Camera:
        """The camera with these Zernike terms (Noll's index: root mean square of the optical path in nanometres) in place of its own."""

    def with_focus(self, psi: float) -> Camera:
        """The camera focused at `psi`: a camera of each exposure of a scene, say."""

    def with_mask(self, terms: list[dict[str, object]]) -> Camera:
        """The camera with these terms as its mask, each as in the list `mask` of a camera file: {"ring": {...}}, {"polynomial": {...}}, ....
        Pictures of height maps are looked for in the working directory."""

    def psi_at(self, metres: float, *, nominal_m: Optional[float] = None) -> float:
        """psi of an object at a distance; psi is 0 at `nominal_m` (default: the camera's)."""

    def metres_at(self, psi: float, *, nominal_m: Optional[float] = None) -> Optional[float]:
        """Distance of an object at `psi`; None beyond infinity."""

    def same_lens(self, other: _Camera) -> bool:
        """Whether a network for one serves the other, too."""

    @property
    def name(self) -> str:
        """Short name, as in ring-2018."""

    @property
    def psi_range(self) -> tuple[float, float]:
        """Range of psi that the camera is meant for."""

    @property
    def f_number(self) -> float:
        """Focal length over aperture diameter."""

    @property
    def pixel_pitch_um(self) -> float:
        """Distance between pixels in micrometres."""

    @property
    def nominal_m(self) -> Optional[float]:
        """Distance in metres at which psi is 0, where the camera knows it."""

    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Scene:
    """Layers of light at depths, from back to front (edof_optics::scene)."""

    @staticmethod
    def flat(light: _Floats, psi: float) -> Scene:
        """A picture at one depth."""

    @staticmethod
    def from_depths(light: _Floats, psi: _Floats, *, layers: Optional[SupportsIndex] = None) -> Scene:
        """A picture whose pixels lie at `psi` (rows x columns), cut into at most `layers` (1 to 64, default 16); nearer things have larger psi."""

    @staticmethod
    def from_layers(layers: Sequence[tuple[_Floats, Optional[_Floats], float]]) -> Scene:
        """Layers (light, matte, psi), the background, whose matte is None, first. Mattes (rows x columns) are 0 to 1; light is multiplied by them."""

    @staticmethod
    def draw(
        kind: str,
        rows: SupportsIndex,
        columns: SupportsIndex,
        *,
        psi: Optional[Sequence[float]] = None,
        camera: Optional[_Camera] = None,
        seed: Optional[SupportsIndex] = None,
    ) -> Scene:
        """chart, chart-4, leaves or leaves-4, drawn as light, 64 pixels a side at least; depths are `psi`, or spread over the camera's range."""

    def sharp(self) -> _Light:
        """The light without a lens."""

    def psi_map(self) -> NDArray[np.float32]:
        """psi of what is seen at each pixel (rows x columns)."""

    @property
    def psi(self) -> list[float]:
        """psi of each layer."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""

@final
class Capture:
    """A raw frame, and how it was taken. Functions of raw frames take it as it is."""

    @property
    def raw(self) -> _Raw:
        """Sensor values, rows x columns."""

    @property
    def light(self) -> _Light:
        """The light on the sensor before its colour filters."""

    @property
    def bit_depth(self) -> int:
        """Bits of the sensor."""

    @property
    def phase(self) -> str:
        """Colour filters of the first 2x2 pixels, as in rggb."""

    @property
    def black_level(self) -> int:
        """Sensor value of no light."""

    @property
    def camera(self) -> Camera:
        """The camera that took it."""

    @property
    def kernels(self) -> list[dict[str, Any]]:
        """Depths that were computed, and what cutting each kernel left."""

    @property
    def seconds(self) -> float:
        """Wall-clock seconds for PSFs and blur."""

@final
class Network:
    """A float network (crates edof-network and edof_network::float)."""

    @staticmethod
    def load(name_or_path: _Path) -> Network:
        """A network by name, such as edof-t4w12-outer, or from a weight file."""

    @staticmethod
    def names() -> list[str]:
        """Names of the networks that come with edof."""

    @staticmethod
    def from_arrays(
        form: str,
        arrays: dict[str, Any],
        *,
        camera: Optional[_Camera] = None,
        name: str = "array",
        like: Optional[Network] = None,
    ) -> Network:
        """A network of `form` (words as --form takes them: one-sided,w12,t4,c192,r) from float32 arrays, as `arrays` gives them; for a camera, or
        trained as another network was."""

    def arrays(self) -> dict[str, NDArray[np.float32]]:
        """analysis (codes x pixels), thresholds (layers - 1 x codes), recurrent (matrices x codes x codes), dictionary (192 x codes), linear_path
        (192 x pixels); the last and recurrent only where the form has them."""

    def forward(self, windows: _Floats) -> NDArray[np.float32]:
        """Windows (count x pixels, row by row, 0 to 1; of several exposures one window after the other) to patches (count x 192: red, green, blue, each 8x8): light, or encoded light (`values`)."""

    def save(self, path: _Path) -> None:
        """Writes a weight file, whole or not at all."""

    def quantize(
        self,
        pictures: Optional[Sequence[_Floats]] = None,
        *,
        bits: Optional[SupportsIndex] = None,
        stride: Optional[SupportsIndex] = None,
        overlap: str = "hann",
        headroom: float = 2.0,
    ) -> FixedNetwork:
        """The integers of the board: `bits` 8 to 16 (default 16), `stride` 2, 4 or 8 (default 8), overlap hann or flat, headroom 1 or more. Ranges are
        measured on `pictures` as files hold them (0 to 1, encoded as the network's conditions say; default: drawn leaves). As `edof quantize`."""

    @property
    def name(self) -> str:
        """Name of the network."""

    @property
    def form(self) -> str:
        """Architecture in words."""

    @property
    def camera(self) -> Camera:
        """The camera that it was trained for; of several exposures, that of the first."""

    @property
    def foci(self) -> list[float]:
        """psi at which each exposure of a scene is focused, in the order in which `reconstruct` takes them; one, unless its form has several."""

    @property
    def window(self) -> int:
        """Side of its windows in pixels."""

    @property
    def sha256(self) -> str:
        """Of its weight file; of a network that was made here, of its weights."""

    @property
    def values(self) -> str:
        """What `forward` and the windows' words stand for: linear (light), or srgb (light encoded by `encode`). Frames hold light; `reconstruct`
        converts."""

@final
class FixedNetwork:
    """A network in integers (docs/contract.md)."""

    @staticmethod
    def load(name_or_path: _Path) -> FixedNetwork:
        """A quantized network by name, or from a weight file."""

    @staticmethod
    def names() -> list[str]:
        """Names of the networks that come with edof."""

    def arrays(self) -> dict[str, NDArray[np.int16]]:
        """As those of a float network, in words; the dictionary and the linear path give 4:2:2 (128 rows)."""

    def save(self, path: _Path) -> None:
        """Writes a weight file, whole or not at all."""

    @property
    def name(self) -> str:
        """Name of the float network."""

    @property
    def form(self) -> str:
        """Architecture in words."""

    @property
    def camera(self) -> Camera:
        """The camera that it was trained for."""

    @property
    def window(self) -> int:
        """Side of its windows in pixels."""

    @property
    def stride(self) -> int:
        """Pixels from one patch to the next."""

    @property
    def values(self) -> str:
        """What `forward` and the windows' words stand for: linear (light), or srgb (light encoded by `encode`). Frames hold light; `reconstruct`
        converts."""

    @property
    def code_bits(self) -> int:
        """Bits of every weight and code."""

    @property
    def fractions(self) -> dict[str, Any]:
        """Fraction bits of each matrix and of the codes of each layer."""

@final
class BoardPicture:
    """What the board makes of a frame: the codes at its HDMI port (docs/contract.md, section 7)."""

    @property
    def y_code(self) -> NDArray[np.uint8]:
        """Luma, rows x columns."""

    @property
    def cb_code(self) -> NDArray[np.uint8]:
        """Cb, rows x columns / 2."""

    @property
    def cr_code(self) -> NDArray[np.uint8]:
        """Cr, rows x columns / 2."""

    @property
    def counters(self) -> dict[str, Any]:
        """Patches, saturations, non-zeros of each layer, clamped chroma and colours out of gamut."""

    def yuyv(self) -> NDArray[np.uint8]:
        """The bytes Y Cb Y Cr of each two pixels, as in FILE.yuyv of `edof reconstruct --board`."""

    def shown(self) -> _Light:
        """What a screen shows: encoded numbers, 0 to 1."""

@final
class Sensor:
    """Correction of a sensor: offsets, shading and defective pixels (docs/sensor.md)."""

    @staticmethod
    def load(path: _Path) -> Sensor:
        """A sensor file, as `edof sensor` writes it."""

    @staticmethod
    def measure(
        dark: Optional[_Numbers] = None,
        flat: Optional[_Numbers] = None,
        *,
        bit_depth: Optional[SupportsIndex] = None,
        phase: str = "rggb",
        black_level: Union[float, Sequence[float], None] = None,
        white_level: Optional[float] = None,
        hot: Optional[float] = None,
        dead: Optional[float] = None,
        pixels: Sequence[Sequence[int]] = ...,
        columns: Sequence[int] = ...,
        rows: Sequence[int] = ...,
    ) -> Sensor:
        """From dark and flat frames (frames x rows x columns each; one of both may be left out) and known defects, as `edof sensor` does. `black_level`: where
        there are no dark frames. `hot`: standard deviations of the noise (default 6); `dead`: part of the response to light (default
        0.15); `pixels`: row and column of each."""

    def save(self, path: _Path) -> None:
        """Writes a sensor file."""

    def light(self, raw: _Numbers) -> _Raw:
        """Sensor values as light of 16 bits, as `sensor=` of other functions sees them: offsets taken off, shading made up for, defects repaired."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of its frames."""

    @property
    def phase(self) -> str:
        """Colour filter of the first 2x2 pixels."""

    @property
    def bit_depth(self) -> int:
        """Bits of a sensor value."""

    @property
    def defects(self) -> NDArray[np.bool_]:
        """True where a pixel is repaired."""

    @property
    def report(self) -> Any:
        """What was found, as `edof sensor --json` has it; None of a file."""

@final
class Design:
    """A calculator and the board around it (crates edof-device, edof-hdl). `Design("kc705")`, or a JSON file."""

    def __new__(cls, name_or_path: _Design) -> Design: ...
    @staticmethod
    def names() -> list[str]:
        """Names of the designs that come with edof."""

    @staticmethod
    def from_json(text: str) -> Design:
        """A design from JSON text, checked."""

    def json(self) -> str:
        """JSON text that `from_json` reads back."""

    def estimate(
        self,
        network: Optional[_Fixed] = None,
        raw: Union[_Frame, Sequence[_Frame], None] = None,
        *,
        bit_depth: Optional[SupportsIndex] = None,
        phase: Optional[str] = None,
    ) -> dict[str, Any]:
        """Cycles per patch, frames per second and cells, as `edof estimate --json`; with a network, measured on raw frames."""

    def explore(
        self,
        network: _Fixed,
        raw: Union[_Frame, Sequence[_Frame]],
        *,
        bit_depth: Optional[SupportsIndex] = None,
        phase: Optional[str] = None,
        fps: float = 60.0,
    ) -> list[dict[str, Any]]:
        """Foldings of the network that fit an XC7K325T and that nothing beats in cycles, multipliers and block RAM; slower ones than `fps` only where
        none is as fast."""

    def generate(self, network: _Fixed, out: _Path, *, force: bool = False) -> dict[str, Any]:
        """Writes the sources of a bitstream into a folder, as `edof generate`; gives the manifest."""

    def cycles(
        self,
        network: _Fixed,
        windows: _Numbers,
        *,
        seed: Optional[SupportsIndex] = None,
        stalled: Optional[SupportsIndex] = None,
    ) -> list[dict[str, Any]]:
        """What passes every boundary of the generated chain, and when: for windows (count x pixels, words 0 to 32767) one dict per boundary with its name
        (`boundary`), the stage that sends (`stage`), and of each beat the patch, the cycle (0 the first after reset), `last`, its two `words` (int16), and its two
        `base` words where an M stage takes them. Both ends stall as `stall_pattern` says."""

    def random_network(self, seed: int = 1) -> FixedNetwork:
        """A network of random words that fits the design, to try hardware with."""

    @property
    def name(self) -> str:
        """Short name, as in kc705."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of its frames."""

    @property
    def clock_mhz(self) -> float:
        """Planned clock of the calculator."""

@final
class Board:
    """A board at a serial port (docs/host.md), or a simulated one in memory. A context manager."""

    @staticmethod
    def open(port: _Path, *, baud: Optional[SupportsIndex] = None, timeout: Optional[float] = None) -> Board:
        """The board at a port; `timeout` is extra response time in seconds, above 0, at most 3600, default 0.25."""

    @staticmethod
    def simulated(
        design: _Design,
        network: _Fixed,
        raw: _Frame,
        *,
        bit_depth: Optional[SupportsIndex] = None,
        phase: Optional[str] = None,
        baud: Optional[SupportsIndex] = None,
    ) -> Board:
        """A board in memory whose banks start with `network` and whose camera sends `raw` (of the design's size) again and again."""

    @staticmethod
    def ports() -> list[str]:
        """Serial ports of this machine."""

    def get(self, register: str) -> int:
        """The value of a register, field or word: scratch, control.run, stage_counters[4]."""

    def set(self, register: str, value: SupportsIndex) -> None:
        """Gives a register a value of 32 bits."""

    def registers(self) -> dict[str, int]:
        """All registers by name."""

    def load(
        self,
        network: _Fixed,
        *,
        bank: Optional[str] = None,
        full: bool = False,
        read_back: bool = False,
        design: Optional[_Design] = None,
    ) -> dict[str, Any]:
        """Loads a network into the idle bank, verifies it by the circuit's CRCs, and has it used; with `bank` (a or b) into that one alone."""

    def verify(
        self, network: _Fixed, *, bank: Optional[str] = None, read_back: bool = False, design: Optional[_Design] = None
    ) -> list[dict[str, Any]]:
        """Parts of a bank (default: the one in use) that are not the network's; empty where all are right."""

    @property
    def bank(self) -> str:
        """The bank in use, a or b."""

    def reset(self) -> None:
        """Begins anew with the bank in use; weights stay."""

    def run(self, seconds: float) -> None:
        """Lets a simulated board run for so many seconds of its time (at most 60)."""

    def screen(self) -> Optional[tuple[NDArray[np.uint8], NDArray[np.uint8]]]:
        """The last whole picture of a simulated board: Y, and C with Cb and Cr in turn, rows x columns each; None before the first."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of its frames."""

    @property
    def design(self) -> Design:
        """The design that the board states, of those that come with edof."""

    @property
    def closed(self) -> bool:
        """Whether it was closed."""

    def close(self) -> None:
        """Closes the line; every further call raises EdofError."""

    def __enter__(self) -> Board: ...
    def __exit__(
        self,
        _type: Optional[type[BaseException]],
        _value: Optional[BaseException],
        _traceback: Optional[TracebackType],
    ) -> None: ...

def psf(
    camera: _Camera, psi: float, *, energy: float = 0.999, wavelength_tolerance: float = 0.01, exact: bool = False
) -> tuple[_Light, _Light, _Light]:
    """Kernels of red, green and blue at `psi`: square, odd sides, sum 1. `energy`: share that a cut kernel keeps, above 0, at most 1.
    `wavelength_tolerance`: share that may lie wrong because few wavelengths are summed. As psf.npz of `edof optics`."""

def otf(
    camera: _Camera,
    psi: float,
    channel: str = "green",
    *,
    cycles_per_mm: Optional[_Numbers] = None,
    pixel: bool = False,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies in cycles per millimetre (default: the samples of the computation) and contrast along a row, -1 to 1, of the lens alone or with
    its pixels. Negative values are reversed contrast."""

def mtf(
    camera: _Camera,
    psi: float,
    channel: str = "green",
    *,
    cycles_per_mm: Optional[_Numbers] = None,
    pixel: bool = False,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The magnitude of `otf`."""

def sampled_otf(kernel: _Floats, cycles_per_pixel: _Numbers) -> NDArray[np.complex128]:
    """Fourier transform of a kernel as pixels sample it, about its middle: along a row and along a column (2 x frequencies)."""

def blur(picture: _Floats, kernel: Union[_Floats, Sequence[_Floats]]) -> _Light:
    """A plane blurred with a kernel (square, odd side, sum 1), or a picture with three; borders mirrored."""

def blur_adjoint(picture: _Floats, kernel: Union[_Floats, Sequence[_Floats]]) -> _Light:
    """The adjoint: <blur(x), y> = <x, blur_adjoint(y)>."""

def encode(picture: _Floats, tone: str = "srgb") -> _Light:
    """Light as a picture's numbers; tone srgb or linear."""

def decode(picture: _Floats, tone: str = "srgb") -> _Light:
    """A picture's numbers as light."""

def capture(
    scene: Union[Scene, _Floats],
    camera: _Camera,
    psi: Optional[float] = None,
    *,
    bit_depth: Optional[SupportsIndex] = None,
    phase: str = "rggb",
    noise: Union[str, float, None] = None,
    seed: Optional[SupportsIndex] = None,
    black_level: Optional[SupportsIndex] = None,
    energy: float = 0.999,
    wavelength_tolerance: float = 0.01,
    depth_tolerance: float = 0.0,
    exact: bool = False,
) -> Capture:
    """The raw frame that a camera gives of a scene, or of a picture at `psi`. `bit_depth`: bits of the sensor, 8 to 16 (default 12). `noise`: standard
    deviation in units of full scale, or a word such as sensor:gain=4. The same seed gives the same noise. As `edof capture`."""

def reconstruct(
    raw: Union[_Frame, Sequence[_Frame]],
    network: _Net,
    *,
    bit_depth: Optional[SupportsIndex] = None,
    phase: Optional[str] = None,
    black_level: Union[float, Sequence[float], None] = None,
    white_level: Optional[float] = None,
    camera: Optional[_Camera] = None,
    sensor: Optional[_Sensor] = None,
    stride: Optional[SupportsIndex] = None,
) -> _Light:
    """Linear light of a raw frame: with a Network in floating point (`stride` 2, 4 or 8, default 8), with a FixedNetwork, a name or a file in the board's
    integers (docs/contract.md, section 6, as RGB). `bit_depth`: bits, 8 to 16 (default 16). Levels are sensor values; `sensor`, a correction, takes
    their place. `camera` took the frame (default: that
    of a Capture); a network that was trained for another lens is rejected. For an array without `camera` nobody can tell. A Network of several exposures
    takes a list of as many raw frames of a static scene, in the order of its `foci`; `camera` is then focused at each of them."""

def board_picture(
    raw: _Frame,
    network: _Fixed,
    *,
    bit_depth: Optional[SupportsIndex] = None,
    phase: Optional[str] = None,
    black_level: Union[float, Sequence[float], None] = None,
    white_level: Optional[float] = None,
    camera: Optional[_Camera] = None,
    sensor: Optional[_Sensor] = None,
    display: str = "colour",
    curve: str = "srgb",
) -> BoardPicture:
    """The codes that leave the board's HDMI port for a frame that came through its cable (upper 14 bits). As `edof reconstruct --board`. `display`: colour or
    luma; `curve`: srgb, linear or bt709."""

def words(
    raw: _Frame,
    network: _Fixed,
    *,
    bit_depth: Optional[SupportsIndex] = None,
    phase: Optional[str] = None,
    black_level: Union[float, Sequence[float], None] = None,
    white_level: Optional[float] = None,
    camera: Optional[_Camera] = None,
    sensor: Optional[_Sensor] = None,
    display: str = "colour",
    curve: str = "srgb",
) -> dict[str, NDArray[Any]]:
    """Every word at every boundary (int16: y, b1, z1, v1, ..., f, as rows of patches x columns of patches x words; luma, cb, cr) and the codes (uint8: y_code,
    cb_code, cr_code): words.npz of docs/contract.md, section 8."""

def cable_pixels(raw: _Frame, *, bit_depth: Optional[SupportsIndex] = None, phase: Optional[str] = None) -> NDArray[np.uint16]:
    """A frame as pixels on the video cable (docs/contract.md, 1.1): the luma code low, the chroma code high; rows x columns."""

def uartbone_read(address: SupportsIndex, words: SupportsIndex) -> bytes:
    """The bytes that ask for 1 to 255 words from a byte address on, over UARTBone."""

def uartbone_write(address: SupportsIndex, words: Sequence[int]) -> bytes:
    """The bytes that write 1 to 255 words from a byte address on, over UARTBone."""

def uartbone_words(answer: bytes) -> list[int]:
    """The words of an answer."""

def demosaic(
    raw: _Frame,
    *,
    method: str = "malvar",
    bit_depth: Optional[SupportsIndex] = None,
    phase: Optional[str] = None,
    black_level: Union[float, Sequence[float], None] = None,
    white_level: Optional[float] = None,
    sensor: Optional[_Sensor] = None,
) -> _Light:
    """The frame as a plain camera would show it: malvar (Malvar, He, Cutler) or directional (Menon, Andriani, Calvagno)."""

def train(
    form: str,
    pictures: Sequence[_Floats],
    camera: _Camera,
    *,
    recipe: Optional[dict[str, Any]] = None,
    psi: Optional[Sequence[float]] = None,
    focus: Optional[Sequence[float]] = None,
    threads: Optional[SupportsIndex] = None,
    start: Optional[Network] = None,
    name: str = "trained",
) -> tuple[Network, list[dict[str, Any]]]:
    """Trains a float network of `form` on pictures (as files hold them, 0 to 1) behind a camera, at depths `psi` (default: nine over its range), as `edof train`; `recipe` replaces fields of
    edof_train::recipe::Recipe (steps, batch, rate, seed, tones, conditions, ...); `focus`: psi of each exposure of the form, in place of the camera's focus; `start` goes on from a network. Gives the best validated network and a report (step, loss,
    best_db) of every hundred steps. The same arguments give the same weights on any number of threads (default 2)."""

def wiener(plane: _Floats, kernel: _Floats, *, noise_to_contrast: float = 0.01) -> _Light:
    """Deconvolution of least mean square error; the variance of the noise over that of a difference of neighbouring pixels, above 0."""

def richardson_lucy(plane: _Floats, kernel: _Floats, *, steps: Optional[SupportsIndex] = None) -> _Light:
    """`steps` (default 30) toward the most likely light behind counted photons."""

def hyper_laplacian(plane: _Floats, kernel: _Floats, *, weight: float = 3000.0, alpha: float = 0.8) -> _Light:
    """Deconvolution under a prior of few and large differences (Krishnan, Fergus 2009): `weight` of the picture, above 0; `alpha` above 0, at most 1."""

def blind_deconvolution(plane: _Floats, *, side: Optional[SupportsIndex] = None) -> tuple[_Light, _Light]:
    """Sharp plane and kernel (Krishnan, Tay, Fergus 2011); `side` of the kernel, odd, 3 to 255, default 25: larger than the blur."""

def omp(signals: _Floats, dictionary: _Floats, *, atoms: SupportsIndex, residual: float = 0.0) -> _Light:
    """Sparse codes (signals x atoms) of `signals` (signals x length) in `dictionary` (length x atoms) by orthogonal matching pursuit: at most `atoms` each, or until
    the rest's norm is `residual`."""

def lasso(
    signals: _Floats,
    dictionary: _Floats,
    penalty: Union[float, _Floats],
    *,
    method: str = "fista",
    steps: Optional[SupportsIndex] = None,
    tolerance: float = 1e-4,
) -> _Light:
    """Sparse codes (signals x atoms) that minimise |x - D z|^2 / 2 + penalty |z|_1, by fista or ista; at most `steps` (default 200), or until none moves by more than
    `tolerance`."""

def ksvd(signals: _Floats, start: _Floats, *, atoms: SupportsIndex, rounds: SupportsIndex) -> _Light:
    """A dictionary (length x atoms) in which `signals` (signals x length) have codes of `atoms` atoms, learned in `rounds` from `start`."""

def stall_pattern(
    cycles: SupportsIndex, *, seed: Optional[SupportsIndex] = None, stalled: Optional[SupportsIndex] = None
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Cycles in which the source and the sink of a chain act, if both stall in `stalled` of 256 cycles (0 to 255, default 0), drawn from `seed`. The source raises
    valid only in such a cycle and keeps it until the beat is taken; the sink is ready in exactly these."""

def load_picture(path: _Path) -> _Light:
    """A photograph (PNG, JPEG, WebP, TIFF, BMP, PPM) as numbers 0 to 1, encoded as the file holds them."""

def save_picture(path: _Path, light: _Floats, *, curve: str = "srgb", bits: Optional[SupportsIndex] = None) -> None:
    """Writes light as a picture of 8 (default) or 16 bits, by a curve (srgb, linear, bt709)."""

def quality(truth: _Floats, estimate: _Floats, *, border: Optional[SupportsIndex] = None, tone: str = "linear") -> dict[str, Any]:
    """Every metric (`metrics()`) of two pictures that is large enough for it, `border` pixels (default 8) left out (docs/decisions/0003-metrics.md).

    `tone` is the encoding of both (linear, srgb), which metrics of light need."""

def metrics() -> list[dict[str, Any]]:
    """What `quality` measures: name, title, unit, better (higher or lower) and min_side, the smallest side in pixels inside the border."""

def psnr(truth: _Floats, estimate: _Floats, *, border: Optional[SupportsIndex] = None) -> float:
    """PSNR in dB over all colours, peak 1, `border` pixels (default 8) left out; infinite for equal pictures."""
