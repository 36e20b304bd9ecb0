#!/usr/bin/env python3
"""Prints how many instructions each part of the simulated board executes in a millisecond of a run.

Usage: tools/dev/profile.py [--build FOLDER] [--scenario FILE] [--stepper NAME] [--from SECONDS]
       [--duration SECONDS] [--profile FILE]

Runs the program `profiled_run` (target of that name, tests/bench) of a build under valgrind's callgrind and sums what its
functions execute, by the library that each belongs to. What a function without a part executes (the C library, Eigen, ODE)
counts for the part that called it. Start-up and the reading of files are left out. Instructions repeat to a few in a million
whatever else the machine does; they are not time, since a division takes longer than an addition.

--profile reads an earlier output of callgrind instead of running anything.
"""

import argparse
import collections
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

# The part of each library of the build, by folder. The first that matches counts.
PARTS = {
    "sim_board/engine": "physics",
    "sim_board/world": "physics",
    "sim_board/can": "bus",
    "sim_board/drive": "drives",
    "sim_board/servo": "drives",
    "sim_board/storage": "drives",
    "sim_board/sensor": "sensors",
    "sim_board/random": None,  # for whoever draws
    "simulation/record": "recording",
    "simulation/observe": "recording",
    "sim_board": "board",
    "simulation": "board",
    "firmware/canopen": None,  # controller and drives share it
    "firmware/fixed": None,
    "firmware": "firmware",
}
# Functions whose part is not that of their library.
NAMED = ((re.compile(r"sim_board::(Collider|HeightFieldContact)::|sim_board::Soles::|sim_board::HeldSole::"), "contact"),)
COLLECTED = ("*profiled_advance*", "*profiled_record*", "*BackgroundWriter::write_records*")
SHOWN = ("physics", "contact", "bus", "drives", "sensors", "firmware", "recording", "board")


def symbols(build):
    """Maps each function's name, demangled, to its part; a name in libraries of several parts to None."""
    parts = {}
    for library in sorted(build.rglob("lib*.a")):
        folder = library.parent.relative_to(build).as_posix()
        prefix = next((p for p in PARTS if folder == p or folder.startswith(p + "/")), None)
        if prefix is None:
            continue
        lines = subprocess.run(["nm", "--demangle", "--defined-only", library], check=True, capture_output=True, text=True).stdout
        for line in lines.splitlines():
            fields = line.split(maxsplit=2)
            if len(fields) == 3 and fields[1] in "tTwW":
                part = PARTS[prefix]
                parts[fields[2]] = part if parts.get(fields[2], part) == part else None
    return parts


class Profile:
    """The functions of a callgrind profile: what each executes itself, and for each callee, what that executes for it."""

    def __init__(self, path):
        self.own = collections.Counter()
        self.calls = collections.defaultdict(collections.Counter)  # caller: callee: instructions
        names = {}

        def name(field):
            number, _, text = field.partition(" ")
            if text:
                names[number] = text
            return re.sub(r"'\d+$", "", names[number])

        caller = callee = None
        with open(path, encoding="utf-8", errors="replace") as lines:
            for line in lines:
                line = line.rstrip("\n")
                if line.startswith("fn="):
                    caller = name(line[3:])
                elif line.startswith("cfn="):
                    callee = name(line[4:])
                elif line[:1] in "0123456789+-*":
                    fields = line.split()
                    if len(fields) < 2:
                        continue
                    if callee is None:
                        self.own[caller] += int(fields[1])
                    else:
                        self.calls[caller][callee] += int(fields[1])
                        callee = None


def shares(profile, part_of):
    """Instructions by part. A function without a part passes its own on to its callers, in proportion to what they called."""
    callers = collections.defaultdict(collections.Counter)
    for caller, callees in profile.calls.items():
        for callee, instructions in callees.items():
            if callee != caller:
                callers[callee][caller] += instructions
    waiting = collections.Counter({f: n for f, n in profile.own.items()})
    sums = collections.Counter()
    for _ in range(200):  # levels of calls; recursion converges
        handed_on = collections.Counter()
        for function, instructions in waiting.items():
            part = part_of(function)
            total = sum(callers[function].values())
            if part is not None or total == 0:
                sums[part or "board"] += instructions
                continue
            for caller, share in callers[function].items():
                handed_on[caller] += instructions * share / total
        waiting = handed_on
        if sum(waiting.values()) < 1.0:
            break
    sums["board"] += sum(waiting.values())
    return sums


def run(arguments, output):
    program = arguments.build / "bin" / "profiled_run"
    if not program.exists():
        sys.exit(f"{program}: no such program; cmake --build it with the target profiled_run")
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={output}"]
        command += [f"--toggle-collect={pattern}" for pattern in COLLECTED]
        command += [program, arguments.scenario, arguments.stepper]
        command += [str(arguments.start), str(arguments.duration), folder]
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    if done.returncode != 0:
        sys.exit(f"profiled_run failed under valgrind:\n{done.stderr}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release", help="folder of the build")
    parser.add_argument("--scenario", default="scenarios/walk.yaml", help="scenario file")
    parser.add_argument("--stepper", default="lumped", help="solver of the physics")
    parser.add_argument("--from", dest="start", type=float, default=5.0, help="simulated seconds before the profile begins")
    parser.add_argument("--duration", type=float, default=2.0, help="simulated seconds of the profile")
    parser.add_argument("--profile", type=pathlib.Path, help="output of callgrind to read")
    arguments = parser.parse_args()

    parts = symbols(arguments.build)

    def part_of(function):
        for pattern, part in NAMED:
            if pattern.search(function):
                return part
        return parts.get(function)

    if arguments.profile:
        profile = Profile(arguments.profile)
    else:
        with tempfile.NamedTemporaryFile() as output:
            run(arguments, output.name)
            profile = Profile(output.name)
    sums = shares(profile, part_of)
    total = sum(sums.values())
    milliseconds = 1e3 * arguments.duration
    print("| part | instructions a millisecond | share, % |\n| --- | ---: | ---: |")
    for part in SHOWN:
        print(f"| {part} | {sums[part] / milliseconds:.0f} | {100 * sums[part] / total:.1f} |")
    beside = total - sums["physics"] - sums["contact"]
    print(f"| all | {total / milliseconds:.0f} | 100.0 |")
    print(f"| all beside physics and contact | {beside / milliseconds:.0f} | {100 * beside / total:.1f} |")


if __name__ == "__main__":
    main()
