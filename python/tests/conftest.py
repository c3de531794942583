"""The program, photographs and small frames that tests share."""

import os
import subprocess
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import edof

ROOT = Path(__file__).resolve().parents[2]

Run = Callable[..., None]


def _program() -> Path:
    found = os.environ.get("EDOF")
    program = Path(found) if found else ROOT / "target" / "debug" / "edof"
    if not program.is_file():
        raise FileNotFoundError(f"{program}: no program; build it by 'cargo build -p edof-cli', or name it by EDOF")
    return program.resolve()


@pytest.fixture(scope="session")
def program() -> Path:
    """The program that results are compared with."""
    return _program()


@pytest.fixture
def run(program: Path, tmp_path: Path) -> Run:
    """Runs the program in a folder of the test's own."""

    def run(*words: Any) -> None:
        done = subprocess.run([str(program), *map(str, words)], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    return run


def photograph(rows: int = 96, columns: int = 144, seed: int = 3) -> NDArray[np.float32]:
    """A picture of 0 to 1 as a file of 8 bits holds it: leaves, or a part of a photograph where there are any."""
    kodak = ROOT.parent / "shared" / "data" / "kodak" / "kodim01.png"
    if kodak.is_file():
        picture = edof.load_picture(kodak)
        return np.ascontiguousarray(picture[:, 100 : 100 + rows, 60 : 60 + columns])
    light = edof.Scene.draw("leaves", rows, columns, psi=[0.0], seed=seed).sharp()
    codes = np.round(np.clip(edof.encode(light), 0.0, 1.0) * 255.0)
    return (codes / np.float32(255.0)).astype(np.float32)


@pytest.fixture(scope="session")
def picture() -> NDArray[np.float32]:
    """A picture as a file holds it."""
    return photograph()


@pytest.fixture(scope="session")
def light(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """The same as light."""
    return edof.decode(picture)


@pytest.fixture(scope="session")
def network() -> edof.FixedNetwork:
    """A network in integers."""
    return edof.FixedNetwork.load("edof-t4w12-outer-light")


def raw_file(path: Path, values: NDArray[np.uint16], depth: int) -> None:
    """A frame as the program reads it: a PGM of its sensor values."""
    rows, columns = values.shape
    header = f"P5\n{columns} {rows}\n{2**depth - 1}\n".encode()
    body = values.astype(">u2").tobytes() if depth > 8 else values.astype(np.uint8).tobytes()
    path.write_bytes(header + body)


def extreme(kind: str, rows: int = 32, columns: int = 48, depth: int = 16) -> NDArray[np.uint16]:
    """Frames that are hard to compute exactly."""
    most = 2**depth - 1
    if kind == "dark":
        return np.zeros((rows, columns), np.uint16)
    if kind == "full":
        return np.full((rows, columns), most, np.uint16)
    if kind == "checked":
        return (np.indices((rows, columns)).sum(axis=0) % 2 * most).astype(np.uint16)
    if kind == "noise":
        return np.random.default_rng(1).integers(0, most + 1, (rows, columns)).astype(np.uint16)
    raise ValueError(kind)
