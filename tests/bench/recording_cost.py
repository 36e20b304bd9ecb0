#!/usr/bin/env python3
"""Prints what the recording costs a run: time with --record 100 divided by time with --record no.

    tests/bench/recording_cost.py [PROGRAM [RUNS]]

Plays scenarios/walk.yaml with two steppers, with and without recording in turn, and takes the least of RUNS each: of the
time of the simulation's loop on the clock (timing.json), and of the processor's time of the whole program. It needs a
quiet machine.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEPPERS = ("mujoco", "lumped")
RECORDINGS = ("no", "100")


def play(program, stepper, recording, folder):
    """Returns the seconds on the clock and of the processor."""
    command = [program, "run", "scenarios/walk.yaml", "--stepper", stepper, "--record", recording, "--out", folder]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {process.returncode}")
    wall_s = json.loads((folder / "timing.json").read_text(encoding="utf-8"))["wall_s"]
    return wall_s, usage.ru_utime + usage.ru_stime


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/bin/koboshi").resolve()
    runs = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    with tempfile.TemporaryDirectory(prefix="koboshi_cost_") as folder:
        for stepper in STEPPERS:
            seconds = {recording: [] for recording in RECORDINGS}
            for _ in range(runs):
                for recording in RECORDINGS:
                    seconds[recording].append(play(program, stepper, recording, pathlib.Path(folder) / recording))
            for i, name in enumerate(("clock", "processor")):
                without, recorded = (min(times[i] for times in seconds[recording]) for recording in RECORDINGS)
                print(f"{stepper}: {name} {without:.3f} s without, {recorded:.3f} s with recording, "
                      f"ratio {recorded / without:.3f}")


if __name__ == "__main__":
    main()
