"""with_vcan.sh chooses correctly between namespaces and User-mode Linux, and both give the command the same environment.
Wrapper programs emulate a kernel with vcan, by an interface of another kind, and kernels without."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("with_vcan.sh")
UNSHARE = ["unshare", *([] if os.geteuid() == 0 else ["--map-root-user"])]

# Any interface that is up can replace a vcan0 that carries no frames.
WITH_VCAN = {"ip": """for word; do shift; [ "$word" != vcan ] || word=ifb; set -- "$@" "$word"; done; exec "$REAL" "$@" """,
             "candump": "exit 0"}
WITHOUT_VCAN = {"ip": 'case "$*" in *vcan) echo "Error: Unknown device type." >&2; exit 2;; *) exec "$REAL" "$@";; esac'}
WITHOUT_CAN_RAW = WITH_VCAN | {"candump": "echo 'socket: Address family not supported by protocol' >&2; exit 1"}
WITHOUT_RIGHT_TO_BUFFERS = WITH_VCAN | {"candump": "echo 'The socket receive buffer size was adjusted' >&2"}
WITHOUT_NAMESPACES = {"unshare": "echo 'unshare: unshare failed: Operation not permitted' >&2; exit 1"}


def can_make_namespaces():
    command = [*UNSHARE, "--net", "--mount", "--pid", "--fork", "--mount-proc", "ip", "link", "add", "vcan0", "type", "ifb"]
    path = os.environ["PATH"] + ":/usr/sbin"
    return subprocess.run(command, env=os.environ | {"PATH": path}, capture_output=True, check=False).returncode == 0


class WithVcan(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.script = self.folder / "with_vcan.sh"
        shutil.copy(SCRIPT, self.script)
        self.write("in_uml.sh", 'echo "UML: $*"; exit 5')

    def write(self, name, text):
        file = self.folder / name
        real = shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin:/sbin")
        file.write_text(f"#!/bin/sh\nREAL={real}\n{text}\n")
        file.chmod(0o755)

    def run_on(self, programs, *command):
        for name, text in programs.items():
            self.write(name, text)
        environment = os.environ | {"PATH": f"{self.folder}:{os.environ['PATH']}"}
        result = subprocess.run([self.script, *command], env=environment, cwd=self.folder, text=True, timeout=60, check=False,
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        first, _, rest = result.stdout.partition("\n")
        return result.returncode, first, rest.splitlines()


@unittest.skipUnless(can_make_namespaces(), "no namespace of network, mounts and processes can be made here, or none with an ifb")
class InNamespaces(WithVcan):
    def run_inside(self, script):
        status, first, lines = self.run_on(WITH_VCAN, "sh", "-c", script)
        self.assertEqual(first, "vcan0: in a network namespace")
        return status, lines

    def test_commands_keep_their_words_status_and_folder(self):
        status, first, lines = self.run_on(WITH_VCAN, "sh", "-c", 'pwd; for word; do echo "<$word>"; done; exit 3', "sh", "a  b", "it's", "$x")
        self.assertEqual(first, "vcan0: in a network namespace")
        self.assertEqual((status, lines), (3, [str(self.folder), "<a  b>", "<it's>", "<$x>"]))

    def test_vcan0_is_there_and_up_and_nothing_else_but_lo(self):
        _, lines = self.run_inside("ip -brief link")
        self.assertEqual([line.split()[0] for line in lines], ["lo", "vcan0"])
        self.assertIn("UP", lines[1])

    def test_mnt_is_empty_and_of_memory_and_does_not_show_outside(self):
        before = sorted(pathlib.Path("/mnt").iterdir())
        _, lines = self.run_inside("ls -A /mnt; echo of tests >/mnt/file; stat -f -c %T /mnt; cat /mnt/file")
        self.assertEqual(lines, ["tmpfs", "of tests"])
        self.assertEqual(sorted(pathlib.Path("/mnt").iterdir()), before)

    def test_processes_outside_cannot_be_seen_nor_ended(self):
        outside = subprocess.Popen(["sleep", "60"])
        self.addCleanup(outside.wait)
        self.addCleanup(outside.kill)
        status, _ = self.run_inside("pgrep -x sleep || pkill -x sleep")
        self.assertEqual((status, outside.poll()), (1, None))

    def test_orphans_that_end_are_gone(self):
        status, lines = self.run_inside("sh -c 'sleep 0.01 &'; while pgrep -x sleep; do sleep 0.02; done >/dev/null; echo gone")
        self.assertEqual((status, lines), (0, ["gone"]))

    def test_nothing_is_left_running(self):
        self.run_inside("sleep 61.25 & exit 0")
        found = subprocess.run(["pgrep", "-f", "^sleep 61.25$"], capture_output=True, check=False)
        self.assertEqual(found.returncode, 1)

    def test_input_is_empty(self):
        self.assertEqual(self.run_inside("wc -c")[1], ["0"])


class InUserModeLinux(WithVcan):
    def assert_in_uml(self, programs, reason):
        status, first, lines = self.run_on(programs, "true", "argument")
        self.assertEqual((status, lines), (5, ["UML: true argument"]))
        self.assertRegex(first, "^vcan0: in User-mode Linux, .*" + reason)

    def test_where_namespaces_are_not_allowed(self):
        self.assert_in_uml(WITHOUT_NAMESPACES, "Operation not permitted")

    @unittest.skipUnless(can_make_namespaces(), "no namespaces here")
    def test_where_the_kernel_lacks_something(self):
        self.assert_in_uml(WITHOUT_VCAN, "Unknown device type")
        self.assert_in_uml(WITHOUT_CAN_RAW, "Address family not supported")
        self.assert_in_uml(WITHOUT_RIGHT_TO_BUFFERS, "receive buffer size")


if __name__ == "__main__":
    unittest.main(verbosity=2)
