"""DNGs with one harmless tag each, of a plausible value that would change a picture if it were honoured."""

from dataclasses import replace

from messages import damaged
from scenes import Harmless, plain
from write import ASCII, BYTE, DOUBLE, FLOAT, LONG, RATIONAL, SHORT, SLONG, SRATIONAL, TAGS, UNDEFINED, dng

SAMPLES = {
    ASCII: "text of a case",
    BYTE: [1, 2, 3, 4],
    SHORT: [3],
    LONG: [5],
    RATIONAL: [1.5],
    SRATIONAL: [-0.5],
    UNDEFINED: b"\1\2\3\4\5\6\7\10",
    FLOAT: [0.5, 0.25],
    DOUBLE: [0.5, 0.25],
    SLONG: [-7],
}
# Types and values of harmless tags where these are not three of SHORT.
TEXTS = [
    269,
    270,
    271,
    272,
    285,
    305,
    306,
    315,
    316,
    333,
    337,
    32781,
    33432,
    34852,
    36867,
    37395,
    50708,
    50735,
    50966,
    50967,
    50968,
    50971,
    51105,
    51081,
    51182,
    52526,
    52528,
    52552,
    50934,
    50936,
    50942,
]
BYTES = [700, 34377, 50709, 50827, 50740, 50969, 50972, 50973, 51111, 50781, 51043, 51113, 51114, 52540, 33723, 37398]
UNDEFINEDS = [34675, 34856, 34857, 37388, 37389, 50828, 50831, 50833, 51113, 52545, 52548, 52550, 52551]
RATIONALS = {
    282: [72.0],
    283: [72.0],
    286: [1.0],
    287: [1.0],
    318: [0.3127, 0.329],
    319: [0.64, 0.33, 0.3, 0.6, 0.15, 0.06],
    529: [0.3, 0.6, 0.1],
    532: [0, 255, 128, 255, 128, 255],
    33423: [0.5],
    33434: [0.01],
    33437: [2.8],
    37122: [4.0],
    37378: [3.0],
    37381: [3.0],
    37382: [1.5],
    37386: [50.0],
    37387: [2.0],
    37390: [5000.0],
    37391: [5000.0],
    37397: [1.5],
    50731: [2.5],
    50732: [1.5],
    50734: [0.7],
    50736: [24.0, 70.0, 2.8, 2.8],
    50737: [3.0],
    50738: [0.5],
    50739: [0.5],
    50780: [2.0],
    50935: [0.8],
    51058: [2.8],
    51178: [1.0],
    51179: [9.0],
}
SRATIONALS = {
    37377: [6.0],
    37379: [1.0],
    37380: [1.5],
    50725: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    50726: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    52538: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    50832: [2, 0, 0, 0, 2, 0, 0, 0, 2],
    50834: [2, 0, 0, 0, 2, 0, 0, 0, 2],
    51044: [24.0],
}
LONGS = {
    288: [8],
    289: [4],
    292: [1],
    293: [1],
    50933: [8],
    51089: [24, 16],
    51090: [24, 16],
    51091: [24, 16],
    51110: [1],
    50941: [1],
    50970: [2],
    51107: [1],
    51108: [1],
    50733: [3000],
    34853: [8],
    34665: [8],
    37393: [7],
    52536: [1, 2, 3, 4],
    513: [8],
    514: [4],
    519: [8],
    520: [8],
    521: [8],
    52541: [8],
    52542: [4],
    52554: [7],
    52555: [2],
}
DOUBLES = {51041: [2e-5, 4e-7], 51112: [0.5]}
OTHERS = {
    52553: (FLOAT, [1.5]),
    34858: (SHORT, [1]),
    284: (SHORT, [2]),
    50741: (SHORT, [1]),
    338: (SHORT, [1]),
    301: (SHORT, list(range(0, 256 * 100, 100))),
    320: (SHORT, list(range(768))),
    291: (SHORT, [5, 6, 7]),
    530: (SHORT, [2, 2]),
    342: (SHORT, [1, 2, 3, 4, 5, 6]),
    297: (SHORT, [1, 4]),
    280: (SHORT, [1000]),
    281: (SHORT, [2000]),
    340: (SHORT, [1000]),
    341: (SHORT, [2000]),
    37396: (SHORT, [9, 9]),
    336: (SHORT, [10, 200]),
    321: (SHORT, [10, 200]),
    34855: (SHORT, [100]),
}


def harmless_value(number):
    for numbers, kind in ((TEXTS, ASCII), (BYTES, BYTE), (UNDEFINEDS, UNDEFINED)):
        if number in numbers:
            return kind, SAMPLES[kind]
    for values, kind in ((RATIONALS, RATIONAL), (SRATIONALS, SRATIONAL), (LONGS, LONG), (DOUBLES, DOUBLE)):
        if number in values:
            return kind, values[number]
    return OTHERS.get(number, (SHORT, SAMPLES[SHORT]))


def harmless(rows):
    found = []
    for number, row in rows.items():
        if row.treatment == "harmless":
            kind, value = harmless_value(number)
            if kind == BYTE:
                value = bytes(value)
            data = with_tag(plain().shot, number, kind, value)
            found.append(Harmless(f"{number}-{row.name}", data, number))
            # Out of the file, and of an unknown type: the tag is not read.
            found.append(Harmless(f"{number}-{row.name}-damaged", damaged(plain().shot, number, 99, 7), number))
    return found


def with_tag(directory, number, kind, value):
    name = next((n for n, (code, _) in TAGS.items() if code == number), None)
    tags = {k: v for k, v in directory.tags.items() if k != name}
    if kind == BYTE and isinstance(value, bytes):
        value = list(value)
    return dng([replace(directory, tags=tags | {number: (kind, value)}, without=directory.without + ((name,) if name else ()))])
