"""koboshi can against a live bus and the logs of real buses.

can_commands.py KOBOSHI, in a network namespace of its own. `koboshi board` is the bus, python-can the others on it.
"""

import os
import pathlib
import select
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import can

KOBOSHI = sys.argv[1]
ROOT = pathlib.Path(__file__).resolve().parents[2]
GROUP, PORT = "239.74.163.2", 43113
BUS = f"udp:{GROUP}:{PORT}"
PATIENCE_S = 60.0  # a loaded machine is slow
# The variants of can-utils, and frames of others on the bus.
REAL_LOG = """\
# recorded with candump -l
(1700000000.000100) can0 080# R
(1700000000.000300) can0 181#0102030405060708 T\r
(1700000000.000500) can0 18FEF100#01020304

(1700000000.000700)  can0 123##1AABB
(1700000000.000900) can0 20000004#0001000000000000
(1700000000.001100) can0 701#R
(1700000000.001300) can0 701#05
(1700000000.0015"""


def run(*arguments, **options):
    return subprocess.run([KOBOSHI, *map(str, arguments)], cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S,
                          check=False, **options)


def open_bus():
    return can.Bus(interface="udp_multicast", channel=GROUP, port=PORT)


class Files(unittest.TestCase):
    """A folder for the test's files."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_can_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log = self.write("real.log", REAL_LOG)

    def write(self, name, text):
        file = self.folder / name
        file.write_text(text, newline="")
        return file

    def start(self, *arguments):
        process = subprocess.Popen([KOBOSHI, *map(str, arguments)], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        self.addCleanup(lambda: process.communicate() if process.poll() is not None else (process.kill(), process.communicate()))
        return process


class Logs(Files):
    def test_dump_shows_foreign_frames_and_goes_on(self):
        result = run("can", "dump", self.log)
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.splitlines()
        self.assertEqual([line.split()[1] for line in lines],
                         ["080#", "181#0102030405060708", "18FEF100#01020304", "123##1AABB", "20000004#0001000000000000",
                          "701#R", "701#05"])
        self.assertIn("29-bit identifier", lines[2])
        self.assertIn("CAN FD, bit rate switch", lines[3])
        self.assertIn("error frame: controller (receive overflow)", lines[4])
        self.assertIn(f"{self.log}:10: the last line has no end", result.stderr)
        self.assertIn("1 with a 29-bit identifier, 1 in the format of CAN FD, 1 error frame, 1 remote frame", result.stderr)
        for choice, count in (("--kind=foreign", 4), ("--id=18FEF100", 1), ("--id=181", 1), ("--node=1", 3)):
            self.assertEqual(len(run("can", "dump", self.log, choice).stdout.splitlines()), count, choice)

    def test_two_buses_are_kept_apart(self):
        log = self.write("two.log", "(1.000000) can0 181#0102030405060708\n(1.000001) can1 181#0102030405060708\n")
        result = run("can", "stats", log)
        self.assertIn("can0: 1 frame in", result.stdout)
        self.assertIn("can1: 1 frame in", result.stdout)
        self.assertNotIn("11400", result.stdout)
        self.assertIn("can1   181#", run("can", "dump", log).stdout)
        self.assertEqual(len(run("can", "dump", log, "--bus", "can1").stdout.splitlines()), 1)
        refused = run("can", "replay", log, "--can", BUS)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("expected --bus with one of can0 or can1", refused.stderr)

    def test_refuses_an_interface_without_frames(self):
        log = self.write("two.log", "(1.000000) can0 181#00\n(1.000001) can1 181#00\n")
        for command in (("dump",), ("stats",), ("export", "--out", self.folder / "out.csv"), ("replay", "--can", BUS)):
            for place, options in ((log, {}), ("-", {"input": log.read_text()})):
                result = run("can", command[0], place, *command[1:], "--bus", "nosuch", **options)
                name = log if place == log else "standard input"
                self.assertEqual((result.returncode, result.stderr),
                                 (2, f"{name}: found no frames of nosuch, expected an interface of the log: can0 or can1\n"),
                                 (command, place))

    def test_says_how_it_reads_the_times(self):
        log = self.write("delta.log", "(000.000000) can0 181#00\n(000.010000) can0 181#00\n(000.005000) can0 181#00\n")
        for choice, times, warning in (((), "0.015000", "read as differences"), (("--times", "delta"), "0.015000", None),
                                       (("--times", "absolute"), "0.010000", "1 frame out of order")):
            result = run("can", "dump", log, *choice)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stdout.splitlines()[-1].split()[0], times, choice)
            self.assertEqual(len(result.stderr.splitlines()), 0 if warning is None else 1, result.stderr)
            self.assertIn(warning or "", result.stderr)
        pipe = run("can", "dump", "-", input=log.read_text())
        self.assertEqual(pipe.returncode, 2)
        self.assertIn("--times delta reads", pipe.stderr)

    def test_dump_knows_the_segments_of_block_transfers(self):
        frames = ["610#C600210107000000", "590#A40021017F000000", "610#8118100100000000", "590#A2017F0000000000", "610#C100000000000000",
                  "590#A100000000000000", "610#4018100100000000"]
        log = self.write("block.log", "".join(f"(1.{number:06}) can0 {frame}\n" for number, frame in enumerate(frames)))
        text = run("can", "dump", log).stdout
        self.assertIn("610#8118100100000000    SDO node 16: block segment 1, the last\n", text)
        self.assertIn("610#4018100100000000    SDO node 16: read 1018:01\n", text)
        # Also without the answers, which the filter leaves out.
        self.assertIn("block segment 1, the last", run("can", "dump", log, "--id", "610").stdout)
        self.assertEqual(run("can", "export", log, "--out", self.folder / "block.csv").returncode, 0)
        self.assertIn("block segment 1, the last", (self.folder / "block.csv").read_text())

    def test_dump_shows_layer_setting_services(self):
        log = self.write("lss.log", "(1.000000) can0 7E5#1128000000000000\n(1.100000) can0 7E4#1100000000000000\n(1.200000) can0 181#00\n")
        lines = run("can", "dump", log, "--kind", "lss").stdout.splitlines()
        self.assertEqual([line.split("  ")[-1] for line in lines],
                         ["LSS master: configure node id 40", "LSS slave: configure node id done"])
        self.assertIn("LSS", run("can", "stats", log).stdout)

    def test_reads_logs_of_other_systems(self):
        log = self.write("mac.log", "\ufeff(1.000000) can0 181#00\r(1.000100) can0 181#00\r")
        self.assertEqual(len(run("can", "dump", log).stdout.splitlines()), 2)
        self.assertEqual(run("can", "export", log, "--out", self.folder / "OUT.ASC").returncode, 0)
        self.assertTrue((self.folder / "OUT.ASC").read_text().startswith("base hex"))

    def test_refuses_the_screen_format(self):
        result = run("can", "stats", self.write("screen.log", "  vcan0  123   [2]  00 11\n"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("record it with `candump -L`", result.stderr)

    def test_reads_a_pipe_as_it_comes_and_ends_by_a_signal(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        dump = self.start("can", "dump", fifo)
        with open(fifo, "w") as writer:
            writer.write("(000.000000) can0 080#\n")
            writer.flush()
            self.assertIn("080#", dump.stdout.readline())
            dump.send_signal(signal.SIGTERM)
            self.assertEqual(dump.wait(PATIENCE_S), 0)

    def test_statistics_and_tables_of_a_pipe_end_by_a_signal(self):
        cases = {"stats": ((), 0, "1 frame in", ""),
                 "export": (("--out", self.folder / "cut.csv"), 128 + signal.SIGINT, "", "interrupted after 1 frame\n")}
        for command, (options, status, shown, said) in cases.items():
            with self.subTest(command):
                fifo = self.folder / f"{command}.fifo"
                os.mkfifo(fifo)
                process = self.start("can", command, fifo, *options)
                with open(fifo, "w") as writer:  # once the program has opened it, it holds signals back
                    writer.write("(000.000000) can0 080#\n")
                    writer.flush()
                    time.sleep(0.5)
                    process.send_signal(signal.SIGINT)
                    output, errors = process.communicate(timeout=PATIENCE_S)
                self.assertEqual(process.returncode, status, errors)
                self.assertIn(shown, output)
                self.assertIn(said, errors)
        self.assertEqual(len((self.folder / "cut.csv").read_text().splitlines()), 2)  # the rows so far

    def test_asc2log_gives_the_exported_log_again(self):
        frames = [line for line in REAL_LOG.splitlines() if line.startswith("(") and "#" in line and "20000004" not in line]
        log = self.write("whole.log", "\n".join(frames) + "\n")
        asc = self.folder / "whole.asc"
        self.assertEqual(run("can", "export", log, "--out", asc).returncode, 0)
        subprocess.run(["asc2log", "-I", asc, "-O", self.folder / "back.log"], check=True)
        words = [line.split()[:3] for line in (self.folder / "back.log").read_text().splitlines()]
        self.assertEqual(words, [line.split()[:3] for line in frames])
        # Our own log, whose times begin at zero, and the table.
        self.assertEqual(run("can", "export", log, "--out", self.folder / "whole.csv").returncode, 0)
        table = (self.folder / "whole.csv").read_text().splitlines()
        self.assertEqual(len(table), len(frames) + 1)
        self.assertEqual(table[1], "1700000000.000100,can0,R,080,standard,0,0,,SYNC")


class Signals(Files):
    def end(self, process, number):
        process.send_signal(number)
        return process.wait(PATIENCE_S)

    def test_a_file_and_a_count_are_interrupted(self):
        log = self.write("long.log", "(1.000000) can0 181#00\n" * 200_000)
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            dump = self.start("can", "dump", log)
            self.assertTrue(dump.stdout.readline())
            dump.send_signal(number)  # while it waits for room in the pipe
            said = dump.communicate(timeout=PATIENCE_S)[1]
            self.assertEqual(dump.returncode, status)
            self.assertRegex(said, r"^koboshi: interrupted after \d+ frames?\n$")
            dump = self.start("can", "dump", "--can", BUS, "--count", 1000)
            self.see_a_frame(dump)
            self.assertEqual(self.end(dump, number), status)
            self.assertRegex(dump.stderr.read(), r"koboshi: interrupted after \d+ frames?\n$")

    def test_a_live_bus_is_watched_until_a_signal(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            dump = self.start("can", "dump", "--can", BUS)
            self.see_a_frame(dump)
            self.assertEqual(self.end(dump, number), 0)
            self.assertEqual(dump.stderr.read(), "")

    def see_a_frame(self, dump):
        with open_bus() as bus:
            while not select.select([dump.stdout], [], [], 0.05)[0]:  # it may not listen yet
                self.assertIsNone(dump.poll())
                bus.send(can.Message(arbitration_id=0x80, is_extended_id=False))

    def test_replay_ends_in_a_pause(self):
        log = self.write("pause.log", "(1.000000) can0 123#\n(3601.000000) can0 124#\n")
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with open_bus() as bus:
                replay = self.start("can", "replay", log, "--can", BUS)
                self.assertEqual(bus.recv(PATIENCE_S).arbitration_id, 0x123)
                replay.send_signal(number)
                self.assertEqual(replay.wait(PATIENCE_S), status)
            self.assertIn("interrupted after 1 frame", replay.stderr.read())

    def test_stats_ends_on_a_silent_bus(self):
        stats = self.start("can", "stats", "--can", BUS, "--duration", 3600)
        with open_bus() as bus:
            while stats.poll() is None:  # it may not listen yet
                bus.send(can.Message(arbitration_id=0x80, is_extended_id=False))
                time.sleep(0.1)
                stats.send_signal(signal.SIGINT)
        self.assertIn(stats.returncode, (0, -signal.SIGINT))


class LiveBus(Files):
    def setUp(self):
        super().setUp()
        self.board = self.start("board", "--can", BUS)
        self.board.stdout.readline()

    def test_scan_finds_every_node(self):
        result = run("can", "scan", "--can", BUS, "--duration", 2)
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = [line.split() for line in result.stdout.splitlines()]
        self.assertEqual([row[0] for row in rows if row[0].isdigit()], [str(node) for node in range(16, 39)])
        drive = next(row for row in rows if row[0] == "16")
        self.assertIn("4B4F4249", drive)
        self.assertTrue(" ".join(drive).endswith("Koboshi servo drive"), drive)

    def test_scan_says_what_it_saw(self):
        self.board.terminate()
        self.board.wait()
        silent = run("can", "scan", "--can", BUS, "--duration", 0.05)
        self.assertEqual(silent.returncode, 1)
        self.assertRegex(silent.stderr, rf"^koboshi: no node of {GROUP}:{PORT} answers or sends heartbeats; "
                                        r"no frame passed within \d+\.\d s\n$")
        scan = self.start("can", "scan", "--can", BUS, "--duration", 0.2)
        with open_bus() as bus:
            while scan.poll() is None:
                bus.send(can.Message(arbitration_id=0x190, data=bytes(8), is_extended_id=False))
                time.sleep(0.01)
        self.assertEqual(scan.returncode, 1)
        self.assertRegex(scan.stderr.read(), r"; \d+ frames passed within \d+\.\d s, with the identifier 190: ")

    def test_lss_sets_a_node_id(self):
        inquired = run("can", "lss", "inquire", "--node", 16, "--can", BUS)
        self.assertEqual(inquired.returncode, 0, inquired.stderr)
        address, node = inquired.stdout.split(maxsplit=1)
        self.assertEqual(node, "node 16\n")
        several = run("can", "lss", "set-node", 40, "--can", BUS)
        self.assertEqual(several.returncode, 1)
        self.assertIn("several LSS slaves", several.stderr)
        refused = run("can", "lss", "bit-rate", 500, "--address", address, "--can", BUS)
        self.assertEqual((refused.returncode, refused.stderr),
                         (1, "koboshi: the LSS slave refuses the bit timing: it does not support this bit rate\n"))
        self.assertEqual(run("can", "lss", "find", "--can", BUS).returncode, 1)
        self.assertEqual(run("can", "lss", "set-node", 40, "--address", address, "--can", BUS).returncode, 0)
        run("can", "nmt", "reset-communication", 16, "--can", BUS)
        self.assertEqual(run("can", "sdo", "read", 40, "1018:1", "--can", BUS).returncode, 0)

    def test_dcf_compares_and_writes(self):
        eds = ROOT / "docs/reference/drive.eds"
        compared = run("can", "dcf", 16, eds, "--can", BUS)
        self.assertNotEqual(compared.returncode, 2, compared.stderr)
        self.assertEqual(run("can", "dcf", 16, eds, "--write", "--can", BUS).returncode, 2)
        dcf = self.folder / "drive.dcf"
        text = eds.read_text()
        for section, value in (("1017", "200"), ("6083", "5000"), ("1400sub1", "$NODEID+0x80000200"), ("1600sub0", "1"),
                               ("1600sub1", "0x60400010")):
            head = f"[{section}]\n"
            self.assertIn(head, text)
            text = text.replace(head, f"{head}ParameterValue={value}\n")
        dcf.write_text(text)
        self.assertEqual(run("can", "dcf", 17, dcf, "--can", BUS).returncode, 1)
        written = run("can", "dcf", 17, dcf, "--write", "--can", BUS)
        self.assertEqual(written.returncode, 0, written.stdout + written.stderr)
        self.assertEqual(run("can", "dcf", 17, dcf, "--can", BUS).returncode, 0)
        self.assertTrue(run("can", "sdo", "read", 17, "1017", "--can", BUS).stdout.startswith("0x00C8"))
        other = run("can", "dcf", 36, dcf, "--write", "--can", BUS)
        self.assertEqual(other.returncode, 1)
        self.assertIn("nothing is written", other.stderr)

    def test_dcf_writes_what_is_locked_while_it_is_in_use(self):
        eds = (ROOT / "docs/reference/drive.eds").read_text()

        def write(**values):
            text = eds
            for section, value in values.items():
                head = f"[{section.removeprefix('o')}]\n"
                self.assertIn(head, text)
                text = text.replace(head, f"{head}ParameterValue={value}\n")
            dcf = self.folder / "drive.dcf"
            dcf.write_text(text + "\n[DeviceComissioning]\nNodeID=18\n")
            written = run("can", "dcf", 18, dcf, "--write", "--can", BUS)
            self.assertEqual(written.returncode, 0, written.stdout + written.stderr)

        write(o1400sub1="$NODEID+0x300", o1600sub0=1, o1600sub1="0x60400010", o1401sub1="$NODEID+0x200", o1601sub0=1,
              o1601sub1="0x60600008")
        write(o1016sub1="0x010064", o1016sub2="0x020064")
        write(o1016sub1="0x020064", o1016sub2="0x010064")
        write(o1014="0xB0", o1006=10000, o1019=10, o1017=500, o1020sub1=15000, o1020sub2=1000)
        write(o1600sub2="0x607A0020")
        self.assertTrue(run("can", "sdo", "read", 18, "1600:0", "--can", BUS).stdout.startswith("0x01"))
        self.assertTrue(run("can", "sdo", "read", 18, "1400:1", "--can", BUS).stdout.startswith("0x00000312"))

    def test_lss_assigns_no_node_id_in_use(self):
        self.assertEqual(run("can", "lss", "set-node", "none", "--node", 35, "--can", BUS).returncode, 0)
        run("can", "nmt", "reset-communication", 35, "--can", BUS)
        for command in (("find", "--assign", 34), ("find", "--assign", 36)):
            refused = run("can", "lss", *command, "--can", BUS)
            self.assertEqual(refused.returncode, 1, refused.stdout)
            self.assertRegex(refused.stderr, f"^koboshi: node id {command[-1]} is in use by Koboshi [a-z ]+, 4B4F4249:[0-9A-F:]+: nothing is "
                                             "assigned to a slave without a node id\n$")
        self.assertEqual(run("can", "sdo", "read", 34, "1018:4", "--can", BUS).returncode, 0)
        given = run("can", "lss", "find", "--assign", 35, "--can", BUS)
        self.assertEqual(given.returncode, 0, given.stderr)
        self.assertRegex(given.stdout, "^4B4F4249:[0-9A-F:]+  node 35\n$")
        warned = run("can", "lss", "set-node", 34, "--node", 35, "--can", BUS)
        self.assertEqual(warned.returncode, 0, warned.stderr)
        self.assertIn("node id 34 is in use by Koboshi servo drive", warned.stderr)

    def test_foreign_frames_do_not_end_the_reading(self):
        dump = self.start("can", "dump", "--can", BUS, "--kind", "foreign", "--count", 3)
        with open_bus() as bus:
            while dump.poll() is None:  # it may not listen yet
                bus.send(can.Message(arbitration_id=0x18FEF100, data=[1, 2], is_extended_id=True))
                bus.send(can.Message(arbitration_id=0x123, data=bytes(12), is_fd=True, is_extended_id=False, bitrate_switch=True))
                bus.send(can.Message(arbitration_id=0x4, data=bytes(8), is_error_frame=True))
                time.sleep(0.05)
        shown = {line.split(maxsplit=1)[1].rstrip() for line in dump.stdout.read().splitlines()}
        self.assertEqual({line.split()[0] for line in shown},
                         {"18FEF100#0102", "123##1" + 12 * "00", "20000004#" + 8 * "00"})
        self.assertEqual(run("can", "sdo", "read", 16, "1000", "--can", BUS).returncode, 0)


class WithController(Files):
    """The controller is a client of the drives' first SDO channel."""

    def setUp(self):
        super().setUp()
        self.robot = self.start("run", "scenarios/live.yaml", "--can", BUS, "--out", self.folder / "run")
        self.robot.stdout.readline()  # about the bus
        for _ in range(100):  # until it is limp and ready, the controller itself reads the identities
            if run("can", "sdo", "read", 1, "2001:1", "--can", BUS).stdout.startswith("0x01"):
                return
            time.sleep(0.1)
        self.fail("the robot does not get ready")

    def test_every_command_leaves_the_first_channel_to_it(self):
        dump = self.start("can", "dump", "--can", BUS, "--id", "610")
        scan = run("can", "scan", "--can", BUS)
        self.assertEqual(scan.returncode, 0, scan.stderr)
        rows = [line.split() for line in scan.stdout.splitlines()]
        self.assertEqual([row[0] for row in rows if row[0].isdigit()], ["1", *(str(node) for node in range(16, 36))])  # its sensors are not on the bus
        for row in rows[2:]:
            self.assertNotIn("-", row[2:7], row)
        eds = ROOT / "docs/reference/drive.eds"
        compared = [run("can", "dcf", 16, eds, "--can", BUS, *channel).stdout for channel in ((), ("--second",), ())]
        self.assertIn("compared as in", compared[0])
        self.assertNotIn("SDO abort", "".join(compared))
        inquired = run("can", "lss", "inquire", "--node", 16, "--second", "--can", BUS)
        self.assertEqual(inquired.returncode, 0, inquired.stderr)
        self.assertTrue(inquired.stdout.endswith("node 16\n"), inquired.stdout)
        for _ in range(10):
            self.assertTrue(run("can", "sdo", "read", 16, "1018:1", "--can", BUS).stdout.startswith("0x4B4F4249"))
        self.assertTrue(run("can", "sdo", "read", 16, "1018:1", "--first", "--can", BUS).stdout.startswith("0x4B4F4249"))
        both = run("can", "sdo", "read", 16, "1018:1", "--first", "--second", "--can", BUS)
        self.assertEqual(both.returncode, 2)
        dump.terminate()
        ours = [line for line in dump.communicate()[0].splitlines() if "1018" in line or "1000:" in line]
        self.assertLessEqual(len(ours), 1, ours)  # the one with --first


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
