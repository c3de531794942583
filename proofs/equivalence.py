"""Whether a changed module is no other circuit: from registers at zero on, whatever the inputs are in each cycle, resets among them, its outputs are
the same in both, with the parameters of each of its instances. Memories inside are cut off: what goes to them counts as an output, what comes from them as an input. ABC proves it (signal
correspondence, then property-directed reachability). A module with several clocks is not decided.
"""

import pathlib
import re

# Modules that hold memories or images: cut off.
CUT = re.compile(r"ram_style|readmemh")


def parts_of(text, known):
    """The modules that a text has instances of."""
    return [part for part in re.findall(r"^\s*(\w+) (?:#\(|\w+ \()", text, re.MULTILINE) if part in known]


def stub(text):
    """A module's ports alone."""
    return re.search(r"^module\s.*?\);\s*$", re.sub(r"//[^\n]*", "", text), re.DOTALL | re.MULTILINE)[0] + "\nendmodule\n"


def sizes(module, texts):
    """The parameters of each instance of a module, those that its parent hands down among them; nothing if one of them is a formula."""
    found = set()
    for parent, text in texts.items():
        instances = list(re.finditer(rf"^\s*{module} (?:#\((.*?)\)\s+)?\w+ \(", text, re.DOTALL | re.MULTILINE))
        for above in (sizes(parent, texts) or ()) if instances else ():
            for at in instances:
                said = re.sub(r"//[^\n]*", "", at[1] or "")
                given = re.findall(r"\.(\w+)\(([^()]*)\)", said)
                if len(given) < len(re.findall(r"\.\w+\(", said)):
                    return None
                numbers = tuple((name, dict(above).get(value, value)) for name, value in given if not value.startswith('"'))
                if not all(re.fullmatch(r"\d+('[dhb][0-9a-f]+)?", value) for _, value in numbers):
                    return None
                found.add(numbers)
    return found or {()}


def script(module, size):
    """Yosys's commands from `gold.v` and `gate.v` to a circuit with one output, which is high where they differ."""
    lines = []
    parameters = "".join(f" -chparam {name} {value}" for name, value in size)
    for side in ("gold", "gate"):
        lines += [f"read_verilog -DSYNTHESIS {side}.v parts.v", "read_verilog -lib cut.v",
                  f"hierarchy{parameters} -top {module}; rename -top {side}; proc; flatten; opt_clean; expose -evert */c:*; memory_map; opt_clean; design -stash {side}"]
    lines += [f"design -copy-from {side} -as {side} {side}" for side in ("gold", "gate")]
    lines += ["miter -equiv -flatten gold gate miter", "hierarchy -top miter", "opt -full; techmap; opt; setundef -zero -undriven; setundef -init -zero",
              "dffunmap; opt_clean; abc -g AND -fast; opt_clean", "write_aiger -zinit miter.aig"]
    return "\n".join(lines) + "\n"


def is_equivalent(sources, file, text, run, folder, seconds):
    """`run(command, folder, said, limit)` runs a command, whose output goes to `said`; nothing that it does not decide in time is equivalent."""
    texts = {path.stem: path.read_text() for path in pathlib.Path(sources).glob("*.v")}
    module = file.removesuffix(".v")
    cut, parts, left, seen = "", "", [module], {module}
    while left:
        for part in parts_of(texts[left.pop()], texts):
            if part in seen:
                continue
            seen.add(part)
            if CUT.search(texts[part]):
                cut += stub(texts[part])
            else:
                parts += re.sub(r"`default_nettype \w+", "", texts[part])
                left.append(part)
    for name, content in [("gold.v", texts[module]), ("gate.v", text), ("parts.v", parts), ("cut.v", cut)]:
        (folder / name).write_text(content)
    every = sizes(module, texts)
    return every is not None and all(is_same(module, size, run, folder, seconds) for size in every)


def is_same(module, size, run, folder, seconds):
    """Whether both are the same circuit with these parameters."""
    (folder / "miter.ys").write_text(script(module, size))
    with open(folder / "said", "w+") as said:
        if run(["yosys", "-q", "miter.ys"], folder, said, seconds) != 0:
            return False
        run(["yosys-abc", "-c", f"read_aiger miter.aig; scorr; pdr -T {seconds:.0f}"], folder, said, 2 * seconds)
        said.seek(0)
        return "Property proved" in said.read()
