"""Output of `--help`: placeholders that describe the values, and examples that work."""

import concurrent.futures
import itertools
import os
import re
import shlex
import shutil
import signal
import subprocess
import unittest

import program as support

PROGRAM = None
FOLDERS = itertools.count()
PATIENCE_s = 1.0  # an example that still runs after this time counts as accepted
SETUP_PATIENCE_s = 60.0  # the same for those whose files other examples read: on a busy machine a run takes seconds to begin

# Shortens examples that take long or need a terminal or a bus. The first matching pattern applies.
SHORTER = (
    (r"^run .*teleop.*--view", "--duration 0.02 --out runs/view"),
    (r"^run .*teleop", "--set teleop=false --duration 0.02"),
    (r"^motion play .*--view", "--out runs/play_view"),
    (r"^run ", "--duration 0.02"),
    (r"^(board|firmware) ", "--duration 0.02"),
    (r"^experiment (gyro-feedback|walking-speed|push-recovery|terrain|stand-up|fall-detection|marathon|learned)", "--jobs 1"),
    (r"^validate", "--short --only slope"),
    (r"^bring-up", "--seeds 1 --candidates 0 --until hangs"),
)
# Replacements for resources that this machine may lack.
REPLACED = (
    ("-o robots/kit", "-o kit/robot"),  # robots/ is that of the sources
    ("bring-up robots/kit", "bring-up kit/similar"),
    (" --controller qemu", ""),  # the image
    ("socketcan:vcan0", "socketcan:vcan_none"),
    ("--parallel 2/localhost", "--parallel 1/no.such.host.invalid"),
    ("udp:239.74.163.2:43113", "udp:239.74.163.99:43999"),  # a group without other members
)


def helps(path=()):
    """Returns each command with its help."""
    text = PROGRAM.run(*path, "--help").stdout
    yield path, text
    commands = re.search(r"^Subcommands:\n((?:  .*\n?)+)", text, re.MULTILINE)
    for command in re.findall(r"^  (\S+)", commands.group(1), re.MULTILINE) if commands else ():
        yield from helps((*path, command))


def examples(texts):
    found = {}
    for text in texts:
        for line in re.sub(r"\\\n\s*", "", text).splitlines():
            if re.match(r"  koboshi ", line):
                found[re.sub(r"   .*| &$", "", line.strip())] = None
    return list(found)


URDF = """<robot name="kit">
  <link name="body"/><link name="head"/>
  <joint name="neck" type="revolute"><parent link="body"/><child link="head"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
</robot>"""


class Help(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.texts = dict(helps())
        cls.folder = support.temporary_folder(cls)
        for name in ("scenarios", "robots", "studies"):
            (cls.folder / name).symlink_to(support.ROOT / name)
        (cls.folder / "docs" / "reference").mkdir(parents=True)
        shutil.copy(support.ROOT / "docs" / "reference" / "drive.eds", cls.folder / "docs" / "reference")
        (cls.folder / "docs" / "tutorial").symlink_to(support.ROOT / "docs" / "tutorial")
        (cls.folder / "kit").mkdir()
        (cls.folder / "kit" / "robot.urdf").write_text(URDF)
        (cls.folder / "kit" / "similar").mkdir()
        for name in ("robot.sdf", "meshes"):
            (cls.folder / "kit" / "similar" / name).symlink_to(support.ROOT / "robots" / "koboshi" / name)

    def test_knows_all_commands(self):
        self.assertGreater(len(self.texts), 30)

    def test_says_what_a_value_is(self):
        for path, text in self.texts.items():
            with self.subTest(path):
                self.assertNotRegex(text, r"\b(TEXT|FLOAT|UINT|INT|ENUM)\b|->")

    def test_names_enumerations(self):
        self.assertIn("{cma-es,nsga-2}", self.texts[("tune",)])
        self.assertIn("{world,lumped,mujoco}", self.texts[("run",)])

    def test_json_is_a_file_everywhere(self):
        for path, text in self.texts.items():
            if "--json" in text:
                # The commands on motions take several files, and print.
                self.assertIn("--json  " if path[:1] in (("motion",), ("model",)) else "--json FILE", text, path)

    def test_examples_are_accepted(self):
        for folder in ("runs/host", "runs/target", "runs/walk"):
            self.assertEqual(0, self.play(f"koboshi run scenarios/walk.yaml --out {folder}", SETUP_PATIENCE_s)[0])
        all_examples = examples(self.texts.values())
        self.assertGreater(len(all_examples), 40)
        self.assertEqual(0, self.play("koboshi motion compile robots/koboshi/motions/squat.yaml -o squat.kmot", SETUP_PATIENCE_s)[0])
        self.assertEqual(0, self.play("koboshi " + self.servo_type(all_examples), SETUP_PATIENCE_s)[0])
        shards = "koboshi experiment stand-up --seeds 1000 --shards plan --shard 1/100 --out runs/wide"
        self.assertEqual(0, self.play(shards, SETUP_PATIENCE_s)[0])
        # A run empties its folder before it writes, and other examples read it.
        runs = [example for example in all_examples if example.startswith("koboshi run ")]
        for group in (runs, [example for example in all_examples if example not in runs]):
            with concurrent.futures.ThreadPoolExecutor(4) as pool:
                for example, (status, errors) in zip(group, pool.map(self.play, group)):
                    self.check_example(example, status, errors)

    def check_example(self, example, status, errors):
        with self.subTest(example):
            if "target-report" in example and "./run target writes" in errors:
                return  # the image is not built
            if "policy import" in example and "this build of koboshi cannot read ONNX" in errors:
                return
            if example.startswith("koboshi lab ") and re.search(r"found incomplete shards|found no such program", errors):
                return  # nothing is played, and neither Slurm nor GNU parallel has to be installed
            # Without its bus, or its cluster, a command may fail, but not with a usage error.
            needs_bus = re.search(r"--can |can (sdo|nmt|send)|^koboshi lab ", example)
            self.assertIn(status, (0, 1) if needs_bus else (0,), errors)

    def servo_type(self, all_examples):
        """Returns the example that writes the input file of another example."""
        return next(example for example in all_examples if " > " in example).removeprefix("koboshi ")

    def play(self, example, patience_s=PATIENCE_s):
        arguments = example.removeprefix("koboshi ")
        for old, new in REPLACED:
            arguments = arguments.replace(old, new)
        for pattern, more in SHORTER:
            if re.search(pattern, arguments):
                if "--duration" in more:
                    arguments = re.sub(r" --duration \S+", "", arguments)
                head, mark, tail = arguments.partition(" >")
                arguments = f"{head} {more}{mark}{tail}"
                break
        if arguments.startswith("render "):  # of a run of 0.02 s
            arguments = re.sub(r" --(from|to) \S+", "", re.sub(r"--at \S+", "--at 0.01", arguments))
        if arguments.startswith(("experiment ", "run ")) and "--out" not in arguments:
            arguments += f" --out runs/{next(FOLDERS)}"  # examples with one folder run in parallel
        if re.match(r"can (sdo|nmt|send)", arguments):
            arguments += " --can socketcan:vcan_none"
        command = f"exec {shlex.quote(str(PROGRAM.path))} {arguments}"
        environment = {**os.environ, "TMPDIR": str(self.folder), "SLURM_CONF": str(self.folder / "no_slurm.conf")}
        # In a session of its own: what the command has started ends with it, instead of holding its pipes open.
        with subprocess.Popen(command, shell=True, cwd=self.folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              stdin=subprocess.DEVNULL, text=True, start_new_session=True) as process:
            try:
                _, errors = process.communicate(timeout=patience_s)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
                return 0, ""
            return process.returncode, errors


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
