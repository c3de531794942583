"""The tests of `circuits` (crates/edof-cosim/tests) as judges of a mutant: which of them simulate a module, and whether one of them fails."""

import concurrent.futures
import functools
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

CRATE = pathlib.Path(__file__).parent.parent / "crates" / "edof-cosim"

# Modules of a small circuit.
SMALL = 25

# Seconds after which a test with a mutant counts as failed: several times what the longest quick one takes.
LIMIT = 400


def module(file):
    """The module of a file without what its sizes add to its name, as edof-cosim's mutant.rs has it."""
    return re.sub(r"(_[ws]\d+)+$", "", file.removesuffix(".v"))


class CircuitTests:
    """The quick tests of the program, with the modules that each simulates. That is found out once: `kept` has it afterwards."""

    def __init__(self, run, sources, kept, jobs):
        self.run, self.kept = run, kept
        self.bytes = {module(path.name): path.stat().st_size for path in sources.glob("*.v")}
        build = ["cargo", "test", "-q", "--locked", "--workspace", "--test", "circuits", "--no-run", "--message-format", "json"]
        said = subprocess.run(build, cwd=CRATE, stdout=subprocess.PIPE, text=True, check=True).stdout
        built = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
        self.program = next(row["executable"] for row in built if row.get("executable") and row["target"]["name"] == "circuits")
        self.jobs = jobs

    @functools.cached_property
    def table(self):
        """Each test's seconds and modules."""
        if not self.kept.exists():
            self.kept.write_text(json.dumps(self.look(), indent=1))
        return json.loads(self.kept.read_text())

    def names(self, *options):
        said = subprocess.run([self.program, "--list", *options], stdout=subprocess.PIPE, text=True, check=True).stdout
        return {line.removesuffix(": test") for line in said.splitlines() if line.endswith(": test")}

    def look(self):
        """Seconds and modules of each test that simulates something."""
        def one(name):
            with tempfile.TemporaryDirectory() as folder:
                names = pathlib.Path(folder) / "modules"
                start = time.monotonic()
                if self.once(name, {"EDOF_MODULES": str(names)}, None) != 0:
                    raise SystemExit(f"mutants.py: the test {name} fails without a fault")
                modules = sorted(set(names.read_text().split())) if names.exists() else []
                return name, {"seconds": round(time.monotonic() - start, 2), "modules": modules}

        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            rows = dict(pool.map(one, sorted(self.names() - self.names("--ignored"))))
        return {name: row for name, row in rows.items() if row["modules"]}

    def compiling(self, modules):
        """About so many seconds it takes to compile a model of these modules."""
        return sum(self.bytes.get(name, 0) for name in modules) / 10_000

    def once(self, name, environment, limit):
        """The exit status of one test, nothing if it took too long."""
        with open(os.devnull, "w") as said:
            command = ["env", *[f"{key}={value}" for key, value in environment.items()], self.program, "--exact", name]
            return self.run(command, CRATE, said, limit)

    def of(self, file, seconds):
        """The tests that simulate a module, the shortest first: those of small circuits, and as many others as take so long together if the first of
        those with the same modules has to compile their model."""
        rows = sorted((row["seconds"] + self.compiling(row["modules"]), name) for name, row in self.table.items() if module(file) in row["modules"])
        chosen, compiled = [], set()
        for took, name in rows:
            modules = frozenset(self.table[name]["modules"])
            seconds -= self.table[name]["seconds"] if modules in compiled else took
            compiled.add(modules)
            if seconds >= 0 or len(self.table[name]["modules"]) <= SMALL:
                chosen.append(name)
        return chosen

    def sees(self, name, mutant, folder):
        """Whether the test fails with the mutant, or does not end. Its models are kept in the folder for the next test."""
        path = folder / "mutant.json"
        path.write_text(json.dumps({"module": module(mutant.file), "line": mutant.was, "place": mutant.place, "mutated": mutant.line}))
        return self.once(name, {"EDOF_MUTANT": str(path)}, LIMIT) != 0
