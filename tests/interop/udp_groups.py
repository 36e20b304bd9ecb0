"""Robots on UDP multicast hear only the group that they were given, on the interface that the routing table chooses.

udp_groups.py KOBOSHI, in a network namespace of its own with multicast on lo (in_network.sh).
"""

import json
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import unittest

import can
from can.interfaces.udp_multicast.utils import pack_message

KOBOSHI = sys.argv.pop(1) if __name__ == "__main__" else ""
PORT = 43113
OURS, OTHER, JOINED = "239.74.163.2", "239.74.163.3", "239.74.163.9"
EMERGENCY_STOP = can.Message(arbitration_id=0x201, data=[5, 0, 0], is_extended_id=False)
PATIENCE_S = 120.0  # a loaded machine is slow


def start(command, place, *arguments):
    """Starts a program on a bus, and waits until it has joined."""
    program = subprocess.Popen([KOBOSHI, *command, "--can", place, *arguments], stdout=subprocess.PIPE, text=True)
    for line in program.stdout:
        if line.startswith("CAN bus on"):
            return program
    raise AssertionError(f"{command} has ended with status {program.wait()}")


def start_run(group, folder, *arguments):
    return start(["run", "scenarios/live.yaml", "--duration", "3", "--out", str(folder)], f"udp:{group}:{PORT}", *arguments)


def end_of(folder):
    summary = json.loads((pathlib.Path(folder) / "summary.json").read_text())
    return summary["events"][-1]["fields"]["state"], summary["faults"]


class OnLoopback(unittest.TestCase):
    def test_hears_only_its_own_group(self):
        """Two robots with one port, while an emergency stop is sent to the host and to another group that it has joined."""
        with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            stranger.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                                socket.inet_aton(JOINED) + struct.pack("@I", socket.INADDR_ANY))
            runs = [start_run(group, f"{folder}/{group}") for group in (OURS, OTHER)]
            try:
                for place in ("127.0.0.1", JOINED):
                    for _ in range(5):
                        stranger.sendto(pack_message(EMERGENCY_STOP), (place, PORT))
                for run in runs:
                    run.communicate(timeout=PATIENCE_S)
                    self.assertEqual(run.returncode, 0)
            finally:
                for run in runs:
                    run.kill()
                    run.wait()
                    run.stdout.close()
            for group in (OURS, OTHER):
                self.assertEqual(end_of(f"{folder}/{group}"), ("limp", 0), group)

    @staticmethod
    def state_of_robot():
        """Object 2001:1 of the controller; nothing while it does not answer."""
        read = subprocess.run([KOBOSHI, "can", "sdo", "read", "1", "2001:1", "--can", f"udp:{OURS}:{PORT}"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        return int(read.stdout.split()[0], 16) if read.returncode == 0 else None

    def test_has_one_controller(self):
        """A firmware that joins the bus of a run ends by itself and disturbs nothing."""
        with tempfile.TemporaryDirectory() as folder:
            run = start(["run", "scenarios/live.yaml", "--duration", "8", "--out", f"{folder}/run"], f"udp:{OURS}:{PORT}")
            try:
                self.assertTrue(any(self.state_of_robot() == 1 for _ in range(100)))  # limp and ready
                second = subprocess.run([KOBOSHI, "firmware", "scenarios/squat.yaml", "--can", f"udp:{OURS}:{PORT}"],
                                        capture_output=True, text=True, timeout=PATIENCE_S)
            finally:
                run.terminate()
                run.communicate()
            self.assertEqual(second.returncode, 1)
            self.assertIn("another controller is on this bus", second.stderr)
            self.assertEqual(end_of(f"{folder}/run")[0], "limp")

    def test_works_without_a_route_on_a_named_interface(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["ip", "route", "del", "239.0.0.0/8"], check=True)
            try:
                refused = subprocess.run([KOBOSHI, "can", "send", "000#0101", "--can", f"udp:{OURS}:{PORT}"],
                                         capture_output=True, text=True, timeout=PATIENCE_S)
                self.assertEqual(refused.returncode, 1)
                run = start(["run", "scenarios/live.yaml", "--out", f"{folder}/run"], f"udp:{OURS}:{PORT}", "--interface", "lo")
                try:
                    subprocess.run([KOBOSHI, "can", "dump", "--count", "10", "--interface", "lo", "--can",
                                    f"udp:{OURS}:{PORT}"], check=True, stdout=subprocess.DEVNULL, timeout=PATIENCE_S)
                finally:
                    run.terminate()
                    run.communicate()
            finally:
                subprocess.run(["ip", "route", "add", "239.0.0.0/8", "dev", "lo"], check=True)


def bytes_out():
    """Bytes that have left the host through the interface `wire`, by its other end. Packets would not do: the kernel counts a
    train of datagrams once."""
    for line in pathlib.Path("/proc/net/dev").read_text().splitlines():
        name, _, counts = line.partition(":")
        if name.strip() == "far":
            return int(counts.split()[0])
    raise AssertionError("no interface `far`")


class OnAHostWithADefaultRoute(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        def ip(*commands):
            for command in commands:
                subprocess.run(["ip", *command.split()], check=True)

        ip("route del 239.0.0.0/8", "link add wire type veth peer name far", "addr add 10.9.0.1/24 dev wire")
        settings = pathlib.Path("/proc/sys/net/ipv6/conf")
        (settings / "wire/accept_dad").write_text("0")  # its address of IPv6 is usable at once
        (settings / "far/disable_ipv6").write_text("1")  # it stands for another host
        ip("link set wire up", "link set far up", "route add default via 10.9.0.2")

    @classmethod
    def tearDownClass(cls):
        subprocess.run(["ip", "link", "del", "wire"], check=True)
        subprocess.run(["ip", "route", "add", "239.0.0.0/8", "dev", "lo"], check=True)

    def heard(self, count, *arguments, group=OURS):
        """Starts a board; python-can hears its frames, reads an object, and returns how many bytes left the host."""
        place = f"udp:[{group}]:{PORT}" if ":" in group else f"udp:{group}:{PORT}"
        board = start(["board"], place, *arguments)
        try:
            with can.Bus(interface="udp_multicast", channel=group, port=PORT, hop_limit=0) as bus:
                before = bytes_out()
                for _ in range(count):
                    self.assertIsNotNone(bus.recv(PATIENCE_S))
                bus.send(can.Message(arbitration_id=0x610, data=[0x40, 0, 0x10, 0, 0, 0, 0, 0], is_extended_id=False))
                while (answer := bus.recv(PATIENCE_S)).arbitration_id != 0x590:
                    pass
                self.assertEqual(bytes(answer.data), bytes.fromhex("4300100092010200"))
                return bytes_out() - before
        finally:
            board.terminate()
            board.communicate()

    def test_talks_to_python_can_and_stays_on_the_host(self):
        self.assertLess(self.heard(200), 5_000)

    def test_joins_a_group_of_ipv6(self):
        self.assertLess(self.heard(200, group="ff15::74:163:2"), 5_000)

    def test_reaches_the_network_segment_if_it_is_to(self):
        self.assertGreater(self.heard(200, "--ttl", "1"), 20_000)


if __name__ == "__main__":
    unittest.main()
