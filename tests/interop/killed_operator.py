"""A robot ends its walk by itself when the program that holds the walk is killed (object 0x1401:05, on by default).

killed_operator.py KOBOSHI, in a network namespace of its own. One process is the robot, on a stand; another repeats velocity
and command as the studio does; SIGKILL ends that one. Times are counted in SYNCs of the robot,
one per 10 ms of simulated time, so that they do not depend on the machine.
"""

import multiprocessing
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time

import can

GROUP, PORT = "239.74.163.2", 43113
SPEED = 2  # simulated seconds per second
REPETITION_S = 0.1 / SPEED
SYNCS_PER_S = 100
# The deadline, the step under way, and the step that brings the feet together, with a margin: 2.4 s are measured.
STANDS_WITHIN_S = 3.5
PATIENCE_S = 120.0  # a loaded machine is slow
COMMAND, VELOCITY, STATE, EMERGENCY, SYNC = 0x201, 0x301, 0x181, 0x081, 0x080
ENABLE, WALK = 1, 7
LIMP, STANDING, WALKING = 1, 4, 8
RPDO_TIMEOUT = 0x8250


def open_bus():
    return can.Bus(interface="udp_multicast", channel=GROUP, port=PORT)


def send(bus, identifier, data):
    bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))


def hold_walk():
    """Walks until it is killed."""
    with open_bus() as bus:
        while True:
            send(bus, VELOCITY, struct.pack("<3h", 150, 0, 0))
            send(bus, COMMAND, bytes([WALK, 0, 0]))
            time.sleep(REPETITION_S)


class Robot:
    """Follows the controller's state, its emergency messages and its time."""

    def __init__(self, bus):
        self.bus = bus
        self.state, self.syncs, self.emergencies = None, 0, []

    def follow(self):
        frame = self.bus.recv(PATIENCE_S)
        assert frame is not None, "the robot has fallen silent"
        if frame.arbitration_id == SYNC:
            self.syncs += 1
        elif frame.arbitration_id == STATE:
            self.state = frame.data[0]
        elif frame.arbitration_id == EMERGENCY:
            self.emergencies.append(struct.unpack_from("<H", frame.data)[0])

    def await_state(self, state, syncs):
        """Returns whether the state came within this many SYNCs."""
        end = self.syncs + syncs
        while self.state != state and self.syncs < end:
            self.follow()
        return self.state == state

    def pass_time(self, syncs):
        end = self.syncs + syncs
        while self.syncs < end:
            self.follow()


def check(bus):
    robot = Robot(bus)
    assert robot.await_state(LIMP, 500), robot.state
    robot.pass_time(250)  # it measures its gyro's bias
    send(bus, COMMAND, bytes([ENABLE, 0, 0]))
    assert robot.await_state(STANDING, 500), robot.state
    operator = multiprocessing.get_context("spawn").Process(target=hold_walk)
    operator.start()
    try:
        assert robot.await_state(WALKING, 10_000), robot.state
        robot.pass_time(2 * SYNCS_PER_S)  # four deadlines
        # A machine that pauses the operator ends the walk in between.
        assert robot.await_state(WALKING, 10_000), robot.state
    finally:
        os.kill(operator.pid, signal.SIGKILL)
        operator.join()
    before = robot.syncs
    assert robot.await_state(STANDING, int(STANDS_WITHIN_S * SYNCS_PER_S)), robot.state
    took_s = (robot.syncs - before) / SYNCS_PER_S
    robot.pass_time(SYNCS_PER_S)
    assert robot.state == STANDING, robot.state
    assert robot.emergencies[-1:] == [RPDO_TIMEOUT], robot.emergencies
    print(f"stands {took_s:.2f} s after the operator was killed")


def main():
    settings = ["commands=[]", "duration_s=300", "initial.held_until_s=299"]
    arguments = [part for setting in settings for part in ("--set", setting)]
    with tempfile.TemporaryDirectory() as folder, open_bus() as bus:
        run = subprocess.Popen([sys.argv[1], "run", "scenarios/go.yaml", "--realtime", "--speed", str(SPEED), "--can",
                                f"udp:{GROUP}:{PORT}", "--out", f"{folder}/run", *arguments], stdout=subprocess.DEVNULL)
        try:
            check(bus)
        finally:
            run.terminate()
            run.wait()


if __name__ == "__main__":
    main()
