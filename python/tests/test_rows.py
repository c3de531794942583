"""Files of rows of studies."""

from pathlib import Path

import pytest

import edof

ROWS = Path(__file__).resolve().parents[2] / "crates" / "edof-study" / "tests" / "rows"


def test_rows_of_studies_are_dicts() -> None:
    found = edof.rows(ROWS / "single-depth.jsonl")
    assert len(found) == 10
    assert {row["study"] for row in found} == {"single-depth"}
    assert all(isinstance(row["psnr_db"], float) and isinstance(row["method"], str) for row in found)


def test_numbers_without_a_form_come_back_and_other_files_are_rejected(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_text('{"study":"kodak","layout":2,"revision":"abc"}\n{"psnr_db":"inf","channel_psnr_db":["nan",1.0,"-inf"],"image":"inf"}\n')
    (row,) = edof.rows(file)
    assert row["psnr_db"] == float("inf") and row["channel_psnr_db"][2] == float("-inf") and row["image"] == "inf"
    assert (row["study"], row["revision"]) == ("kodak", "abc")
    for text, message in [('{"study":"k","layout":2}\n{"a":', "line 2 is no row"), ('{"a":1}\n', "contains no rows of a study"), ("[1]\n", "line 1 is no row")]:
        file.write_text(text)
        with pytest.raises(edof.EdofError, match=message):
            edof.rows(file)
    with pytest.raises(edof.EdofError, match="cannot read"):
        edof.rows(tmp_path / "nothing")
