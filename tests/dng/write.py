"""Writes DNG files from the TIFF 6.0 and DNG specifications: any tag, type and byte order, BigTIFF, strips and tiles, packed integers,
floating point, lossless JPEG, SubIFDs and opcode lists. Nothing here is shared with the program under test."""

import struct
from dataclasses import dataclass, field

import numpy as np

BYTE, ASCII, SHORT, LONG, RATIONAL, SBYTE, UNDEFINED, SSHORT, SLONG, SRATIONAL, FLOAT, DOUBLE, IFD = range(1, 14)
LONG8, IFD8 = 16, 18

CODES = {
    BYTE: "B",
    ASCII: "s",
    SHORT: "H",
    LONG: "I",
    SBYTE: "b",
    UNDEFINED: "s",
    SSHORT: "h",
    SLONG: "i",
    FLOAT: "f",
    DOUBLE: "d",
    IFD: "I",
    LONG8: "Q",
    IFD8: "Q",
}

# Tags that the oracle understands: number and type.
TAGS = {
    "NewSubFileType": (254, LONG),
    "SubfileType": (255, SHORT),
    "ImageWidth": (256, LONG),
    "ImageLength": (257, LONG),
    "BitsPerSample": (258, SHORT),
    "Compression": (259, SHORT),
    "PhotometricInterpretation": (262, SHORT),
    "FillOrder": (266, SHORT),
    "StripOffsets": (273, LONG),
    "Orientation": (274, SHORT),
    "SamplesPerPixel": (277, SHORT),
    "RowsPerStrip": (278, LONG),
    "StripByteCounts": (279, LONG),
    "PlanarConfiguration": (284, SHORT),
    "Predictor": (317, SHORT),
    "TileWidth": (322, LONG),
    "TileLength": (323, LONG),
    "TileOffsets": (324, LONG),
    "TileByteCounts": (325, LONG),
    "SubIFDs": (330, LONG),
    "SampleFormat": (339, SHORT),
    "JPEGTables": (347, UNDEFINED),
    "CFARepeatPatternDim": (33421, SHORT),
    "CFAPattern": (33422, BYTE),
    "DNGVersion": (50706, BYTE),
    "DNGBackwardVersion": (50707, BYTE),
    "UniqueCameraModel": (50708, ASCII),
    "CFAPlaneColor": (50710, BYTE),
    "CFALayout": (50711, SHORT),
    "LinearizationTable": (50712, SHORT),
    "BlackLevelRepeatDim": (50713, SHORT),
    "BlackLevel": (50714, RATIONAL),
    "BlackLevelDeltaH": (50715, SRATIONAL),
    "BlackLevelDeltaV": (50716, SRATIONAL),
    "WhiteLevel": (50717, LONG),
    "DefaultScale": (50718, RATIONAL),
    "DefaultCropOrigin": (50719, RATIONAL),
    "DefaultCropSize": (50720, RATIONAL),
    "ColorMatrix1": (50721, SRATIONAL),
    "ColorMatrix2": (50722, SRATIONAL),
    "CameraCalibration1": (50723, SRATIONAL),
    "CameraCalibration2": (50724, SRATIONAL),
    "AnalogBalance": (50727, RATIONAL),
    "AsShotNeutral": (50728, RATIONAL),
    "AsShotWhiteXY": (50729, RATIONAL),
    "BaselineExposure": (50730, SRATIONAL),
    "CalibrationIlluminant1": (50778, SHORT),
    "CalibrationIlluminant2": (50779, SHORT),
    "ActiveArea": (50829, LONG),
    "MaskedAreas": (50830, LONG),
    "ColorimetricReference": (50879, SHORT),
    "CameraCalibrationSignature": (50931, BYTE),
    "ProfileCalibrationSignature": (50932, BYTE),
    "ForwardMatrix1": (50964, SRATIONAL),
    "ForwardMatrix2": (50965, SRATIONAL),
    "SubTileBlockSize": (50974, LONG),
    "RowInterleaveFactor": (50975, LONG),
    "OpcodeList1": (51008, UNDEFINED),
    "OpcodeList2": (51009, UNDEFINED),
    "OpcodeList3": (51022, UNDEFINED),
    "DefaultUserCrop": (51125, RATIONAL),
    "CalibrationIlluminant3": (52529, SHORT),
    "CameraCalibration3": (52530, SRATIONAL),
    "ColorMatrix3": (52531, SRATIONAL),
    "ForwardMatrix3": (52532, SRATIONAL),
    "IlluminantData1": (52533, UNDEFINED),
    "IlluminantData2": (52534, UNDEFINED),
    "IlluminantData3": (52535, UNDEFINED),
    "ColumnInterleaveFactor": (52547, LONG),
}
DENOMINATOR = 1_000_000


def fraction(value):
    """A value, or a numerator and a denominator, as both."""
    if isinstance(value, tuple):
        return value
    return (int(value), 1) if float(value).is_integer() else (round(value * DENOMINATOR), DENOMINATOR)


def encoded(kind, values, order):
    """Bytes of a tag's values, and their number."""
    if kind in (ASCII, UNDEFINED) or isinstance(values, bytes):
        data = values if isinstance(values, bytes) else values.encode() + b"\0"
        return data, len(data)
    values = list(values) if np.ndim(values) or isinstance(values, (list, tuple)) else [values]
    if kind in (RATIONAL, SRATIONAL):
        code = "I" if kind == RATIONAL else "i"
        return b"".join(struct.pack(order + 2 * code, *fraction(v)) for v in values), len(values)
    return struct.pack(f"{order}{len(values)}{CODES[kind]}", *(v if kind in (FLOAT, DOUBLE) else int(v) for v in values)), len(values)


@dataclass
class Directory:
    """A directory: its picture (none for one of tags alone), how it is stored, its tags by name or number, its SubIFDs."""

    stored: np.ndarray | None = None
    bits: int = 16
    compression: int = 1
    tile: tuple | None = None
    strip: int | None = None
    jpeg: dict = field(default_factory=dict)
    tags: dict = field(default_factory=dict)
    subs: list = field(default_factory=list)
    sub_kind: int = LONG
    without: tuple = ()
    unsorted: bool = False


class Writer:
    """Bytes of a file in the making. `cuts` are the ends of directories, values and parts of pictures."""

    def __init__(self, order="<", big=False):
        self.order, self.big, self.cuts = order, big, []
        mark = b"II" if order == "<" else b"MM"
        if big:
            self.data = bytearray(mark + struct.pack(order + "HHHQ", 43, 8, 0, 0))
        else:
            self.data = bytearray(mark + struct.pack(order + "HI", 42, 0))

    def put(self, data):
        if len(self.data) % 2:
            self.data += b"\0"
        at = len(self.data)
        self.data += data
        self.cuts.append(len(self.data))
        return at

    def pointer(self, at, value):
        struct.pack_into(self.order + ("Q" if self.big else "I"), self.data, at, value)

    def directory(self, directory):
        """Writes a directory after what it points to; gives its place and that of its pointer to the next."""
        tags = {}
        if directory.stored is not None:
            tags |= self.picture(directory)
        if directory.subs:
            tags["SubIFDs"] = ("as", (directory.sub_kind, [self.directory(sub)[0] for sub in directory.subs]))
        tags |= directory.tags
        entries = {}
        for name, values in tags.items():
            if name in directory.without:
                continue
            number, kind = TAGS[name] if name in TAGS else (name, None)
            if kind is None or (isinstance(values, tuple) and len(values) == 2 and values[0] == "as"):
                kind, values = values if kind is None else values[1]
            entries[number] = (kind, *encoded(kind, values, self.order))
        inline = 8 if self.big else 4
        places = {number: self.put(data) for number, (_, data, _) in entries.items() if len(data) > inline}
        word = "Q" if self.big else "I"
        table = struct.pack(self.order + ("Q" if self.big else "H"), len(entries))
        for number, (kind, data, count) in sorted(entries.items(), reverse=directory.unsorted):
            value = struct.pack(self.order + word, places[number]) if number in places else data.ljust(inline, b"\0")
            table += struct.pack(self.order + "HH" + word, number, kind, count) + value
        at = self.put(table + bytes(inline))
        return at, len(self.data) - inline

    def picture(self, directory):
        height, width = directory.stored.shape
        tiled = directory.tile is not None
        rows, columns = directory.tile if tiled else (directory.strip or height, width)
        parts = []
        for top in range(0, height, rows):
            for left in range(0, width, columns):
                part = directory.stored[top : top + rows, left : left + columns]
                if tiled:
                    part = np.pad(part, ((0, rows - part.shape[0]), (0, columns - part.shape[1])), mode="edge")
                parts.append(self.part(part, directory))
        places = [self.put(part) for part in parts]
        lengths = [len(part) for part in parts]
        floating = directory.stored.dtype.kind == "f"
        tags = {
            "ImageWidth": width,
            "ImageLength": height,
            "BitsPerSample": directory.bits,
            "Compression": directory.compression,
            "PhotometricInterpretation": 32803,
            "SamplesPerPixel": 1,
        }
        if floating:
            tags["SampleFormat"] = 3
        if tiled:
            return tags | {"TileWidth": columns, "TileLength": rows, "TileOffsets": places, "TileByteCounts": lengths}
        return tags | {"RowsPerStrip": rows, "StripOffsets": places, "StripByteCounts": lengths}

    def part(self, values, directory):
        if directory.compression == 7:
            return lossless_jpeg(values, **({"bits": directory.bits} | directory.jpeg))
        if values.dtype.kind == "f":
            return floats(values, directory.bits, self.order)
        return integers(values, directory.bits, self.order)


def dng(directories, order="<", big=False, cuts=None):
    """A file of a chain of directories; `cuts` collects the places at which it may be cut."""
    writer = Writer(order, big)
    link = 8 if big else 4
    for directory in directories:
        at, following = writer.directory(directory)
        writer.pointer(link, at)
        link = following
    if cuts is not None:
        cuts += writer.cuts
    return bytes(writer.data)


def integers(values, bits, order):
    """Words of the byte order; other depths packed, the first pixel in the upper bits, each row in whole bytes."""
    if bits in (8, 16, 32):
        return values.astype(f"{order}u{bits // 8}").tobytes()
    shifts = np.arange(bits - 1, -1, -1)
    planes = (values.astype(np.int64)[..., None] >> shifts & 1).astype(np.uint8)
    return np.packbits(planes.reshape(values.shape[0], -1), axis=1).tobytes()


def floats(values, bits, order):
    if bits != 24:
        return values.astype(f"{order}f{bits // 8}").tobytes()
    words = np.array([fp24(float(v)) for v in values.ravel()], dtype=">u4")
    three = words.view(np.uint8).reshape(-1, 4)[:, 1:]
    return (three if order == ">" else three[:, ::-1]).tobytes()


def fp24(value):
    """1 bit of sign, 7 of exponent (63 is 2^0), 16 of mantissa."""
    if value == 0:
        return 0
    mantissa, exponent = np.frexp(abs(value))
    whole = round((2 * float(mantissa) - 1) * 65536)
    return (0x800000 if value < 0 else 0) | ((int(exponent) - 1 + 63) << 16) + whole


def from_fp24(word):
    sign, exponent, mantissa = word >> 23, word >> 16 & 127, word & 65535
    return (-1) ** sign * (mantissa / 65536 * 2.0**-62 if exponent == 0 else (1 + mantissa / 65536) * 2.0 ** (exponent - 63))


def lossless_jpeg(values, bits, components=2, predictor=1, restart=0, fold=1, old=False):
    """Lossless Huffman JPEG (ITU-T T.81, process 14). Two components side by side put each colour of a row into one of
    them; `fold` rows of the picture are one of the stream."""
    values = values.reshape(values.shape[0] // fold, -1)
    height, width = values.shape
    samples = values.astype(np.int64).reshape(height, width // components, components)
    segment = lambda mark, data: struct.pack(">HH", 0xFF00 | mark, len(data) + 2) + data
    ids = range(components)
    frame = struct.pack(">BHHB", bits, height, width // components, components) + b"".join(bytes([i, 0x11, 0]) for i in ids)
    # Seventeen categories with codes of five bits.
    table = bytes([0]) + bytes([0, 0, 0, 0, 17] + [0] * 11) + bytes(range(17))
    scan = bytes([components]) + b"".join(bytes([i, 0]) for i in ids) + bytes([predictor, 0, 0])
    head = b"\xff\xd8" + segment(0xC3, frame) + segment(0xC4, table)
    if restart:
        head += segment(0xDD, struct.pack(">H", restart))
    return head + segment(0xDA, scan) + scan_data(samples, bits, predictor, restart, old) + b"\xff\xd9"


def scan_data(samples, bits, predictor, restart, old):
    height, columns, components = samples.shape
    out, text = bytearray(), []

    def flush():
        joined = "".join(text)
        joined += "1" * (-len(joined) % 8)
        for at in range(0, len(joined), 8):
            byte = int(joined[at : at + 8], 2)
            out.append(byte)
            if byte == 0xFF:
                out.append(0)
        text.clear()

    unit, first_row = 0, 0
    for row in range(height):
        for column in range(columns):
            begins = restart and unit and unit % restart == 0
            if begins:
                flush()
                out.extend([0xFF, 0xD0 + (unit // restart - 1) % 8])
                first_row = row
            for component in range(components):
                value = int(samples[row, column, component])
                if begins or (row == first_row and column == 0):
                    predicted = 1 << (bits - 1)
                elif row == first_row:
                    predicted = int(samples[row, column - 1, component])
                elif column == 0:
                    predicted = int(samples[row - 1, column, component])
                else:
                    left, above = int(samples[row, column - 1, component]), int(samples[row - 1, column, component])
                    corner = int(samples[row - 1, column - 1, component])
                    predicted = [
                        0,
                        left,
                        above,
                        corner,
                        left + above - corner,
                        left + (above - corner >> 1),
                        above + (left - corner >> 1),
                        left + above >> 1,
                    ][predictor]
                difference = (value - predicted + 32768) % 65536 - 32768
                if difference == -32768:
                    text.append(f"{16:05b}" + (f"{0x7FFF:016b}" if old else ""))
                    continue
                category = abs(difference).bit_length()
                text.append(f"{category:05b}")
                if category:
                    low = difference if difference > 0 else difference + (1 << category) - 1
                    text.append(f"{low:0{category}b}")
            unit += 1
    flush()
    return bytes(out)


def area(top, left, bottom, right, plane=0, planes=1, row_pitch=1, column_pitch=1):
    return struct.pack(">8I", top, left, bottom, right, plane, planes, row_pitch, column_pitch)


def opcode(number, data, optional=False, version=(1, 3, 0, 0)):
    return struct.pack(">I4BII", number, *version, int(optional), len(data)) + data


def opcode_list(*opcodes):
    return struct.pack(">I", len(opcodes)) + b"".join(opcodes)
