#!/usr/bin/env python3
"""Runs the real `edof reconstruct` on DNGs of write.py and compares its pictures with expected.py, for each row of docs/dng.md.

    tests/dng/check.py target/debug/edof [--random N] [--seed S]

A DNG's picture must equal that of a plain 16-bit PNG of the light that NumPy computes, with the rest (OpcodeList3, crop, colours,
orientation) done by NumPy. LibRaw reads the same files, where it reads their kind, so that the writer is checked by another program.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Lock

import numpy as np

import expected
import messages
import strange
from harmless import harmless
from honoured import honoured
from pages import check_registry, page_rows
from png import read_png, write_png
from program import LINEAR, Failed, Program
from random_shots import random
from scenes import TOLERANCE, Rejection, plain
from write import dng

PROJECT = Path(__file__).resolve().parents[2]


class Checker:
    def __init__(self, program):
        self.program, self.failures, self.passed = program, [], Counter()
        self.covered, self.worst, self.lock = {}, (0.0, ""), Lock()

    def fail(self, what):
        self.failures.append(what)

    def one(self, kind, name, check, *numbers):
        """A check, counted for its rows; 0 is no row."""
        with self.lock:
            for number in filter(None, numbers):
                self.covered.setdefault(number, set()).add(kind)
        try:
            check()
            with self.lock:
                self.passed[kind] += 1
        except Failed as failure:
            self.fail(f"{kind}: {name}: {failure}")
        except subprocess.TimeoutExpired:
            self.fail(f"{kind}: {name}: no end after 300 s")

    def write(self, name, data):
        path = self.program.folder / name
        path.write_bytes(data)
        return name

    # Pictures

    def honoured(self, found):
        """Compares pictures of DNGs with those of plain PNGs of the same light."""
        plain = {}
        for case in found:
            light = expected.light(case.shot)
            name = f"{case.name}.light.png"
            write_png(self.program.folder / name, np.rint(light * 65536).clip(0, 65535).astype(np.uint16))
            plain.setdefault(case.phase or expected.phase(case.shot), []).append(name)
            self.write(case.file_name, case.file())
        pictures = {}
        with ThreadPoolExecutor(2) as pool:
            jobs = [pool.submit(self.program.pictures, names, "--phase", phase) for phase, names in plain.items()]
            by_options = {}
            for case in found:
                by_options.setdefault(tuple(case.options), []).append(case.file_name)
            jobs += [pool.submit(self.program.pictures, names, *options) for options, names in by_options.items()]
            for job in jobs:
                pictures |= job.result()
        for case in found:
            check = lambda: self.same(case, pictures[f"{case.name}.light.png"], pictures[case.file_name])
            self.one("honoured", case.name, check, *case.rows)

    def same(self, case, reconstructed, picture):
        if isinstance(reconstructed, str):
            raise Failed(f"its plain PNG fails: {reconstructed}")
        ours = case.finished(reconstructed)
        if isinstance(picture, str):
            raise Failed(picture)
        if ours.shape != picture.shape:
            raise Failed(f"picture of {picture.shape[1]}x{picture.shape[0]} pixels, expected {ours.shape[1]}x{ours.shape[0]}")
        # A PNG has no colours below 0, which the matrix may mix into others.
        below = np.zeros(ours.shape, bool)
        for colour in (-0.05, 0.05):
            below |= case.finished(np.where(reconstructed == 0, colour, reconstructed)) != ours
        if below.mean() > 0.2:
            raise Failed(f"{below.mean():.0%} of the scene is too dark to compare")
        off = np.where(below, 0, np.abs(ours - picture))
        if case.tolerance <= TOLERANCE and off.max() > self.worst[0]:
            self.worst = off.max(), case.name
        if off.max() > case.tolerance:
            at = np.unravel_index(off.argmax(), off.shape)
            means = lambda p: " ".join(f"{v:.4f}" for v in p.reshape(-1, 3).mean(0))
            raise Failed(
                f"off by up to {off.max():.5f} (mean {off.mean():.5f}) at row {at[0]}, column {at[1]}, "
                f"limit {case.tolerance}; means {means(picture)}, expected {means(ours)}"
            )

    def harmless(self, found):
        """A picture with a tag is that without it."""
        base = self.write("harmless.dng", plain().file())
        names = [self.write(f"harmless-{case.name}.dng", case.data) for case in found]
        pictures = self.program.pictures([base, *names])
        for case, name in zip(found, names):

            def check():
                if isinstance(pictures[name], str) or isinstance(pictures[base], str):
                    raise Failed(str(pictures[name])[:300])
                if not np.array_equal(pictures[name], pictures[base]):
                    raise Failed("the picture differs from that without the tag")

            self.one("harmless", case.name, check, case.number)

    # Messages

    def rejected(self, case):
        def check():
            name = self.write(f"rejected-{case.name}{case.ending}", case.data)
            out = f"rejected-{case.name}.png"
            done = self.program.run(name, *LINEAR, *case.options, "--out", out)
            if done.code == 0:
                raise Failed("a picture is made")
            if (self.program.folder / out).exists():
                raise Failed("a picture is written in spite of the error")
            if len(done.lines) != 1:
                raise Failed(f"{len(done.lines)} lines: {done.errors.strip()[:300]}")
            for word in [name, *case.words]:
                if word.lower() not in done.errors.lower():
                    raise Failed(f"'{word}' is not in: {done.errors.strip()}")
            if case.help and not any(
                word in done.errors for word in ("convert", "expected", "use ", "--", "cut", "must", "only", "needs", "state ")
            ):
                raise Failed(f"nothing that helps in: {done.errors.strip()}")

        self.one("rejected", case.name, check, case.number)

    def noted(self, case):
        def check():
            name = self.write(f"noted-{case.name}.dng", case.data)
            done = self.program.run(name, *LINEAR, *case.options, "--out", f"noted-{case.name}.png")
            if done.code != 0:
                raise Failed(done.errors.strip())
            said = all(word.lower() in done.errors.lower() for word in case.words)
            if said != case.expected:
                raise Failed(f"{'no note' if case.expected else 'a note'} with {case.words}: {done.errors.strip()}")

        self.one("noted", case.name, check, *([case.number] if case.expected else []))

    def group(self, run, found):
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(run, found))


# Parts that are not of one row


def names_and_cuts(checker):
    """A DNG is known by its content; a file that is cut is an error that says so, wherever it is cut."""
    data = plain().file()
    reference = None
    for ending in (".dng", ".DNG", ".tif", ".tiff", ".png", ".bin", ""):
        name = checker.write(f"by-content{ending.replace('.', '-')}x{ending}", data)
        picture = checker.program.pictures([name])[name]
        reference = picture if reference is None else reference

        def check():
            if isinstance(picture, str):
                raise Failed(picture)
            if not np.array_equal(picture, reference):
                raise Failed("another picture than that of the file with .dng")

        checker.one("by content", name, check, 50706)
    for label, directories, order, big in strange.cut_files():
        cuts = []
        data = dng(directories, order, big, cuts)
        places = sorted({at + off for at in cuts for off in (-1, -3) if 0 < at + off < len(data)} | {9, 12, 20})
        for place in places:
            case = Rejection(f"cut-{label}-{place}", data[:place], 0, ["cut"], help=False)
            checker.rejected(case)


def crashes(checker, seed):
    """Odd and changed files are an error of one line, or a picture."""

    def check(named):
        name, data = named

        def run():
            file = checker.write(f"strange-{name}.dng", data)
            out = checker.program.folder / f"strange-{name}.png"
            done = checker.program.run(file, *LINEAR, "-q", "--out", out)
            if done.code != 0 and (len(done.lines) != 1 or file not in done.errors):
                raise Failed(f"not one line that names the file: {done.errors.strip()[:300]}")
            if done.code != 0 and out.exists():
                raise Failed("a picture is written in spite of the error")

        checker.one("no crash", name, run)

    checker.group(check, [*strange.strange(), *((f"mutated-{s}", strange.mutated(s)) for s in range(seed, seed + 150))])


def reports(checker):
    """The inputs of public reports, with the means of their pictures."""
    folder = Path(os.environ.get("EDOF_REPORTS", PROJECT.parent / "shared/data/reports"))
    if not folder.is_dir():
        print(f"== NOT CHECKED: the files of public reports; there is no folder {folder} (EDOF_REPORTS)", file=sys.stderr)
        return
    known = {
        "black-level-delta.dng": (0.300, 0.400, 0.501),
        "float16.dng": (0.3, 0.4, 0.5),
        "several-raws.dng": (0.3, 0.4, 0.5),
        "illuminants-swapped.dng": (0.210, 0.386, 0.541),
        "foreign-sidecar.dng": (0.210, 0.386, 0.541),
    }
    notes = {"several-raws.dng": "4 raw frames", "foreign-sidecar.dng": "foreign-sidecar.dng.json"}
    for file in sorted(folder.glob("*.dng*")):
        checker.write(file.name, file.read_bytes())
    for name, means in known.items():

        def check():
            done = checker.program.run(name, *LINEAR, "--out", f"{name}.png")
            if done.code != 0:
                raise Failed(done.errors.strip())
            found = read_png(checker.program.folder / f"{name}.png").reshape(-1, 3).mean(0)
            if np.abs(found - means).max() > 0.002:
                raise Failed(f"means {found.round(4)}, expected {means}")
            if name in notes and notes[name] not in done.errors:
                raise Failed(f"no note with '{notes[name]}': {done.errors.strip()}")

        checker.one("reports", name, check)

    def neutral():
        rejected = checker.program.run("neutral-zero.dng", *LINEAR, "--out", "neutral.png")
        if rejected.code == 0 or "AsShotNeutral" not in rejected.errors or "white balance" not in rejected.errors:
            raise Failed(f"expected an error with AsShotNeutral and white balance: {rejected.errors.strip()}")
        done = checker.program.run("neutral-zero.dng", *LINEAR, "--white-balance", "1,1,1", "--out", "neutral.png")
        if done.code != 0:
            raise Failed(f"--white-balance does not help: {done.errors.strip()}")

    checker.one("reports", "neutral-zero.dng", neutral)


def useless_options(checker):
    """Options of headerless files next to a DNG."""
    name = checker.write("plain-options.dng", plain().file())
    for option in (["--size", "48x32"], ["--bit-depth", "16"], ["--align", "top"], ["--video"], ["--packing", "words"], ["--order", "big"]):

        def check():
            done = checker.program.run(name, *option, *LINEAR, "--out", "useless.png")
            # Options that need --size are errors without it, whatever the file.
            named = name in done.errors or option[0] in ("--packing", "--order")
            if done.code == 0 or option[0] not in done.errors or not named:
                raise Failed(f"expected an error with {option[0]} and {name}: {done.errors.strip()}")

        checker.one("options", option[0], check)


def libraw(checker, found):
    """LibRaw's reading of the same files; gives the kinds that it does not read."""
    import rawpy

    unread = []
    for case in found:
        if not case.libraw:
            unread.append(case.name)
            continue

        def check():
            try:
                raw = rawpy.imread(str(checker.program.folder / case.file_name))
                read = raw.raw_image
            except rawpy.LibRawError as error:
                raise Failed(f"LibRaw does not read it: {error}") from None
            with raw:
                values = expected.linearised(replace(case.shot, tags=case.shot.tags | {"OpcodeList1": bytes(4)}))
                if read is None or not np.array_equal(read, values):
                    raise Failed(f"LibRaw has other values ({None if read is None else read.shape}, expected {values.shape})")
                colours = case.shot.tags | (case.colours or {})
                if "AsShotNeutral" in colours:
                    ours = 1 / np.array(expected.values(colours, "AsShotNeutral", None))
                    theirs = np.array(raw.camera_whitebalance[:3])
                    if np.abs(theirs / theirs[1] - ours / ours[1]).max() > 1e-3:
                        raise Failed(f"LibRaw has white balance {theirs}, expected {ours}")
                if "WhiteLevel" in case.shot.tags and raw.white_level != expected.white_level(case.shot):
                    raise Failed(f"LibRaw has white level {raw.white_level}, expected {expected.white_level(case.shot)}")

        checker.one("LibRaw", case.name, check)
    return unread


def completeness(checker, rows):
    """Each row of the page has a case of its treatment, and each case a row; the page has each tag of tifffile's registry."""
    for number, row in rows.items():
        if row.treatment not in checker.covered.get(number, set()):
            checker.fail(f"docs/dng.md: {row.name} ({number}) is {row.treatment}, but no case is")
    for number in checker.covered:
        if number not in rows:
            checker.fail(f"tests/dng: a case is of tag {number}, which docs/dng.md does not have")
    for trouble in check_registry(rows):
        checker.fail(trouble)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("edof", help="the program")
    parser.add_argument("--random", type=int, default=100, help="random DNGs (default 100)")
    parser.add_argument("--seed", type=int, default=1, help="of the first random DNG (default 1)")
    arguments = parser.parse_args()
    rows = page_rows(PROJECT / "docs/dng.md")
    with tempfile.TemporaryDirectory() as folder:
        checker = Checker(Program(str(Path(arguments.edof).resolve()), folder))
        found = honoured()
        checker.honoured(found)
        unread = libraw(checker, found)
        checker.harmless(harmless(rows))
        checker.group(checker.rejected, messages.rejected() + messages.unreadable(rows))
        checker.group(checker.noted, messages.noted())
        names_and_cuts(checker)
        crashes(checker, arguments.seed)
        reports(checker)
        useless_options(checker)
        completeness(checker, rows)
        for start in range(0, arguments.random, 200):
            seeds = range(arguments.seed + start, arguments.seed + min(start + 200, arguments.random))
            checker.honoured([random(seed) for seed in seeds])
        runs = checker.program.runs
    for failure in checker.failures:
        print(f"FAILED {failure}")
    print(f"LibRaw does not read: {', '.join(unread)}")
    print(
        f"{sum(checker.passed.values())} checks passed ({', '.join(f'{n} {kind}' for kind, n in checker.passed.items())}), "
        f"{len(checker.failures)} failed; {len(rows)} rows, {runs} runs; largest difference {checker.worst[0]:.5f} ({checker.worst[1]})"
    )
    sys.exit(1 if checker.failures else 0)


if __name__ == "__main__":
    main()
