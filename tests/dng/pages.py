"""The table of docs/dng.md, and the registries that it is compared with."""

from dataclasses import dataclass

import tifffile

# Ranges of tags that the DNG specification has given out, and TIFF's own.
RANGES = [
    (254, 347),
    (512, 532),
    (50706, 50741),
    (50778, 50781),
    (50827, 50834),
    (50879, 50879),
    (50931, 50942),
    (50964, 50982),
    (51008, 51182),
    (52525, 52600),
]
# Tags of TIFF/EP (ISO 12234-2) and Exif that stand in a first directory.
EP = [
    33421,
    33422,
    33423,
    33432,
    33434,
    33437,
    33723,
    34665,
    34675,
    34850,
    34852,
    34853,
    34855,
    34856,
    34857,
    34858,
    34859,
    36867,
    37122,
    *range(37377, 37400),
]
# Tags of other programs in those ranges, and of fax.
FOREIGN = {300, 326, 327, 328, 343, 344, 345, 346, 51023, 51123, 51159, 51160}
# Names that tifffile has otherwise than the specification.
RENAMED = {50933: "ExtraCameraProfiles", 51090: "OriginalBestQualityFinalSize", 254: "NewSubFileType", 531: "YCbCrPositioning"}
TREATMENTS = ("honoured", "harmless", "noted", "rejected")


@dataclass
class Row:
    name: str
    since: str
    treatment: str
    reason: str


def page_rows(path):
    """Rows of the page's table by number."""
    rows = {}
    for line in path.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if len(cells) == 5 and cells[0].isdigit():
            number, row = int(cells[0]), Row(*cells[1:])
            assert number not in rows and row.treatment in TREATMENTS and row.reason, line
            rows[number] = row
    return rows


def check_registry(rows):
    """What the page lacks, or names otherwise than tifffile's registry."""
    registry = {}
    for number, name in tifffile.TIFF.TAGS.items():
        registry.setdefault(number, name)
    known = [n for n in registry if any(a <= n <= b for a, b in RANGES) or n in EP]
    for number in sorted(set(known) - FOREIGN | set(EP)):
        if number not in rows:
            yield f"docs/dng.md lacks {registry.get(number)} ({number})"
        elif rows[number].name not in (registry.get(number), RENAMED.get(number)):
            yield f"docs/dng.md has {rows[number].name} for {number}, tifffile {registry.get(number)}"
    if list(rows) != sorted(rows):
        yield "docs/dng.md: rows are not in the order of their numbers"
