#!/usr/bin/env python3
"""Prints what a call from Python costs at joint level, and what a second thread brings.

    tests/bench/joint_level_cost.py [MODULE_FOLDER [ROUNDS]]

Overhead: the processor's time of step(targets, 0) with 16 robots in one thread, by call and world. Such a call does all that a
call of 10 ms does (checks, targets, hand-over to the threads, observations, new arrays) except stepping the boards. The time of
step(targets, 10), in turn, is the base of the ratio. The median of all turns counts; the machine may be busy.

Threads: the time on the clock of 16 worlds in one thread over that in two. It needs a machine with two idle cores.
"""

import pathlib
import statistics
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/release/python"))

import koboshi  # noqa: E402
import numpy as np  # noqa: E402

ROUNDS = int(sys.argv[2]) if len(sys.argv) > 2 else 9
WORLDS = 16
CALLS = 100


def robots(threads):
    made = koboshi.Robots(ROOT / "scenarios/joints.yaml", seeds=range(WORLDS), threads=threads, stepper="lumped")
    pose = made.step(None, 10)[:, made.layout["joint_position_rad"]].copy()
    return made, pose


def seconds(clock, work):
    start = clock()
    work()
    return clock() - start


def main():
    made, pose = robots(1)
    turns = []
    for _ in range(ROUNDS):
        turns.append([seconds(time.process_time, lambda each=each: [made.step(pose, each) for _ in range(CALLS)])
                      for each in (0, 10)])
    overhead_us, whole_us = (1e6 * statistics.median(times) / CALLS / WORLDS for times in zip(*turns))
    print(f"by call and world: {overhead_us:.2f} us beside the boards, {whole_us:.1f} us with their 10 ms, "
          f"ratio {whole_us / (whole_us - overhead_us):.4f}")

    (one, _), (two, _) = robots(1), robots(2)
    ratios = []
    for _ in range(ROUNDS):
        alone, together = (seconds(time.perf_counter, lambda each=each: each.step(pose, 10 * CALLS)) for each in (one, two))
        ratios.append(alone / together)
    print(f"two threads: {statistics.median(ratios):.2f} times one")


if __name__ == "__main__":
    main()
