"""The bench of a generated directory's core, its memory taken out: what stands at the memory's port is `axiram.py`.

    python3 bench.py FOLDER OUT

Reads FOLDER/sim/core_bench.sv, writes OUT. Camera, screen, host and every check stay those of the bench; the port's signals get the names that
cocotbext-axi looks for.
"""

import re
import sys
from pathlib import Path

WIDTHS = {"id": 1, "addr": 32, "len": 8, "size": 3, "burst": 2, "strb": 64, "data": 512, "resp": 2, "last": 1, "valid": 1, "ready": 1}


def one(pattern, replacement, text):
    """Replaces what must be there exactly once."""
    text, count = re.subn(pattern, replacement, text, flags=re.S)
    if count != 1:
        sys.exit(f"core_bench.sv: {count} places like {pattern!r}, 1 is expected")
    return text


def main(folder, out):
    text = (Path(folder) / "sim/core_bench.sv").read_text()
    declared, pins = [], {}
    for bundle, channel, field, way in re.findall(r"\.dram_(write|read)_(aw|w|b|ar|r)_(\w+?)_([io])\(", text):
        name, bits = f"m_axi_{channel}{field}", WIDTHS[field]
        kind = "reg" if way == "i" else "wire"
        declared.append(f"    {kind} [{bits - 1}:0] {name}{' = 0' if way == 'i' else ''};")
        pins[f"dram_{bundle}_{channel}_{field}_{way}"] = name
    text = one(r"    // Memory, writes:.*?\n(    wire screen_hs)", "\n".join(declared).replace("\\", "") + r"\n    reg passed = 1'b0;\n    reg failed = 1'b0;\n\n\1", text)
    for pin, name in pins.items():
        text = one(rf"\.{pin}\((?:[^()]|\([^()]*\))*\)", f".{pin}({name})", text)
    text = text.replace("$finish;", "passed = 1'b1;").replace('$fatal(1, "FAIL");', "failed = 1'b1;")
    # Room for a memory that is late: a picture may be shown again, and frames come more slowly than they would have to.
    text = one(r"\(FRAMES \+ 6\) \* CYCLES", "(FRAMES + 60) * CYCLES", text)
    Path(out).write_text(text)


main(*sys.argv[1:])
