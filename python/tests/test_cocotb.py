"""The examples under Icarus: cocotb with edof's scoreboards and drivers."""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest

import edof

cocotb = pytest.importorskip("cocotb")
EXAMPLES = Path(__file__).resolve().parents[1] / "examples"

pytestmark = pytest.mark.skipif(shutil.which("iverilog") is None, reason="iverilog is not installed")


def config(word: str, *more: str) -> str:
    """An answer of cocotb-config."""
    command = [sys.executable, "-m", "cocotb.config", word, *more]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sources of `tiny` with a random network of 12 bits, whose sums fit."""
    folder = tmp_path_factory.mktemp("tiny")
    fields = json.loads(edof.Design("tiny").json())
    fields["code_bits"] = 12
    (folder / "tiny.json").write_text(json.dumps(fields))
    design = edof.Design(folder / "tiny.json")
    network = design.random_network(1)
    network.save(folder / "tiny.fixed.safetensors")
    design.generate(network, folder / "tiny")
    return folder


def simulate(generated: Path, example: str, top: str, files: list[Path], work: Path) -> tuple[bool, str]:
    """Whether every test of an example passed, and what was said."""
    inside = generated / "tiny"
    built = work / "bench.vvp"
    command = ["iverilog", "-g2012", "-Wno-timescale", "-s", top, "-o", built, *files]
    subprocess.run(command, cwd=inside, check=True, capture_output=True)
    library = Path(config("--lib-name-path", "vpi", "icarus"))
    results = work / "results.xml"
    own = {
        "MODULE": example,
        "TOPLEVEL": top,
        "TOPLEVEL_LANG": "verilog",
        "COCOTB_RESULTS_FILE": str(results),
        "LIBPYTHON_LOC": config("--libpython"),
        "PYTHONPATH": os.pathsep.join([str(EXAMPLES), *(p for p in sys.path if p)]),
        "EDOF_DESIGN": str(generated / "tiny.json"),
        "EDOF_WEIGHTS": str(generated / "tiny.fixed.safetensors"),
        "COCOTB_ANSI_OUTPUT": "0",
        "PYTHONHOME": sys.base_prefix,
    }
    command = ["vvp", "-M", str(library.parent), "-m", library.stem, str(built)]
    done = subprocess.run(command, cwd=inside, env={**os.environ, **own}, capture_output=True, text=True, timeout=170)
    text = results.read_text() if results.exists() else ""
    said = done.stdout + done.stderr
    return "<testcase" in text and "<failure" not in text and "<error" not in text, said


def test_the_chain_of_tiny_is_the_model_in_every_word_and_cycle(generated: Path, tmp_path: Path) -> None:
    files = sorted((generated / "tiny" / "rtl").glob("*.v"))
    passed, said = simulate(generated, "cocotb_chain", "chain", files, tmp_path)
    assert passed, said[-4000:]


def test_an_edited_stage_is_found_by_stage_and_element(generated: Path, tmp_path: Path) -> None:
    # One bit of every second code of the M stages is wrong; what comes before them is right.
    text = (generated / "tiny" / "rtl" / "results.v").read_text()
    wrong = text.replace("wire [31:0] code = {shrink_odd_result,", "wire [31:0] code = {shrink_odd_result ^ {15'd0, PASSES_BASE},")
    assert wrong != text
    broken = tmp_path / "results.v"
    broken.write_text(wrong)
    files = [f for f in sorted((generated / "tiny" / "rtl").glob("*.v")) if f.name != "results.v"]
    passed, said = simulate(generated, "cocotb_chain", "chain", [*files, broken], tmp_path)
    assert not passed
    assert re.search(r"Mismatch: stage M1 \(M1 to M2\), patch 0, element 1, cycle \d+: expected -?\d+, got -?\d+", said), said[-4000:]


def test_edof_core_shows_golden_pictures_with_pauses_on_all_channels(generated: Path, tmp_path: Path) -> None:
    pytest.importorskip("cocotbext.axi")
    names = (generated / "tiny" / "sim" / "core_bench.f").read_text().split()
    files = [generated / "tiny" / name for name in names if name.endswith(".v")]
    passed, said = simulate(generated, "cocotb_core", "edof_core", files, tmp_path)
    assert passed, said[-4000:]


def test_beats_are_two_signed_words() -> None:
    from edof.cocotb._chain import beat, two_words

    for words in [(0, 0), (-1, 5), (32767, -32768), (12, -12)]:
        assert two_words(beat(*words)) == words
    assert isinstance(np.int16(beat(1, 0) & 0xFFFF), np.int16)
