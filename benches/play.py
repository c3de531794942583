#!/usr/bin/env python3
"""How long `edof play` takes for a picture of 512x384 when one slider moves: play.py EDOF [UPDATES].

Every position is new, so nothing but what the slider leaves as it is comes from what is kept. Wall-clock time is that of a browser on the same computer; CPU time does not
depend on what else runs, and is what two cores need.
"""

import json
import os
import subprocess
import sys
import time
import urllib.request

EDOF, UPDATES = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 20
TICKS = os.sysconf("SC_CLK_TCK")

program = subprocess.Popen([EDOF, "play"], stdout=subprocess.PIPE, text=True)
address = program.stdout.readline().split()[0]


def cpu():
    fields = open(f"/proc/{program.pid}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def ask(path, state=None):
    data = None if state is None else json.dumps(state).encode()
    with urllib.request.urlopen(urllib.request.Request(address + path, data)) as answer:
        return answer.read()


def moved(state, slider, step):
    camera = dict(state["camera"])
    change = {
        "noise": {"seed": state["seed"] + step},
        "light": {"electrons": state["electrons"] + 10 * step},
        "depth": {"psi": 0.3 * step},
        "focus": {"camera": {**camera, "focus_psi": 2 + 0.2 * step}},
        "ring": {"camera": {**camera, "rings": [{**camera["rings"][0], "inner": 0.5 + 0.01 * step}]}},
        "stops": {"stops": 0.1 * step},
    }[slider]
    return {**state, **change}


try:
    camera = json.loads(ask("setup"))["camera"]
    print(f"| slider | stride | wall ms | CPU ms | updates per second on two cores by CPU |\n|---|---|---|---|---|")
    for stride in [8, 4]:
        state = {"scene": "chart", "camera": camera, "psi": 2.0, "stops": 0.0, "electrons": 3000.0, "read_noise_e": 2.5, "seed": 0, "network": None,
                 "layers": None, "stride": stride, "clear": {"stops": 0.0, "focus_psi": 4.0}}
        for slider in ["noise", "light", "depth", "focus", "ring", "stops"]:
            ask("pictures", state)
            begun, used = time.monotonic(), cpu()
            for step in range(1, UPDATES + 1):
                ask("pictures", moved(state, slider, step))
            wall, used = (1000 * (now - before) / UPDATES for now, before in [(time.monotonic(), begun), (cpu(), used)])
            print(f"| {slider} | {stride} | {wall:.0f} | {used:.0f} | {2000 / used:.1f} |", flush=True)
finally:
    program.terminate()
    program.wait()
