"""Runs a program on a terminal of its own, waits until it has printed some words so often, and presses Ctrl-C.

Usage: board_terminal.py TIMES WORDS PROGRAM ARGUMENT...; prints what it printed, and last its exit status.
"""

import os
import pty
import select
import sys
import time


def main():
    times, words = int(sys.argv[1]), sys.argv[2].encode().decode("unicode_escape").encode()
    child, terminal = pty.fork()
    if child == 0:
        os.execv(sys.argv[3], sys.argv[3:])
    printed, pressed, end = b"", False, time.monotonic() + 120
    while time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                some = os.read(terminal, 4096)
            except OSError:
                break
            if not some:
                break
            printed += some
        if not pressed and printed.count(words) >= times:
            os.write(terminal, b"\x03")
            pressed = True
    else:
        os.kill(child, 9)
    _, status = os.waitpid(child, 0)
    sys.stdout.write(printed.decode(errors="replace"))
    print(f"\npressed {pressed}, status {os.waitstatus_to_exitcode(status)}")


main()
