#!/usr/bin/env python3
"""Proves blocks of the circuit: what is proven stands in proofs.json, the properties in BLOCK.sv beside it.

Each task runs in SymbiYosys with the engines that it names; of several the first that answers counts. A cover task shows that the assumptions leave
room. Broken copies of a block must fail: a proof that cannot fail says nothing.
"""

import argparse
import concurrent.futures
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).parent
# Sessions of the provers that run now.
RUNNING = set()


def sby(task, mode):
    """The text of SymbiYosys's task file."""
    depth = task.get(f"{mode}_depth", task["depth"])
    engines = task.get("engines", ["abc pdr"]) if mode == "prove" else ["smtbmc yices"]
    parameters = "".join(f" -set {name} {value}" for name, value in task.get("parameters", {}).items())
    defines = "".join(f" -D{name}" for name in task.get("defines", []) + (["COVER"] if mode == "cover" else []))
    lines = ["[options]", f"mode {mode}", f"depth {depth}"]
    lines += ["multiclock on"] if task.get("multiclock") else []
    lines += ["[engines]", *engines, "[script]"]
    lines += [f"read -formal{defines} {pathlib.Path(file).name}" for file in task["files"]]
    lines += [f"read -formal{defines} {task['properties']}"]
    lines += [f"chparam{parameters} prove"] if parameters else []
    lines += ["prep -flatten -top prove", "[files]", *[pathlib.Path(file).name for file in task["files"]], task["properties"]]
    return "\n".join(lines) + "\n"


def end_session(session):
    """Ends all processes of a session."""
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            # Behind the program's name, in brackets: state, parent, group, session.
            if int(stat.read_text().rpartition(")")[2].split()[3]) == session:
                os.kill(int(stat.parent.name), signal.SIGKILL)


def stop(_number, _frame):
    """Ends what runs, and then itself."""
    for session in list(RUNNING):
        end_session(session)
    os._exit(1)


def texts(task, sources, broken):
    """Its files by name: made small for the prover, then broken."""
    found = {}
    for file in task["files"]:
        places = [HERE / file, sources / file, HERE.parent / "rtl" / file]
        text = next((place for place in places if place.exists()), places[1]).read_text()
        for edit in [*task.get("smaller", []), *([broken] if broken is not None else [])]:
            if file != edit["file"]:
                continue
            text, count = re.subn(edit["pattern"], lambda _: edit["new"], text)
            if count != 1 and not (count and edit.get("all")):
                sys.exit(f"prove.py: {task['name']}: '{edit['pattern']}' stands {count} times in {file}, not once; "
                         "write it as the circuit's text does")
        found[pathlib.Path(file).name] = text
    return found


def run(task, mode, files, out, broken=None, patience=1):
    """One run: what it is called, whether it went as it must, a line about it."""
    name = task["name"] + {"prove": "", "bmc": "", "cover": ".cover"}[mode]
    if broken is not None:
        name += f".broken-{broken['name']}"
    folder = out / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for file, text in files.items():
        (folder / file).write_text(text)
    shutil.copy(HERE / task["properties"], folder)
    (folder / "task.sby").write_text(sby(task, mode))
    start = time.monotonic()
    tools = [f"--{tool}={os.environ.get(tool.upper(), found)}" for tool, found in
             [("yosys", "yosys"), ("abc", "yosys-abc"), ("smtbmc", "yosys-smtbmc")]]
    # While it has a free place for a job SymbiYosys does not sleep but asks again and again: no more places than provers.
    places = 3 if mode == "prove" and len(task.get("engines", [])) > 1 else 1
    with open(folder / "log", "w") as log:
        # A session of its own: what it has started ends with it, also its solvers, which have process groups of their own.
        prover = subprocess.Popen(["yowasp-sby", "-f", "-j", str(places), *tools, "-d", "work", "task.sby"], cwd=folder, stdout=log,
                                  stderr=subprocess.STDOUT, start_new_session=True)
        RUNNING.add(prover.pid)
        try:
            prover.wait(task.get("seconds", 300) * patience)
        except subprocess.TimeoutExpired:
            log.write("DONE (TIMEOUT)\n")
        finally:
            end_session(prover.pid)
            prover.wait()
            RUNNING.discard(prover.pid)
    text = (folder / "log").read_text()
    seconds = time.monotonic() - start
    status = (re.findall(r"DONE \((\w+)", text) or ["ERROR"])[-1]
    engine = re.findall(r"summary: engine_\d+ \(([^)]*)\) returned (?:pass|PASS|FAIL|pass for induction)$", text, re.MULTILINE)
    used = re.findall(r"Elapsed process time [^(]*\(secs\)\]: [\d:]+ \((\d+)\)", text)
    how = f"{status} by {engine[0] if engine else '-'} in {seconds:.1f} s" + (f", {used[-1]} s of CPU" if used else "")
    good = status == ("FAIL" if broken is not None else "PASS")
    if not good:
        how += f"; its log: {folder / 'log'}"
    return name, good, how


def tasks_of(table, names, everything):
    """What to run, the long ones first."""
    chosen = [task for task in table if not names or task["block"] in names or task["name"] in names]
    if not chosen:
        known = ", ".join(sorted({task["block"] for task in table}))
        sys.exit(f"prove.py: no block of the name '{' '.join(names)}'; there are {known}")
    jobs = []
    for task in chosen:
        if task.get("long") and not everything and not names:
            continue
        jobs.append((task, "prove", None))
        if task.get("cover", True):
            jobs.append((task, "cover", None))
        jobs += [(task, "bmc", broken) for broken in task.get("broken", [])]
    return sorted(jobs, key=lambda job: -job[0].get("weight", 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sources", type=pathlib.Path, required=True, help="generated directory's rtl folder")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for logs and traces")
    parser.add_argument("--all", action="store_true", help="the long proofs, too")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="proofs at one time")
    parser.add_argument("--patience", type=float, default=1, metavar="FACTOR", help="times as long before a proof is given up")
    parser.add_argument("--json", type=pathlib.Path, help="write the results to this file")
    parser.add_argument("block", nargs="*", help="only these blocks or tasks")
    options = parser.parse_args()
    table = json.loads((HERE / "proofs.json").read_text())
    jobs = tasks_of(table, options.block, options.all)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    out, sources = options.out.resolve(), options.sources.resolve()
    # Before the first proof: what an edit does not find would be told minutes later.
    files = [texts(task, sources, broken) for task, _, broken in jobs]
    failed, results = 0, []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        waiting = [pool.submit(run, task, mode, own, out, broken, options.patience) for (task, mode, broken), own in zip(jobs, files)]
        for job in concurrent.futures.as_completed(waiting):
            name, good, how = job.result()
            failed += not good
            results.append({"name": name, "as_it_must": good, "result": how})
            print(f"{'ok    ' if good else 'FAILED'} {name}: {how}", flush=True)
    if options.json:
        options.json.write_text(json.dumps(sorted(results, key=lambda row: row["name"]), indent=1) + "\n")
    if failed:
        sys.exit(f"{failed} of {len(jobs)} did not end as they must")
    print(f"all {len(jobs)} ended as they must")


if __name__ == "__main__":
    main()
