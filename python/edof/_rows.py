"""Files of rows of studies (`edof study ... --rows FILE`) as plain dicts."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path
from typing import Any, Union

from ._edof import EdofError, metrics

# Numbers that JSON has no form for.
_WORDS = {"inf": float("inf"), "-inf": float("-inf"), "nan": float("nan")}
_NUMBERS = {"value", *(metric["name"] for metric in metrics())}


def _plain(value: Any, name: str = "") -> Any:
    if isinstance(value, str) and value in _WORDS and (name.endswith("_db") or name in _NUMBERS):
        return _WORDS[value]
    if isinstance(value, dict):
        return {key: _plain(item, key) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item, name) for item in value]
    return value


def rows(path: Union[str, PathLike[str]]) -> list[dict[str, Any]]:
    """Rows of a study's file, each a dict with the fields of its line, the name of the study and the revision that measured it (None in older files).

    `pandas.DataFrame(edof.rows("rows.jsonl"))` is a table of them. A file that is none, or a line that is cut, raises EdofError.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise EdofError(f"{path}: cannot read: {getattr(error, 'strerror', None) or 'not a text'}") from None
    found: list[dict[str, Any]] = []
    study: dict[str, Any] = {}
    for number, line in enumerate(text.splitlines(), 1):
        try:
            fields = json.loads(line)
        except json.JSONDecodeError:
            raise EdofError(f"{path}: line {number} is no row") from None
        if not isinstance(fields, dict):
            raise EdofError(f"{path}: line {number} is no row")
        if "study" in fields and "layout" in fields:
            study = {"study": fields["study"], "revision": fields.get("revision")}
        elif study:
            found.append({**study, **_plain(fields)})
        else:
            raise EdofError(f"{path}: contains no rows of a study")
    return found
