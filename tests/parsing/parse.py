#!/usr/bin/env python3
"""Reads the benches of a generated directory, and the core without one, as SystemVerilog by slang, which is stricter than simulators:
what is used before it is declared, modules with a time scale beside others without, and everything else that the standard forbids.

    tests/parsing/parse.py DIR
"""

import os
import sys

from pyslang import driver


def errors(line):
    """Whether there is one; slang itself says which."""
    slang = driver.Driver()
    slang.addStandardArgs()
    if not (slang.parseCommandLine(line) and slang.processOptions() and slang.parseAllSources()):
        return True
    slang.reportCompilation(slang.createCompilation(), True)
    return not slang.reportDiagnostics(True)


def main():
    os.chdir(sys.argv[1])
    core = " ".join(f"rtl/{name}" for name in sorted(os.listdir("rtl")) if name != "kc705_top.v")
    jobs = {
        "bench": "slang -f sim/bench.f --top edof_bench",
        "core_bench": "slang -f sim/core_bench.f --top edof_core_bench",
        "kc705_core": f"slang {core} --top kc705_core",
    }
    wrong = [name for name, line in jobs.items() if errors(line)]
    sys.exit(f"slang refuses {', '.join(wrong)}" if wrong else None)


if __name__ == "__main__":
    main()
