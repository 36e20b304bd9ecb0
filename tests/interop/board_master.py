"""A CANopen master that reads the drives' objects from their EDS. It boots and enables the drives and moves each by five degrees.

board_master.py EDS INTERFACE CHANNEL [STEP], with python-can's names: socketcan vcan0, udp_multicast 239.74.163.2. The nodes on
the bus are those of `koboshi board`; only every STEP-th drive is enabled and moved, on a bus on which all would take minutes.
"""

import configparser
import errno
import socket
import struct
import sys
import threading
import time

import can

NODES = range(16, 36)
TPDO = 0x180
EVERY_SYNC, EVENTS = 1, 255  # transmission types
TURN = 1 << 20
STEP = TURN * 5 // 360
PATIENCE_S = 60.0  # a loaded machine is slow
SHUTDOWN, SWITCH_ON, ENABLE = 0x06, 0x07, 0x0F
FORMATS = {2: "<b", 3: "<h", 4: "<i", 5: "<B", 6: "<H", 7: "<I"}  # by data type of CiA 301


class Objects:
    """The objects of an EDS, by name."""

    def __init__(self, path):
        eds = configparser.ConfigParser(strict=True, interpolation=None)
        with open(path, encoding="ascii") as file:
            eds.read_file(file)
        self.by_name = {}
        for section in eds.sections():
            if not eds.has_option(section, "DataType"):
                continue
            index, _, sub = section.lower().partition("sub")
            address = int(index, 16), int(sub or "0", 16)
            self.by_name[eds[section]["ParameterName"].lower()] = address, int(eds[section]["DataType"], 0)

    def __getitem__(self, name):
        return self.by_name[name.lower()]


class Master:
    # Boot-up and SDO answers. Drives send events while their joints swing; on a slow machine they would displace an answer.
    ANSWERS = [{"can_id": 0x700, "can_mask": 0x780}, {"can_id": 0x580, "can_mask": 0x780}]

    def __init__(self, bus, objects):
        bus.set_filters(self.ANSWERS)
        self.bus, self.objects = bus, objects
        self.booted = set()
        self.syncing = threading.Event()
        self.ended = threading.Event()

    def sync_forever(self):
        due = time.monotonic()
        while not self.ended.is_set():
            if self.syncing.is_set():
                self.send(0x080, b"")
            due += 0.01
            time.sleep(max(0.0, due - time.monotonic()))

    def send(self, identifier, data):
        """Sends when the interface's queue has room, which takes time on a serial adapter."""
        message = can.Message(arbitration_id=identifier, data=data, is_extended_id=False)
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                return self.bus.send(message)
            except can.CanOperationError as error:
                if error.error_code != errno.ENOBUFS or time.monotonic() > end:
                    raise
            time.sleep(0.001)

    def receive(self, wanted, timeout_s=PATIENCE_S):
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            message = self.bus.recv(0.1)
            if message is None:
                continue
            if 0x700 < message.arbitration_id < 0x780 and bytes(message.data) == b"\0":
                self.booted.add(message.arbitration_id - 0x700)
            if message.arbitration_id == wanted:
                return bytes(message.data)
        raise TimeoutError("no frame" if wanted is None else f"no frame with identifier {wanted:03X}")

    def sdo(self, node, request):
        self.send(0x600 + node, request)
        answer = self.receive(0x580 + node)
        if answer[0] == 0x80:
            raise RuntimeError(f"node {node}: SDO abort {struct.unpack_from('<I', answer, 4)[0]:08X}")
        return answer

    def read(self, node, name):
        (index, sub), data_type = self.objects[name]
        answer = self.sdo(node, struct.pack("<BHBI", 0x40, index, sub, 0))
        return struct.unpack_from(FORMATS[data_type], answer, 4)[0]

    def write(self, node, name, value):
        (index, sub), data_type = self.objects[name]
        data = struct.pack(FORMATS[data_type], value)
        command = 0x23 | (4 - len(data)) << 2
        self.sdo(node, struct.pack("<BHB", command, index, sub) + data.ljust(4, b"\0"))

    def wait_for_boot(self):
        """Resets the nodes and waits for the boot-up message of each."""
        self.send(0x000, bytes([0x81, 0]))
        self.booted.clear()
        end = time.monotonic() + PATIENCE_S
        while not self.booted.issuperset(NODES):
            if time.monotonic() > end:
                raise TimeoutError(f"no boot-up of {sorted(set(NODES) - self.booted)}")
            try:
                self.receive(None, 0.2)
            except TimeoutError:
                pass

    def enable(self, node):
        self.write(node, "Modes of operation", 8)
        self.send(0x000, bytes([0x01, node]))
        for word, state in ((SHUTDOWN, 0x21), (SWITCH_ON, 0x23), (ENABLE, 0x27)):
            self.write(node, "Controlword", word)
            end = time.monotonic() + PATIENCE_S
            while (found := self.read(node, "Statusword") & 0x6F) != state:
                if time.monotonic() > end:
                    raise RuntimeError(f"node {node}: statusword {found:02X} after controlword {word:02X}")

    def move(self, node):
        """Returns the travel of a drive, in encoder counts, when its target moves one step towards the middle of its range.

        A proportional loop lags its target by an amount that depends on load and friction. A first step in the same direction
        settles this lag, so that both ends of the second step have the same one.
        """
        self.bus.set_filters([*self.ANSWERS, {"can_id": TPDO + node, "can_mask": 0x7FF}])
        self.set_transmission(node, EVERY_SYNC)
        limits = self.read(node, "Position limit minimum"), self.read(node, "Position limit maximum")
        start = self.read(node, "Position actual value")
        step = STEP if start < sum(limits) / 2 else -STEP
        self.lead(node, start, start + step)
        before = self.read(node, "Position actual value")
        self.lead(node, start + step, start + 2 * step)
        moved = (self.read(node, "Position actual value") - before) / step
        self.set_transmission(node, EVENTS)
        return moved

    def set_transmission(self, node, transmission_type):
        self.sdo(node, struct.pack("<BHBI", 0x2F, 0x1800, 2, transmission_type))

    def lead(self, node, start, end):
        for part in range(1, 11):
            self.write(node, "Target position", start + (end - start) * part // 10)
            self.wait_for_cycles(node, 2)
        self.wait_for_rest(node)

    def wait_for_cycles(self, node, count):
        """Waits for this many process data from the drive. It sends one per SYNC, so the wait follows the clock of the bus."""
        for _ in range(count):
            self.receive(TPDO + node)

    def wait_for_rest(self, node):
        """Waits until three consecutive readings differ by at most one encoder count."""
        end = time.monotonic() + PATIENCE_S
        readings = []
        while len(readings) < 3 or max(readings[-3:]) - min(readings[-3:]) > TURN // 4096:
            if time.monotonic() > end:
                raise TimeoutError(f"node {node} does not come to rest")
            self.wait_for_cycles(node, 10)
            readings.append(self.read(node, "Position actual value"))


def widen_receive_buffer(bus):
    """Enlarges the receive buffer. By default, 4,500 frames/s fill a socket in a few hundredths of a second while this process
    does not run, and the kernel drops the expected answer."""
    so_rcvbufforce = 33  # from asm-generic/socket.h; Python does not name it. Needs root; other users keep the default
                         # size.
    try:
        bus.socket.setsockopt(socket.SOL_SOCKET, so_rcvbufforce, 1 << 24)
    except (AttributeError, PermissionError):
        pass


def main():
    eds, interface, channel, step = (*sys.argv[1:], "1")[:4]
    nodes = NODES[::int(step)]
    with can.Bus(interface=interface, channel=channel) as bus:
        widen_receive_buffer(bus)
        master = Master(bus, Objects(eds))
        thread = threading.Thread(target=master.sync_forever, daemon=True)
        thread.start()
        master.wait_for_boot()
        master.syncing.set()
        for node in nodes:
            master.enable(node)
        for node in nodes:
            moved = master.move(node)
            if not 0.9 < moved < 1.1:
                raise RuntimeError(f"node {node}: moved by {moved:.2f} of its step")
        master.ended.set()
        thread.join()
    print(f"{len(NODES)} drives booted, {len(nodes)} enabled and moved")


if __name__ == "__main__":
    main()
