"""From a raw frame to the codes on the wire: a second implementation, written from docs/contract.md alone.

Section numbers are that page's. Sums are formed in float64 where that is exact: all of them are whole and below 2^48.
"""

import hashlib
import json
import struct
from dataclasses import dataclass

import numpy as np

RED_SITE = {"rggb": (0, 0), "grbg": (0, 1), "gbrg": (1, 0), "bggr": (1, 1)}


def saturate(values, bits):
    return np.clip(values, -(1 << (bits - 1)), (1 << (bits - 1)) - 1)


def rounded(values, shift):
    return values if shift == 0 else (values + (1 << (shift - 1))) >> shift


def requantize(values, shift, bits):
    """The words, and how many did not fit."""
    whole = rounded(values, shift)
    words = saturate(whole, bits)
    return words, int(np.count_nonzero(words != whole))


def mirror(index, length):
    index = np.abs(index)
    return np.where(index >= length, 2 * (length - 1) - index, index)


def least_side(window):
    return 8 + (window - 8) // 2 + 2


# 1. The raw frame


def raw_words(values, depth):
    return values.astype(np.int64) << (16 - depth)


# 1.1 On the cable


def encoded(words, values):
    """Words as a sender encodes them for a network of such values."""
    if values == "linear":
        return words
    return np.minimum(np.floor(65536 * curve(values, words / 65536) + 0.5), 65535).astype(np.int64)


def decoded(values, value):
    """The light of values: IEC 61966-2-1."""
    if values == "linear":
        return value
    return np.where(value <= 0.04045, value / 12.92, ((np.maximum(value, 0) + 0.055) / 1.055) ** 2.4)


def playout(words):
    """The bytes of a 2vuy file: Cb Y Cr Y."""
    luma, chroma = (words >> 9) + 64, ((words >> 2) & 127) + 64
    return np.stack([chroma, luma], axis=2).astype(np.uint8).tobytes()


def carried(words):
    """Words as the board gets them."""
    codes = np.frombuffer(playout(words), np.uint8).reshape(*words.shape, 2).astype(np.int64)
    if ((codes < 64) | (codes > 191)).any():
        raise ValueError("a code outside of 64...191")
    return (codes[..., 1] - 64) * 2**9 + (codes[..., 0] - 64) * 2**2


# 1.2 Red first


def red_first(words, phase):
    """Raw pixel words of the enlarged frame."""
    (height, width), (dr, dc) = words.shape, RED_SITE[phase]
    rows = mirror(np.arange(height + 2 * dr) - dr, height)
    columns = mirror(np.arange(width + 2 * dc) - dc, width)
    return words[np.ix_(rows, columns)]


# 2. Windows


def starts(length, stride):
    count = -((length + 8 - stride) // -stride)
    return np.arange(count) * stride - (8 - stride)


def windows(pixels, window, stride):
    """y: patches along rows × along columns × window²."""
    height, width = pixels.shape
    margin = (window - 8) // 2
    inside = np.arange(window) - margin
    rows = mirror(starts(height, stride)[:, None] + inside, height)
    columns = mirror(starts(width, stride)[:, None] + inside, width)
    blocks = pixels[rows[:, None, :, None], columns[None, :, None, :]] >> 1
    return blocks.reshape(len(rows), len(columns), window * window)


# 3. The network


@dataclass
class Network:
    form: dict
    fixed: dict
    tensors: dict
    values: str

    @classmethod
    def load(cls, path):
        with open(path, "rb") as file:
            content = file.read()
        (length,) = struct.unpack_from("<Q", content)
        header = json.loads(content[8 : 8 + length])
        data = content[8 + length :]
        text = header.pop("__metadata__")["edof"]
        metadata = json.loads(text)
        tensors, digest = {}, hashlib.sha256()
        assert metadata["layout"] == 2, f"{path}: layout {metadata['layout']}"
        before, after = text.rsplit(metadata["sha256"], 1)
        digest.update((before + "0" * 64 + after).encode())
        for name in sorted(header, key=str.encode):
            entry = header[name]
            begin, end = entry["data_offsets"]
            assert entry["dtype"] == "I16", f"{path}: {name} is {entry['dtype']}"
            tensors[name] = np.frombuffer(data[begin:end], "<i2").reshape(entry["shape"]).astype(np.int64)
            digest.update(f"{name} I16 [{', '.join(map(str, entry['shape']))}]".encode() + data[begin:end])
        assert digest.hexdigest() == metadata["sha256"], f"{path}: hash"
        return cls(metadata["form"], metadata["fixed"], tensors, metadata["origin"].get("values", "linear"))

    def recurrent(self, layer):
        """S of M layer `layer` (0 first) and its fraction bits."""
        index = 0 if self.form["tied"] else layer
        return self.tensors[f"recurrent.{index}"], self.fixed["weight_fractions"]["recurrent"][index]


def product(matrix, vectors):
    return (vectors.astype(np.float64) @ matrix.astype(np.float64).T).astype(np.int64)


def shrink(b, theta, kind, bits):
    wide = {
        "two-sided": np.sign(b) * np.maximum(np.abs(b) - theta, 0),
        "one-sided": np.maximum(b - theta, 0),
        "firm": np.sign(b) * np.where(np.abs(b) >= 2 * theta, np.abs(b), np.maximum(2 * (np.abs(b) - theta), 0)),
    }[kind]
    z = saturate(wide, bits)
    return z, int(np.count_nonzero(z != wide))


def run(network, y):
    """Words at every boundary by name, and the counters of every stage."""
    form, fixed, bits = network.form, network.fixed, network.fixed["code_bits"]
    c, f = fixed["code_fractions"], fixed["weight_fractions"]
    difference = form["recurrence"] == "difference"
    last = form["layers"] - 2
    words, counters = {"y": y}, []
    z_before = None
    for t in range(form["layers"] - 1):
        if t == 0:
            acc, shift = product(network.tensors["analysis"], y), 15 + f["analysis"] - c[0]
        else:
            matrix, f_s = network.recurrent(t - 1)
            base, of_base = (words[f"b{t}"], c[t - 1]) if difference else (words["b1"], c[0])
            product_fraction = c[t - 1] + f_s
            acc = (base << (product_fraction - of_base)) + product(matrix, sent)
            shift = product_fraction - c[t]
        b, clipped_results = requantize(acc, shift, bits)
        z, clipped_codes = shrink(b, network.tensors[f"threshold.{t}"], form["shrinkage"], bits)
        sent, clipped_differences = z, 0
        words[f"b{t + 1}"], words[f"z{t + 1}"] = b, z
        if difference and t < last:
            wide = z - (0 if z_before is None else z_before)
            sent = saturate(wide, bits)
            clipped_differences = int(np.count_nonzero(sent != wide))
            words[f"v{t + 1}"] = sent
        z_before = z
        counters.append(
            {
                "layer": "I" if t == 0 else "M",
                "saturated_results": clipped_results,
                "saturated_codes": clipped_codes,
                "saturated_differences": clipped_differences,
                "nonzeros": int(np.count_nonzero(sent)),
            }
        )
    of_dictionary = c[last] + f["dictionary"]
    of_linear = 15 + f["linear_path"] if form["linear_path"] else of_dictionary
    fraction = max(of_dictionary, of_linear, 14)
    acc = product(network.tensors["dictionary"], sent) << (fraction - of_dictionary)
    if form["linear_path"]:
        acc = acc + (product(network.tensors["linear_path"], y) << (fraction - of_linear))
    words["f"], clipped = requantize(acc, fraction - 14, 16)
    counters.append(
        {
            "layer": "F",
            "saturated_results": clipped,
            "saturated_codes": 0,
            "saturated_differences": 0,
            "nonzeros": 0,
        }
    )
    return words, counters


def multiplications(network, patches, counters):
    form = network.form
    codes, pixels = form["codes"], form["window"] ** 2
    linear = 128 * pixels if form["linear_path"] else 0
    always = patches * (codes * pixels + linear)
    sent = [stage["nonzeros"] for stage in counters[:-1]]
    return {
        "dense": always + patches * ((form["layers"] - 2) * codes * codes + 128 * codes),
        "executed": always + codes * sum(sent[:-1]) + 128 * sent[-1],
    }


# 4. Overlap add


def overlap_add(f, stride, height, width):
    """Luma, Cb and Cr words, and how many sums did not fit."""
    rows, columns = f.shape[:2]
    top, left = starts(height, stride), starts(width, stride)
    blocks = [
        f[..., :64].reshape(rows, columns, 8, 8),
        f[..., 64:96].reshape(rows, columns, 8, 4),
        f[..., 96:].reshape(rows, columns, 8, 4),
    ]
    planes, clipped = [], 0
    for block, part in zip(blocks, (1, 2, 2)):
        # Room for what lies outside on all sides.
        border = 8
        sums = np.zeros((height + 2 * border + 8, width // part + 2 * border + 8), np.int64)
        for r in range(8):
            for k in range(block.shape[3]):
                at = np.ix_(top + r + border, left // part + k + border)
                sums[at] += block[:, :, r, k]
        sums = sums[border : border + height, border : border + width // part]
        plane = saturate(sums, 16)
        clipped += int(np.count_nonzero(plane != sums))
        planes.append(plane)
    return planes, clipped


# 5. Display


def curve(name, light):
    if name == "srgb":
        return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    if name == "bt709":
        return np.where(light < 0.018, 4.5 * light, 1.099 * light**0.45 - 0.099)
    return light


def doubled_chroma(chroma, columns):
    """Twice the chroma of every row at the given columns of its frame."""
    site = columns // 2
    right = np.where(columns % 2 == 0, site, np.minimum(site + 1, chroma.shape[1] - 1))
    return chroma[:, site] + chroma[:, right]


def wire(codes):
    return np.clip(codes, 1, 254)


def display(planes, phase, size, mode, gamma="srgb", values="linear"):
    """Y', Cb' and Cr' codes, and what could not be shown."""
    shown_as = (lambda value: value) if gamma == values else (lambda value: curve(gamma, decoded(values, value)))
    (dr, dc), (height, width) = RED_SITE[phase], size
    luma, cb, cr = (plane[dr : dr + height].astype(np.int64) for plane in planes)
    columns = np.arange(width) + dc
    luma = luma[:, columns]
    cb, cr = doubled_chroma(cb, columns), doubled_chroma(cr, columns)
    if mode == "luma":
        light = np.minimum(np.arange(32768) / 2.0**14, 1.0)
        table = np.floor(16 + 219 * shown_as(light) + 0.5).astype(np.int64)
        free = [128 + rounded(plane[:, ::2], 8) for plane in (cb, cr)]
        codes = [wire(plane) for plane in free]
        clamped = sum(int(np.count_nonzero(a != b)) for a, b in zip(free, codes))
        return [table[np.maximum(luma, 0)], *codes], {"clamped_chroma": clamped, "out_of_gamut": 0}
    table = np.floor(4095 * shown_as(np.arange(16384) / 2.0**14) + 0.5).astype(np.int64)
    red = ((luma << 17) + 58975 * cr + (1 << 16)) >> 17
    green = ((luma << 17) - 7015 * cb - 17531 * cr + (1 << 16)) >> 17
    blue = ((luma << 17) + 69491 * cb + (1 << 16)) >> 17
    light = np.stack([red, green, blue])
    outside = int(np.count_nonzero(((light < 0) | (light > 16384)).any(axis=0)))
    r, g, b = encoded = table[np.clip(light, 0, 16383)]
    y_code = 16 + ((11922 * r + 40107 * g + 4049 * b + (1 << 19)) >> 20)
    before = np.concatenate([encoded[:, :, 1:2], encoded[:, :, 1:-1:2]], axis=2)
    f_r, f_g, f_b = before + 2 * encoded[:, :, ::2] + encoded[:, :, 1::2]
    cb_code = 128 + ((-6572 * f_r - 22107 * f_g + 28679 * f_b + (1 << 21)) >> 22)
    cr_code = 128 + ((28679 * f_r - 26049 * f_g - 2630 * f_b + (1 << 21)) >> 22)
    return [wire(y_code), wire(cb_code), wire(cr_code)], {"clamped_chroma": 0, "out_of_gamut": outside}


def yuyv(codes):
    y, cb, cr = codes
    return np.stack([y[:, ::2], cb, y[:, 1::2], cr], axis=2).astype(np.uint8).tobytes()


def shown(codes):
    """What a sink makes of the codes: rows × columns × 3."""
    y, cb, cr = (plane.astype(np.int64) for plane in codes)
    columns = np.arange(y.shape[1])
    cb, cr = doubled_chroma(cb - 128, columns), doubled_chroma(cr - 128, columns)
    luma = 76309 * (y - 16) + (1 << 15)
    planes = [luma + 58745 * cr, luma - 6988 * cb - 17462 * cr, luma + 69219 * cb]
    return np.clip(np.stack(planes, axis=2) >> 16, 0, 255).astype(np.uint8)


# 6. The picture as RGB, of linear light


def linear_picture(planes, phase, size, most, values="linear"):
    """Samples of a picture file, 0…most."""
    (dr, dc), (height, width) = RED_SITE[phase], size
    luma, cb, cr = planes
    columns = np.arange(luma.shape[1])
    y = luma / 2.0**14

    def between(chroma):
        chroma = chroma / (1.75 * 2.0**14)
        site = columns // 2
        right = np.where(columns % 2 == 0, site, np.minimum(site + 1, chroma.shape[1] - 1))
        return 0.5 * (chroma[:, site] + chroma[:, right])

    cb, cr = between(cb), between(cr)
    red = y + 2 * (1 - 0.2126) * cr
    blue = y + 2 * (1 - 0.0722) * cb
    green = (y - 0.2126 * red - 0.0722 * blue) / 0.7152
    found = np.stack([red, green, blue], axis=2).astype(np.float32)[dr : dr + height, dc : dc + width]
    light = decoded(values, found).astype(np.float32)
    scaled = np.clip(light, np.float32(0), np.float32(1)) * np.float32(most)
    whole = np.floor(scaled)
    return (whole + (scaled - whole >= 0.5)).astype(np.uint16)
