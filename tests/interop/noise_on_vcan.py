"""noise_on_vcan.py KOBOSHI LOG...: cangen and canplayer flood the bus of `koboshi board`. The board must survive. After each flood,
each drive must report by SDO a state that CiA 402 defines. Needs a vcan0: see with_vcan.sh."""

import collections
import pathlib
import subprocess
import sys
import time

import can

KOBOSHI, *LOGS = sys.argv[1:]
DRIVES = range(16, 36)
ATTEMPTS = 10
# CiA 402-2, table 29: mask and value of the statusword.
STATES = {
    "not ready to switch on": (0x4F, 0x00),
    "switch on disabled": (0x4F, 0x40),
    "ready to switch on": (0x6F, 0x21),
    "switched on": (0x6F, 0x23),
    "operation enabled": (0x6F, 0x27),
    "quick stop active": (0x6F, 0x07),
    "fault reaction active": (0x4F, 0x0F),
    "fault": (0x4F, 0x08),
}
CANGEN = ["cangen", "vcan0", "-g", "0", "-p", "100"]
FLOODS = {
    "any standard frame": [*CANGEN, "-n", "20000"],
    "extended frames": [*CANGEN, "-e", "-n", "2000"],
    "remote requests": [*CANGEN, "-R", "-n", "2000"],
    "SYNC": [*CANGEN, "-I", "080", "-n", "2000"],
    "NMT": [*CANGEN, "-I", "000", "-L", "2", "-n", "2000"],
    "targets for drive 16": [*CANGEN, "-I", "210", "-n", "2000"],
    "SDO requests of drive 17": [*CANGEN, "-I", "611", "-L", "8", "-n", "2000"],
    "the controller's heartbeat": [*CANGEN, "-I", "701", "-L", "1", "-n", "2000"],
} | {f"canplayer {pathlib.Path(log).name}": ["canplayer", "-t", "-I", log] for log in LOGS}


def send(bus, identifier, *data):
    bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))


def statusword(bus, drive):
    """Reads the state by SDO. A flood may have stopped the drive by NMT or left its server within a transfer, which an abort ends.
    Any of these frames may be lost: the queue of the board's socket overflows until the board has processed the flood."""
    for _ in range(ATTEMPTS):
        send(bus, 0x000, 0x80, drive)
        send(bus, 0x600 + drive, 0x80, 0x41, 0x60, 0, 0, 0, 0, 0)
        send(bus, 0x600 + drive, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0)
        end = time.monotonic() + 1.0
        while time.monotonic() < end:
            answer = bus.recv(0.1)
            if answer and answer.arbitration_id == 0x580 + drive and bytes(answer.data[:4]) == b"\x4B\x41\x60\x00":
                return answer.data[4] | answer.data[5] << 8
    raise TimeoutError(f"drive {drive} does not answer")


def state(word):
    names = [name for name, (mask, value) in STATES.items() if word & mask == value]
    if len(names) != 1:
        raise ValueError(f"statusword {word:04X} is of no state")
    return names[0]


def flood(board, bus, name, command):
    send(bus, 0x000, 0x01, 0)  # operational, so that the drive accepts PDOs
    subprocess.run(command, check=True)
    if board.poll() is not None:
        raise RuntimeError(f"the board ended in a flood of {name}")
    counts = collections.Counter(state(statusword(bus, drive)) for drive in DRIVES)
    print(f"{name}: " + ", ".join(f"{count} {known}" for known, count in counts.items()), flush=True)


def main():
    with open("/mnt/board", "w+", encoding="ascii") as output:
        board = subprocess.Popen([KOBOSHI, "board", "--can", "socketcan:vcan0"],
                                 stdout=output, stderr=output)
        while "CAN bus on" not in pathlib.Path("/mnt/board").read_text():
            if board.poll() is not None:
                sys.exit("the board ended: " + pathlib.Path("/mnt/board").read_text())
            time.sleep(0.05)
        try:
            with can.Bus(interface="socketcan", channel="vcan0") as bus:
                for name, command in FLOODS.items():
                    flood(board, bus, name, command)
        finally:
            board.terminate()
            status = board.wait()
            print(pathlib.Path("/mnt/board").read_text(), end="")
    sys.exit(status)


main()
