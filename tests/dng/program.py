"""Runs of `edof reconstruct`, many files in one run."""

import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from png import read_png

LINEAR = ["--gamma", "linear", "--bits", "16"]
BATCH = 120


@dataclass
class Done:
    code: int
    errors: str

    @property
    def lines(self):
        return [line for line in self.errors.splitlines() if line.strip()]


class Program:
    def __init__(self, edof, folder):
        self.edof, self.folder, self.runs = edof, Path(folder), 0

    def run(self, *arguments):
        self.runs += 1
        done = subprocess.run(
            [self.edof, "reconstruct", *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            timeout=300,
        )
        if done.returncode not in (0, 1, 2):
            raise Failed(f"exit status {done.returncode}: {done.stderr.strip()[-400:]}")
        return Done(done.returncode, done.stderr)

    def pictures(self, files, *options):
        """Pictures of files in as few runs as possible; a text in the place of one that fails."""
        found = {}
        for start in range(0, len(files), BATCH):
            found |= self.batch(files[start : start + BATCH], *options)
        return found

    def batch(self, files, *options):
        out = Path(tempfile.mkdtemp(dir=self.folder))
        if not files:
            return {}
        try:
            done = self.run(*files, *LINEAR, *options, "-q", "--out", f"{out}/")
            trouble = done.errors.strip()
        except Failed as failure:
            done, trouble = Done(101, str(failure)), str(failure)
        if done.code == 0:
            return {file: read_png(out / (Path(file).stem + ".png")) for file in files}
        if len(files) == 1:
            return {files[0]: trouble}
        middle = len(files) // 2
        return self.batch(files[:middle], *options) | self.batch(files[middle:], *options)


class Failed(Exception):
    pass
