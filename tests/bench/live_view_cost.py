#!/usr/bin/env python3
"""Prints what the live view costs a run in real time: processor time of its threads per simulated second.

    tests/bench/live_view_cost.py [PROGRAM [ROUNDS]]

Plays scenarios/walk.yaml in real time, without --view and with it, both at the same time of the run in turn. With --view, a page is
connected in every other interval: a client that only reads, so that no browser counts. The simulation is the thread that steps
it; the rest of the process writes files, encodes and sends. Ratios are to the run without --view. It needs a quiet machine.
"""

import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import web_socket

STEPPERS = ("mujoco", "lumped")
SETTLING_S = 6  # until the robot walks
INTERVAL_S = 4
INTERVALS = 6


class Viewer:
    """Reads the stream as fast as it comes."""

    def __init__(self, address):
        self.page = web_socket.WebSocket(address)
        self.messages = 0
        self.thread = threading.Thread(target=self.read)
        self.thread.start()

    def read(self):
        try:
            while self.page.next() is not None:
                self.messages += 1
        except OSError:
            pass

    def close(self):
        self.page.socket.shutdown(2)
        self.thread.join()
        self.page.close()
        return self.messages


def processor_s(process):
    """Returns the processor time of the simulation's thread and of the whole process, in s."""
    times = {}
    for task in pathlib.Path(f"/proc/{process.pid}/task").iterdir():
        times[int(task.name)] = 1e-9 * int((task / "schedstat").read_text().split()[0])
    return times[process.pid], sum(times.values())


def play(program, stepper, folder, view):
    """Returns the shares of a processor in each interval: (simulation, process, with a page), and the messages per second."""
    duration_s = SETTLING_S + INTERVALS * INTERVAL_S + 1
    command = [program, "run", "scenarios/walk.yaml", "--stepper", stepper, "--realtime", "--out", folder,
               "--set", f"duration_s={duration_s}"] + (["--view"] if view else [])
    shares, rates = [], []
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        address = re.search(r"http://\S+", process.stdout.readline())[0] if view else None
        time.sleep(SETTLING_S)
        for interval in range(INTERVALS):
            viewer = Viewer(address) if view and interval % 2 else None
            time.sleep(0.2)  # the past has been sent
            begin, start = processor_s(process), time.monotonic()
            time.sleep(INTERVAL_S - 0.4)
            passed_s = time.monotonic() - start
            simulation, whole = (after - before for before, after in zip(begin, processor_s(process)))
            shares.append((simulation / passed_s, whole / passed_s, viewer is not None))
            if viewer:
                rates.append(viewer.close() / (passed_s + 0.2))
        process.terminate()
        process.communicate()
    return shares, rates


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/bin/koboshi").resolve()
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    with tempfile.TemporaryDirectory(prefix="koboshi_cost_") as folder:
        for stepper in STEPPERS:
            cases = {"without --view": [], "no page": [], "one page": []}
            rates = []
            for _ in range(rounds):
                for view in (False, True):
                    shares, seen = play(program, stepper, pathlib.Path(folder) / "run", view)
                    rates += seen
                    for simulation, whole, is_watched in shares:
                        cases["one page" if is_watched else "no page" if view else "without --view"].append((simulation, whole))
            base = [statistics.median(column) for column in zip(*cases["without --view"])]
            for name, shares in cases.items():
                simulation, whole = (statistics.median(column) for column in zip(*shares))
                print(f"{stepper}: {name}: simulation {1e3 * simulation:.1f} ms/s, ratio {simulation / base[0]:.3f}; process "
                      f"{1e3 * whole:.1f} ms/s, {1e3 * (whole - base[1]):+.1f} ms/s")
            print(f"{stepper}: {statistics.median(rates):.1f} updates/s")


if __name__ == "__main__":
    main()
