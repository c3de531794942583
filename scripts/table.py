#!/usr/bin/env python3
"""The compact table of a file of rows: scripts/table.py ROWS.jsonl > TABLE.csv. Tables are in docs/results; files of rows are not.

Two lines of remarks hold the header of the rows, and their number and SHA-256. Then come the columns that pages use, numbers to nine digits, hashes of
weights to twelve. What lies inside of another field is named by both, as in `light.psnr_db`. A cell is JSON where it is no plain text.
"""

import csv
import hashlib
import io
import json
import pathlib
import sys

# What no page uses.
LEFT_OUT = ("_sha256", "key_version", "crop", "seconds_range", "cpu_seconds_range", "psnr_clipped_db", "channel_psnr_db", "luma_")


def cells(value, name=""):
    """Columns of a row with the text of their cells; a field without a value has none."""
    if isinstance(value, dict):
        return {key: cell for field, item in value.items() for key, cell in cells(item, f"{name}.{field}" if name else field).items()}
    if value is None or name != "weights_sha256" and any(part in name for part in LEFT_OUT):
        return {}
    return {name: value[:12] if name == "weights_sha256" else text(value)}


def text(value):
    """A value as text."""
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, list):
        return f"[{','.join(map(text, value))}]"
    return value if isinstance(value, str) else json.dumps(value)


def rows_of(path):
    """Header and rows of a file of JSON lines."""
    header, *rows = map(json.loads, path.read_text().splitlines())
    if any("study" in row for row in rows):
        sys.exit(f"{path}: has rows of several programs; a page is of one")
    return header, rows


def table(path):
    """The compact table of a file of rows."""
    header, rows = rows_of(path)
    made = {"rows": len(rows), "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
    rows = [cells(row) for row in rows]
    out = io.StringIO()
    out.writelines(f"# {json.dumps(line, separators=(',', ':'))}\n" for line in (header, made))
    writer = csv.DictWriter(out, list(dict.fromkeys(key for row in rows for key in row)), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def read(path):
    """Rows of a compact table, each a dict of texts without its empty cells."""
    with path.open(newline="") as file:
        lines = csv.DictReader(line for line in file if not line.startswith("#"))
        return [{key: cell for key, cell in row.items() if cell} for row in lines]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.stdout.write(table(pathlib.Path(sys.argv[1])))
