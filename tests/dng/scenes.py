"""The frames that the cases are made of, and what a case is."""

import struct
from dataclasses import dataclass, field, replace

import numpy as np

import expected
from write import Directory, dng

HEIGHT, WIDTH = 32, 48
LARGE = 128, 192
# Largest difference of a number 0 to 1: light is rounded to 16 bits, and so are the pictures.
TOLERANCE = 0.0012
# The corner of the farthest pixel or its middle may have the radius 1: a small difference in a large frame.
ROUND = 0.003
WARM = [0.8, 0.15, -0.05, -0.3, 1.1, 0.2, -0.05, 0.2, 0.6]
COOL = [0.9, -0.2, -0.1, -0.4, 1.2, 0.2, -0.1, 0.25, 0.5]
MIDDLE = [0.85, -0.05, -0.08, -0.35, 1.15, 0.2, -0.08, 0.22, 0.55]
FORWARD = [0.6, 0.25, 0.11, 0.25, 0.7, 0.05, 0.02, 0.1, 0.7]
FORWARD2 = [0.5, 0.35, 0.12, 0.2, 0.72, 0.08, 0.04, 0.05, 0.74]
CALIBRATION = [1.05, 0.03, -0.02, 0.02, 0.95, 0.04, -0.01, 0.05, 1.1]
NEUTRAL = [0.5, 1.0, 0.625]
A, DAYLIGHT, D50, OTHER = 17, 21, 23, 255


@dataclass
class Case:
    """A file whose picture is known: the directory of its frame, and how it lies in the file."""

    name: str
    rows: tuple
    shot: Directory
    directories: list | None = None
    order: str = "<"
    big: bool = False
    colours: dict | None = None
    phase: str | None = None
    options: list = field(default_factory=list)
    tolerance: float = TOLERANCE
    libraw: bool = True
    ending: str = ".dng"

    @property
    def file_name(self):
        return self.name + self.ending

    def file(self):
        return dng(self.directories or [self.shot], self.order, self.big)

    def finished(self, reconstructed):
        return expected.finished(reconstructed, self.shot, self.colours, self.order)


@dataclass
class Harmless:
    name: str
    data: bytes
    number: int


@dataclass
class Rejection:
    name: str
    data: bytes
    number: int
    words: list
    options: list = field(default_factory=list)
    help: bool = True
    ending: str = ".dng"


@dataclass
class Note:
    name: str
    data: bytes
    number: int
    words: list
    expected: bool = True
    options: list = field(default_factory=list)


def scene(height=HEIGHT, width=WIDTH, phase="rggb", seed=1, noise=0.02, flat=False):
    """Light of a mosaic: ramps along both sides, an asymmetric blob, noise; or flat 0.3 0.4 0.5."""
    rows, columns = np.indices((height, width))
    colour = np.array(expected.PHASES[phase]).reshape(2, 2)[rows % 2, columns % 2]
    light = np.array([0.3, 0.4, 0.5])[colour]
    if flat:
        return light
    field_ = 0.55 + 0.25 * columns / width + 0.3 * rows / height
    field_ += 0.25 * np.exp(-((6 * rows / height - 1.8) ** 2 + (6 * columns / width - 4.2) ** 2))
    noisy = light * field_ + noise * np.random.default_rng(seed).uniform(-1, 1, light.shape)
    return np.clip(noisy, 0.02, 0.98)


def shot(height=HEIGHT, width=WIDTH, bits=16, phase="rggb", low=0.0, high=None, light=None, floating=False, **given):
    """A directory whose stored values lie between `low` and `high`; the other arguments are those of Directory, or tags."""
    fields = {name: given.pop(name) for name in ("compression", "tile", "strip", "jpeg", "subs", "without", "unsorted") if name in given}
    high = high if high is not None else (1.0 if floating else (1 << bits) - 1)
    light = scene(height, width, phase) if light is None else light
    stored = low + (high - low) * light
    stored = stored.astype(np.float32) if floating else np.rint(stored).astype(np.int64)
    tags = {
        "DNGVersion": [1, 4, 0, 0],
        "DNGBackwardVersion": [1, 1, 0, 0],
        "UniqueCameraModel": "check",
        "CFARepeatPatternDim": [2, 2],
        "CFAPattern": list(expected.PHASES[phase]),
    }
    return Directory(stored, bits=bits, tags=tags | given.pop("tags", {}) | given, **fields)


def plain(**given):
    return Case("plain", (), shot(**given))


def preview(**tags):
    """A small RGB preview as a first directory."""
    pixels = np.full((8, 12 * 3), 77)
    made = {"ImageWidth": 12, "SamplesPerPixel": 3, "BitsPerSample": [8, 8, 8], "PhotometricInterpretation": 2, "NewSubFileType": 1}
    return Directory(pixels, bits=8, tags={"DNGVersion": [1, 4, 0, 0], "DNGBackwardVersion": [1, 1, 0, 0]} | made | tags)


def without_dng(directory):
    """The directory of a frame that is not the first."""
    tags = {k: v for k, v in directory.tags.items() if k not in ("DNGVersion", "DNGBackwardVersion", "UniqueCameraModel")}
    return replace(directory, tags=tags)


def with_sub(*subs, **tags):
    first = preview(**tags)
    first.subs = list(subs)
    return first


def illuminant(x, y, order="<"):
    return struct.pack(order + "H4I", 0, round(x * 10000), 10000, round(y * 10000), 10000)
