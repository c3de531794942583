#!/usr/bin/env python3
"""Mutants of the circuit: small faults in its Verilog, each of which a test must see.

Without --draw those of mutants.json, each with the test that must see it. With --draw as many as are asked for, at random: what may see one is the
bench of the calculator (`bench`), then the quick tests of `circuits` that simulate its block, then the proofs of the blocks that it is in, then a
co-simulation with stalls and random contents at the start, where skipping of zeros is on and off (`cosim`), then, with --core, the bench of the whole
core. A mutant that nothing sees is equivalent if that is proven (equivalence.py) or equivalent-mutants.json gives the reason; what is left is listed as survived.

What was drawn on one revision is kept in its folder under --out: a run that was stopped goes on, and the score is that of all runs. Exit status 1 if
less than 95 % of a block's were seen, or one that is listed as equivalent was.
"""

import argparse
import concurrent.futures
import collections
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import equivalence
import prove
from circuit_tests import CircuitTests, module

HERE = pathlib.Path(__file__).parent
# Share of a block's mutants that must be seen.
LEAST = 0.95
# What is no part of a circuit's behaviour: comments, declarations, ports, parameters, memory images, checks of the simulation.
SKIPPED = re.compile(r"^\s*(//|`|\(\*|input |output |inout |module |endmodule|reg [^=]*;|wire [^=]*;|integer |initial|parameter |genvar |"
                     r"for |localparam [^=]*\b(INIT|IMAGE)|wire unused|generate|endgenerate|begin|end\b|\)|#?\(|if \(image)|\$fatal|\$fopen|\$fclose|\$readmem|INIT")
NUMBER = re.compile(r"\b(\d+)'([dhb])([0-9a-f]+)\b")
# Name, what is found, what takes its place.
SWAPS = [("and-or", " && ", " || "), ("or-and", " || ", " && "), ("equal-unlike", " == ", " != "), ("unlike-equal", " != ", " == "),
         ("plus-minus", " + ", " - "), ("minus-plus", " - ", " + "), ("above-from", " > ", " >= "), ("from-above", " >= ", " > "),
         ("below-upto", " < ", " <= "), ("left-right", " << ", " >> "), ("right-left", " >> ", " << "), ("bits-and-or", " & ", " | "),
         ("bits-or-and", " | ", " & "), ("xor-or", " ^ ", " | ")]


def closing(code, at):
    """Behind the bracket that closes the one before `at`."""
    depth = 1
    while depth and at < len(code):
        depth += {"(": 1, ")": -1}.get(code[at], 0)
        at += 1
    return at


def sites(text):
    """Every mutant of a module: name of the operator, line, mutated line."""
    found = []
    for number, line in enumerate(text.split("\n")):
        code, slashes, comment = line.partition("//")
        if SKIPPED.search(code) or not code.strip():
            continue
        rest = slashes + comment

        def add(name, mutated):
            if mutated != code:
                found.append((name, number, mutated + rest))

        for name, old, new in SWAPS:
            for at in re.finditer(re.escape(old), code):
                add(name, code[:at.start()] + new + code[at.end():])
        for at in re.finditer(r"!(?=[\w(])", code):
            add("no-not", code[:at.start()] + code[at.end():])
        for at in NUMBER.finditer(code):
            bits, base, digits = int(at[1]), at[2], at[3]
            value = int(digits, {"d": 10, "h": 16, "b": 2}[base])
            if bits <= 64:
                add("off-by-one", f"{code[:at.start()]}{bits}'d{(value + 1) % (1 << bits)}{code[at.end():]}")
        for at in re.finditer(r"\bif \(", code):
            end = closing(code, at.end())
            add("always", f"{code[:at.start()]}if (1'b1){code[end:]}")
            add("never", f"{code[:at.start()]}if (1'b0){code[end:]}")
        for at in re.finditer(r"\? (\(.*?\)|[^?:()]+) : (\(.*\)|[^?:()]+)(?=;|\))", code):
            add("swapped-choice", f"{code[:at.start()]}? {at[2]} : {at[1]}{code[at.end():]}")
        at = re.fullmatch(r"(\s*(?:if \(.*\) |else |else if \(.*\) |\d+'d\d+: )?)([\w\[\]:]+ (<=|=) .*;)\s*", code)
        if at and not code.strip().startswith(("assign", "wire", "localparam")):
            add("dropped", f"{at[1]};")
        # A register less in a row of registers that are cleared together, `{a_q, b_q} <= 0;`, or in one line of it.
        at = re.fullmatch(r"(\s*(?:if \(.*\) |else )?\{?)(\w+_q(?:, \w+_q)+)(,|\} <= 0;)\s*", code)
        for name in at[2].split(", ") if at else []:
            add("uncleared", at[1] + ", ".join(other for other in at[2].split(", ") if other != name) + at[3])
        for at in re.finditer(r"\[(\d+)\]", code):
            if int(at[1]) > 0:
                add("bit-below", f"{code[:at.start()]}[{int(at[1]) - 1}]{code[at.end():]}")
    return found


class Mutant:
    """A fault in one file, which changes the line `was`, the `place`th of its kind, to `line`. `site` is its number among all that the file may have."""

    def __init__(self, name, file, text, what, was=None, place=None, line=None, site=None):
        self.name, self.file, self.text, self.what = name, file, text, what
        self.was, self.place, self.line, self.site = was, place, line, site

    def of_size(self, original, other):
        """The same fault in the text that the module has for a frame of another size, which has other numbers and else the same lines."""
        places, others = sites(original), sites(other)
        if [row[:2] for row in places] != [row[:2] for row in others]:
            sys.exit(f"mutants.py: {self.file} has other lines under sim/rtl than under rtl")
        _, number, line = others[self.site]
        lines = other.split("\n")
        lines[number] = line
        return "\n".join(lines)


def run(command, folder, said, limit=None):
    """The exit status of a command, nothing if it took too long; what it says goes to a file. It ends with this program (prove.stop)."""
    child = subprocess.Popen(command, cwd=folder, stdout=said, stderr=subprocess.STDOUT, start_new_session=True)
    prove.RUNNING.add(child.pid)
    try:
        return child.wait(limit)
    except subprocess.TimeoutExpired:
        return None
    finally:
        prove.end_session(child.pid)
        child.wait()
        prove.RUNNING.discard(child.pid)


def bench_of(generated, mutant, bench, limit, out):
    """Whether a bench of the generated directory sees the mutant."""
    with tempfile.TemporaryDirectory(dir=out) as folder:
        folder = pathlib.Path(folder)
        (folder / "mem").symlink_to(generated / "mem")
        shutil.copytree(generated / "sim", folder / "sim", copy_function=os.symlink)
        (folder / "rtl").mkdir()
        files = (generated / "sim" / f"{bench}.f").read_text().split()
        for file in files:
            if file == f"rtl/{mutant.file}":
                (folder / file).write_text(mutant.text)
            elif file.startswith("rtl/"):
                (folder / file).symlink_to(generated / file)
            elif file == f"sim/rtl/{mutant.file}":
                replaced = folder / file
                text = mutant.of_size((generated / "rtl" / mutant.file).read_text(), replaced.read_text())
                replaced.unlink()
                replaced.write_text(text)
        with open(folder / "said", "w+") as said:
            command = ["iverilog", "-g2012", "-Wno-timescale", "-s", f"edof_{bench}", "-o", "bench", "-c", f"sim/{bench}.f"]
            if run(command, folder, said):
                return True
            # A mutant may stand still in one instant.
            said.seek(0)
            said.truncate()
            run(["vvp", "-n", "bench"], folder, said, limit)
            said.seek(0)
            return "PASS" not in said.read(1 << 20)


def is_verilog(generated, mutant, out):
    """Whether Icarus takes the file."""
    with tempfile.TemporaryDirectory(dir=out) as folder:
        folder = pathlib.Path(folder)
        (folder / mutant.file).write_text(mutant.text)
        others = sorted(path for path in (generated / "rtl").glob("*.v") if path.name != mutant.file)
        with open(folder / "said", "w") as said:
            command = ["iverilog", "-g2012", "-Wno-timescale", "-t", "null", "-s", mutant.file.removesuffix(".v"), mutant.file, *others]
            return run(command, folder, said) == 0


# What a co-simulation draws: stalls, start-up contents, windows with extreme values or a picture's, and whether zeros are skipped.
COSIMS = [["--patches", "24", "--stalls", "0.3", "--seed", "1"], ["--random", "24", "--stalls", "0.6", "--seed", "2", "--skip", "off"]]


def cosim_of(options, mutant, limit, out):
    """Whether `edof cosim` sees the mutant: words and cycles at every boundary, and the counters. What Verilator does not take is seen, too."""
    with tempfile.TemporaryDirectory(dir=out) as folder:
        folder = pathlib.Path(folder)
        shutil.copytree(options.generated / "rtl", folder / "rtl")
        (folder / "rtl" / mutant.file).write_text(mutant.text)
        for draw in COSIMS:
            command = [options.edof.resolve(), "cosim", "-q", "--design", "tiny", "--weights", options.weights.resolve(), "--rtl", folder / "rtl", *draw]
            with open(folder / "said", "w") as said:
                if run(command, folder, said, limit) != 0:
                    return True
    return False


def proof_of(generated, mutant, task, out, patience):
    """Whether a proof sees the mutant, to the depth of its broken copies."""
    with tempfile.TemporaryDirectory(dir=out) as folder:
        sources = pathlib.Path(folder) / "rtl"
        shutil.copytree(generated / "rtl", sources)
        (sources / mutant.file).write_text(mutant.text)
        _, _, how = prove.run(task, "bmc", sources, pathlib.Path(folder), {"name": "mutant", "file": None}, patience)
        return how.startswith("FAIL")


def changed(name, file, old, new, what, site=None):
    """The mutant that changes one line of a text."""
    before, after = old.split("\n"), new.split("\n")
    number = next(number for number, line in enumerate(before) if line != after[number])
    return Mutant(name, file, new, what, before[number], before[:number].count(before[number]), after[number], site)


def curated(generated):
    """Those of mutants.json."""
    for row in json.loads((HERE / "mutants.json").read_text()):
        old = (generated / "rtl" / row["file"]).read_text()
        new, count = re.subn(row["pattern"], lambda _: row["new"], old)
        if count != 1:
            sys.exit(f"mutants.py: '{row['pattern']}' stands {count} times in {row['file']}, not once")
        yield changed(row["name"], row["file"], old, new, row["new"]), row["seen_by"]


def equivalents(generated):
    """Why a mutant of equivalent-mutants.json, by its block and what it changes, can be seen by nothing; each must be one that can be drawn."""
    texts = {module(path.name): path.read_text() for path in (generated / "rtl").glob("*.v")}
    reasons = {}
    for row in json.loads((HERE / "equivalent-mutants.json").read_text()):
        text = texts[row["block"]]
        before = text.split("\n")
        if not any(f"{before[number].strip()} -> {line.strip()}" == row["what"] for _, number, line in sites(text)):
            sys.exit(f"mutants.py: equivalent-mutants.json: {row['block']} has no mutant '{row['what']}'; correct it or take it out")
        reasons[row["block"], row["what"]] = row["why"]
    return reasons


def drawn(generated, blocks, seed):
    """One after the other, each block as often as it has places for a fault."""
    draw = random.Random(seed)
    places = []
    for file in sorted(blocks):
        text = (generated / "rtl" / file).read_text()
        places += [(file, site, *fault) for site, fault in enumerate(sites(text))]
    draw.shuffle(places)
    for file, site, operator, number, line in places:
        lines = (generated / "rtl" / file).read_text().split("\n")
        old, was, lines[number] = "\n".join(lines), lines[number], line
        yield changed(f"{file}:{number + 1}:{operator}", file, old, "\n".join(lines), f"{was.strip()} -> {line.strip()}", site)


class Judges:
    """What there is to see a mutant."""

    def __init__(self, options, out):
        self.generated, self.out, self.patience, self.core = options.generated.resolve(), out, options.patience, options.core
        self.limit, self.options = options.limit, options
        table = json.loads((HERE / "proofs.json").read_text())
        self.tasks = {task["name"]: task for task in table}
        self.of_file = collections.defaultdict(list)
        for task in table:
            if not task.get("long"):
                for file in task["files"]:
                    if not (HERE / file).exists():
                        self.of_file[file].append(task["name"])
        self.in_bench = {"bench": self.below("chain"), "core_bench": self.below("edof_core")}
        self.circuits = CircuitTests(run, self.generated / "rtl", out / "tests.json", options.jobs)

    def below(self, top):
        """The files of a module and of all its parts."""
        texts = {path.stem: path.read_text() for path in (self.generated / "rtl").glob("*.v")}
        found, left = set(), [top]
        while left:
            module_ = left.pop()
            if module_ not in found:
                found.add(module_)
                left += [part for part in re.findall(r"^\s*(\w+) (?:#\(|\w+ \()", texts[module_], re.MULTILINE) if part in texts]
        return {f"{name}.v" for name in found}

    def sees(self, name, mutant, folder=None):
        if "::" in name:
            return self.circuits.sees(name, mutant, folder)
        if name in self.in_bench:
            return bench_of(self.generated, mutant, name, self.limit * (40 if name == "core_bench" else 1), self.out)
        if name == "cosim":
            return cosim_of(self.options, mutant, 4 * self.limit, self.out)
        return proof_of(self.generated, mutant, self.tasks[name], self.out, self.patience)

    def sees_alone(self, name, mutant):
        with tempfile.TemporaryDirectory(dir=self.out) as folder:
            return self.sees(name, mutant, pathlib.Path(folder))

    def names(self, file):
        """Who judges the mutants of a file, the quickest first."""
        in_chain, in_core = (file in self.in_bench[bench] for bench in ("bench", "core_bench"))
        quick = (["bench"] if in_chain else []) + self.circuits.of(file, 600 * self.patience) + self.of_file[file]
        return quick + (["cosim"] if in_chain else []) + (["core_bench"] if self.core and in_core else [])

    def verdict(self, mutant):
        """By what it is seen, or what else becomes of it."""
        if not is_verilog(self.generated, mutant, self.out):
            return "no Verilog"
        with tempfile.TemporaryDirectory(dir=self.out) as folder:
            folder = pathlib.Path(folder)
            for name in self.names(mutant.file):
                if self.sees(name, mutant, folder):
                    return f"seen by {name}"
            same = equivalence.is_equivalent(self.generated / "rtl", mutant.file, mutant.text, run, folder, 60 * self.patience)
            return "equivalent" if same else "survived"


class Drawn:
    """The mutants that were drawn on a revision, with the verdict of each; a file of lines of JSON has them."""

    def __init__(self, path):
        self.path, self.lock = path, threading.Lock()
        self.rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []

    def known(self, mutant):
        """The verdict of a mutant that was drawn before."""
        return next((row["verdict"] for row in self.rows if (row["name"], row["what"]) == (mutant.name, mutant.what)), None)

    def add(self, mutant, verdict):
        row = {"name": mutant.name, "block": module(mutant.file), "what": mutant.what, "verdict": verdict}
        with self.lock, self.path.open("a") as file:
            file.write(json.dumps(row) + "\n")
            self.rows.append(row)

    def score(self, out, reasons):
        """A table by block, and whoever survived; whether it is enough. `reasons` are those of the equivalent ones."""
        blocks, by = collections.defaultdict(collections.Counter), collections.Counter()
        survived, equivalent, wrong = [], [], []
        for row in self.rows:
            verdict, judge = (row["verdict"].split(" by ") + [None])[:2]
            why = reasons.get((row["block"], row["what"]))
            if verdict == "survived":
                verdict = "equivalent" if why else "survived"
                (equivalent if why else survived).append(f"`{row['name']}`: `{row['what']}`" + (f": {why}" if why else ""))
            elif why and verdict == "seen":
                wrong.append(f"`{row['name']}`: `{row['what']}` by {judge}")
            if verdict != "no Verilog":
                blocks[row["block"]][verdict] += 1
            if judge:
                by["a test of circuits" if "::" in judge else judge] += 1
        total = sum(blocks.values(), collections.Counter())
        lines = ["| block | drawn | seen | equivalent | survived |", "|---|---|---|---|---|"]
        for name, count in [*((f"`{block}`", count) for block, count in sorted(blocks.items())), ("all", total)]:
            lines.append(f"| {name} | {sum(count.values())} | {count['seen']} | {count['equivalent']} | {count['survived']} |")
        share = {block: count["seen"] / max(1, count["seen"] + count["survived"]) for block, count in [*blocks.items(), ("all", total)]}
        lines += ["", f"{total['seen']} of {total['seen'] + total['survived']} that are no equivalents were seen, {100 * share['all']:.1f} %: "
                  + ", ".join(f"{count} by {name}" for name, count in by.most_common()) + "."]
        lines += [f"- survived: {what}" for what in survived] + [f"- equivalent by its reason: {what}" for what in equivalent]
        lines += [f"- listed as equivalent, but seen: {what}" for what in wrong]
        (out / "score.md").write_text("\n".join(lines) + "\n")
        print("\n".join(lines), flush=True)
        # A block of which nothing but equivalents was drawn has no share.
        weak = [block for block, count in blocks.items() if count["survived"] and share[block] < LEAST]
        return not weak and not wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--generated", type=pathlib.Path, required=True, help="directory that `edof generate --design tiny` wrote")
    parser.add_argument("--edof", type=pathlib.Path, required=True, help="the program")
    parser.add_argument("--weights", type=pathlib.Path, required=True, help="the network that the directory was generated with")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for what is made on the way, and for score.md")
    parser.add_argument("--draw", type=int, metavar="N", help="draw N mutants in place of those of mutants.json")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--core", action="store_true", help="the bench of the whole core, too: a minute for each that is left")
    parser.add_argument("--limit", type=float, default=60, help="seconds for a run of the bench of the calculator")
    parser.add_argument("--patience", type=float, default=1, help="times as long before a proof is given up")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("block", nargs="*", help="only mutants of these blocks")
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    judges = Judges(options, out)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, prove.stop)
    # What the original does not pass in time would see every mutant.
    file = "chain.v"
    for name in ["bench"] if options.draw is None else ["bench", "cosim"]:
        if judges.sees(name, Mutant("none", file, (judges.generated / "rtl" / file).read_text(), "")):
            sys.exit(f"mutants.py: {name} does not pass without a fault in time; give it longer than {options.limit:.0f} s by --limit")
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        reasons = equivalents(judges.generated)
        test_table(judges, options, pool) if options.draw is None else test_drawn(judges, options, pool, reasons)


def test_table(judges, options, pool):
    """Each mutant of mutants.json by the test that must see it."""
    start = time.monotonic()
    rows = [row for row in curated(judges.generated) if not options.block or row[0].file.removesuffix(".v") in options.block]
    waiting = {pool.submit(judges.sees_alone, by, mutant): (mutant, by) for mutant, by in rows}
    missed = 0
    for job in concurrent.futures.as_completed(waiting):
        mutant, by = waiting[job]
        missed += not job.result()
        print(f"{'seen  ' if job.result() else 'MISSED'} {mutant.name} in {mutant.file} by {by}", flush=True)
    if missed:
        sys.exit(f"{missed} of {len(rows)} mutants were not seen")
    print(f"all {len(rows)} mutants were seen in {time.monotonic() - start:.0f} s")


def test_drawn(judges, options, pool, reasons):
    """As many mutants at random as are asked for. What is no Verilog any more is drawn again."""
    files = {path.name for path in (judges.generated / "rtl").glob("*.v")}
    wanted = {f"{block}.v" for block in options.block} or files
    source = drawn(judges.generated, {file for file in wanted & files if judges.names(file)}, options.seed)
    kept, count = Drawn(judges.out / "drawn.jsonl"), 0

    def one(mutant):
        verdict = kept.known(mutant)
        if verdict is None:
            verdict = judges.verdict(mutant)
            kept.add(mutant, verdict)
            print(f"{verdict}: {mutant.name}: {mutant.what}", flush=True)
        return verdict

    while count < options.draw:
        batch = [mutant for mutant, _ in zip(source, range(options.draw - count))]
        if not batch:
            break
        count += sum(verdict != "no Verilog" for verdict in pool.map(one, batch))
    if not kept.score(judges.out, reasons):
        sys.exit(1)


if __name__ == "__main__":
    main()
