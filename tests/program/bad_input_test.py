"""Bad input causes one line, FILE:LINE: found ..., expected ..., and exit status 2. The program writes nothing."""

import pathlib
import re
import shutil
import socket
import struct
import subprocess
import tempfile
import unittest

import program as support

PROGRAM = None
ROBOT = support.ROOT / "robots" / "koboshi"
MOTION = ROBOT / "motions" / "squat.yaml"

SCENARIO = f"""version: 1
robot: {ROBOT / "robot.sdf"}
motions: [{MOTION}]
duration_s: 1
"""

# Text to replace, its replacement, and the line that the message must name.
BAD_SCENARIOS = {
    "unknown key": ("duration_s: 1", "duration_s: 1\nduratoin: 2", 5),
    "doubled key": ("duration_s: 1", "duration_s: 1\nduration_s: 2", 5),
    "other version": ("version: 1", "version: 7", 1),
    "out of range": ("duration_s: 1", "duration_s: -1", 4),
    "not a number": ("duration_s: 1", "duration_s: long", 4),
    "neither true nor false": ("duration_s: 1", "duration_s: 1\nteleop: perhaps", 5),
    "malformed": ("duration_s: 1", "duration_s: [1", None),
    "missing key": ("duration_s: 1\n", "", None),
    "missing robot": ("robot.sdf", "nobody.sdf", 2),
    "missing motion": ("squat.yaml", "handstand.yaml", 3),
    "unknown joint": ("duration_s: 1", "duration_s: 1\nfaults: [{at_s: 0, kind: drive_silent, target: tail}]", 5),
    "unknown link": ("duration_s: 1", "duration_s: 1\npushes: [{at_s: 0, duration_s: 1, link: tail, force_N: [1, 0, 0]}]", 5),
    "friction out of range": ("duration_s: 1", "duration_s: 1\nground: {friction: [0.5, 11]}", 5),
    "unknown shape": ("duration_s: 1", "duration_s: 1\nground: {shapes: [{cone: {position_m: [0, 0]}}]}", 5),
    "unknown material": ("duration_s: 1", "duration_s: 1\nmaterials: [{between: [rubber, cheese], friction: 0.1}]", 5),
    "misspelt command": ("duration_s: 1", "duration_s: 1\ncommands: [{at_s: 0, wlak: {}}]", 5),
    "unknown streamed joint": ("duration_s: 1", "duration_s: 1\ncommands: [{at_s: 0, stream: {joints_deg: {nose: 1}}}]", 5),
    "streamed angle": ("duration_s: 1", "duration_s: 1\ncommands: [{at_s: 0, stream: {joints_deg: {head_pan: 180}}}]", 5),
    "misspelt key of a stream": ("duration_s: 1", "duration_s: 1\ncommands: [{at_s: 0, stream: {joints: {head_pan: 1}}}]", 5),
    "parameter without its unit": ("duration_s: 1", "duration_s: 1\nparameters: {com_height: 167.5}", 5),
    "start beyond a limit": ("duration_s: 1", "duration_s: 1\ninitial: {joints_deg: {left_knee: -20}}", 5),
}

BAD_MOTIONS = {
    "unknown joint": ("knee: 43.72", "tail: 43.72"),
    "beyond a limit": ("knee: 43.72", "knee: 163"),
    "unknown pose": ("{pose: down_1,", "{pose: nowhere,"),
    "loop without time": ("{wait_s: 0.5}", "{loop: {times: 2, steps: []}}"),
    "other robot": ("robot: koboshi", "robot: somebody"),
    "unknown key": ("name: squat", "name: squat\nmood: good"),
}

BAD_ROBOTS = {
    "heavy trunk": (r"<mass>[^<]*</mass>", "<mass>360</mass>"),
    "negative mass": (r"<mass>[^<]*</mass>", "<mass>-1</mass>"),
    "not a number": (r"<lower>[^<]*</lower>", "<lower>left</lower>"),
    "unknown element": (r"<gravity>[^<]*</gravity>|</model>", "<flying>true</flying></model>"),
    "malformed": (r"</sdf>", ""),
    "backlash of a turn": (r"</koboshi:servo_type>", "<backlash_rad>6.28</backlash_rad></koboshi:servo_type>"),
    "missing servo library": (r"<link ", '<koboshi:servo_types file="nobody.xml"/><link '),
    "battery without voltage": (r"<link ", '<koboshi:battery internal_resistance_ohm="0.1"/><link '),
}


class BadInput(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_bad_input_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, text):
        file = self.folder / name
        file.write_text(text)
        return file

    def refuse(self, file, line, *arguments, caret=False):
        before = sorted(self.folder.rglob("*"))
        result = PROGRAM.run(*arguments, cwd=self.folder)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        where = re.escape(str(file)) + (f":{line}" if line else r"(:\d+)?")
        if caret:  # as a compiler: place with column and code, the line, a caret, and perhaps a hint
            self.assertRegex(lines[0], rf"^{where}:\d+: error\[M\d{{3}}\]: found .+, expected .+$")
            self.assertRegex(lines[1], r"^ *\d+ \| ")
            self.assertRegex(lines[2], r"^ *\| +\^~*$")
            self.assertLessEqual(len(lines), 4, result.stderr)
        else:
            self.assertRegex(lines[0], f"^{where}: found .+, expected .+$")
            self.assertEqual(len(lines), 1, result.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before, "something was written")

    def test_more_motions_than_the_controller_knows(self):
        motions = [self.write(f"squat_{number}.yaml", MOTION.read_text()) for number in range(201)]
        scenario = self.write("scenario.yaml", SCENARIO.replace(str(MOTION), ", ".join(map(str, motions))))
        self.refuse(scenario, None, "run", scenario, "--out", self.folder / "out")

    def test_scenarios(self):
        for name, (old, new, line) in BAD_SCENARIOS.items():
            with self.subTest(name):
                self.assertIn(old, SCENARIO)
                file = self.write("scenario.yaml", SCENARIO.replace(old, new))
                self.refuse(file, line, "run", file, "--out", self.folder / "out")

    def test_motions(self):
        for name, (old, new) in BAD_MOTIONS.items():
            with self.subTest(name):
                text = MOTION.read_text()
                self.assertIn(old, text)
                file = self.write("motion.yaml", text.replace(old, new, 1))
                out = self.folder / "motion.kmot"
                self.refuse(file, None, "motion", "compile", file, "--robot", ROBOT / "robot.sdf", "-o", out,
                            caret=True)

    def test_robots(self):
        for name, (pattern, new) in BAD_ROBOTS.items():
            with self.subTest(name):
                text, count = re.subn(pattern, new, (ROBOT / "robot.sdf").read_text(), count=1)
                self.assertEqual(count, 1)
                robot = self.write("robot.sdf", text.replace("meshes/", str(ROBOT / "meshes") + "/"))
                scenario = self.write("scenario.yaml", SCENARIO.replace(str(ROBOT / "robot.sdf"), str(robot)))
                self.refuse(robot, None, "run", scenario, "--out", self.folder / "out")

    def test_missing_files(self):
        self.refuse("nothing.yaml", None, "run", "nothing.yaml")
        self.refuse("nothing.yaml", None, "motion", "compile", "nothing.yaml", "--robot", ROBOT / "robot.sdf")

    def test_overrides(self):
        file = self.write("scenario.yaml", SCENARIO)
        for bad in ("ground.mux=1", "duration_s=-1", "duration_s", "physics.step_ms=0.3"):
            with self.subTest(bad):
                self.refuse("--set", None, "run", file, "--set", bad)

    def test_units(self):
        file = self.write("scenario.yaml", SCENARIO)
        self.refuse("--set", None, "run", file, "--set", "duration_s=5kg")
        for text, accepted in (("500ms", True), ("1 min", True), ("0.2", True), ("5 kg", False), ("5 lb", False)):
            result = PROGRAM.run("can", "scan", "--can", "socketcan:none", "--duration", text)
            self.assertEqual("expected a number with the unit s, ms, us, min or h" in result.stderr, not accepted, result.stderr)
            self.assertNotEqual(result.returncode, 0)
        result = PROGRAM.run("model", "set", ROBOT / "robot.sdf", "left_shank.mass=45lb", "--dry-run")
        self.assertRegex(result.stderr, r"^\S+: found left_shank.mass = 45lb, expected a number .*; the unit kg or g\n$")

    def test_arguments_are_checked_before_a_bus_is_opened(self):
        for arguments in (["sdo", "read", "200", "1000"], ["sdo", "read", "0", "1000"], ["sdo", "read", "5", "zz"],
                          ["sdo", "write", "5", "1017", "abc"], ["sdo", "write", "5", "1017", "300", "--type", "u8"],
                          ["sdo", "upload", "5", "10:100", "file"], ["sdo", "download", "500", "1000", "file"],
                          ["lss", "inquire", "--node", "500"], ["lss", "inquire", "--address", "1:2"],
                          ["lss", "set-node", "300"], ["lss", "find", "--assign", "0"], ["lss", "bit-rate", "1"],
                          ["nmt", "start", "alle"], ["nmt", "start", "0"], ["dump", "--node", "128"],
                          ["dcf", "0", "nothing.eds"], ["dcf", "5", "nothing.eds"], ["send", "12"]):
            with self.subTest(arguments):
                result = PROGRAM.run("can", *arguments, "--can", "socketcan:none0", cwd=self.folder)
                self.assertEqual(result.returncode, 2)
                self.assertIn("found ", result.stderr)
                self.assertNotIn("none0", result.stderr)

    def test_a_folder_is_no_file_to_download(self):
        folder = self.folder / "images"
        folder.mkdir()
        for name, found in ((folder, "a folder"), (self.folder / "none", "no such file")):
            result = PROGRAM.run("can", "sdo", "download", "16", "1017", name, "--can", "socketcan:none0")
            self.assertEqual((result.returncode, result.stderr), (2, f"{name}: found {found}, expected a file to download\n"))

    def test_what_nobody_sees_is_shown(self):
        for arguments in (["run", "a\u202eb.yaml"], ["can", "send", "12\u200b3"], ["can", "dump", "x", "--no\u2066pe"],
                          ["can", "sdo", "read", "1", "10\u00a018"], ["da\u202ance"]):
            with self.subTest(arguments):
                result = PROGRAM.run(*arguments, cwd=self.folder)
                self.assertEqual(result.returncode, 2)
                self.assertTrue(result.stderr.isascii(), result.stderr)
                self.assertRegex(result.stderr, r"\\u20|\\u00A0")
        motion = self.write("motion.yaml", MOTION.read_text().replace("version: 1", "version: 1 # \u202e\nnobody: 1", 1))
        result = PROGRAM.run("motion", "compile", motion, "--robot", ROBOT / "robot.sdf", "-o", self.folder / "a.kmot")
        self.assertEqual(result.returncode, 2)
        self.assertTrue(result.stderr.isascii(), result.stderr)

    def test_options_name_themselves(self):
        file = self.write("scenario.yaml", SCENARIO)
        self.refuse("--seed", None, "run", file, "--seed", "abc")
        self.refuse("--duration", None, "run", file, "--duration", "-1")
        self.refuse("--image", None, "run", file, "--image", "image.elf")

    def test_render(self):
        film = self.folder / "film.mp4"
        self.refuse("nothing", None, "render", "nothing", "--out", film)
        self.refuse("--size", None, "render", self.folder, "--out", film, "--size", "1280")
        self.refuse("--size", None, "render", self.folder, "--out", film, "--size", "9999x10")
        for arguments in (["--view", "behind"], ["--camera", "shaky"], ["--overlay", "zmp,soul"], ["--target", "1,2"],
                          ["--fps", "0"], ["--at", "1", "--frames", "3"]):
            with self.subTest(arguments):
                self.assertEqual(PROGRAM.run("render", self.folder, "--out", film, *arguments).returncode, 2)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_folder_that_is_not_ours_is_left_alone(self):
        file = self.write("scenario.yaml", SCENARIO)
        self.write("letter.txt", "dear reader")
        self.refuse(self.folder, None, "run", file, "--out", self.folder)

    def test_experiments(self):
        letter = self.write("letter.txt", "dear reader")
        walk = support.ROOT / "scenarios" / "walk.yaml"
        command = ["experiment", "gyro-feedback", walk, "--seeds", "1"]
        self.refuse(self.folder, None, *command, "--out", self.folder)
        self.refuse(letter, None, *command, "--out", letter)
        missing = self.folder / "missing" / "result.json"
        self.refuse(missing, None, *command, "--out", self.folder / "out", "--json", missing)
        self.refuse("nothing.yaml", None, "experiment", "gyro-feedback", "nothing.yaml")
        squat = ["experiment", "gyro-feedback", support.SQUAT, "--out", self.folder / "out"]
        self.refuse("--set", None, *squat)
        for name in ("walking-speed", "push-recovery", "terrain"):
            self.refuse(support.SQUAT, None, "experiment", name, support.SQUAT, "--out", self.folder / "out")

    def test_the_laboratory_checks_its_inputs_before_it_writes(self):
        out = self.folder / "out"
        missing = self.folder / "missing" / "result"
        stand_up = ["experiment", "stand-up", "--seeds", "1", "--out", out]
        for option in ("--json", "--page"):
            self.refuse(missing, None, *stand_up, option, missing, "--shards", "plan", "--shard", "1/2")
        self.refuse(self.folder, None, *stand_up, "--json", self.folder)
        letter = self.write("letter.txt", "dear reader")
        self.refuse(letter, None, *stand_up, "--record-lost", letter)
        gait = ["experiment", "tune-gait", "--seeds", "1", "--evaluations", "24", "--out", out]
        self.refuse(missing, None, *gait, "--gait", missing)
        self.refuse(missing, None, *gait, "--start", missing)
        bare = self.write("gait.yaml", "version: 1\n")
        self.refuse(bare, None, *gait, "--start", bare)
        self.refuse(missing, None, "validate", "--short", "--json", missing, "--out", out)
        study = self.write("study.yaml", (support.ROOT / "studies" / "stand.yaml").read_text().replace(
            "../scenarios/", f"{support.ROOT}/scenarios/"))
        wrong = study.read_text().replace("numbers:\n", "numbers:\n  parameters.no_such_gain: {range: [0, 1], start: 0.5}\n")
        self.assertNotEqual(wrong, study.read_text())
        study.write_text(wrong)
        self.refuse(study, None, "tune", study, "--evaluations", "16", "--seeds", "1", "--out", out)
        learning = support.ROOT / "studies" / "learn" / "residual.yaml"
        wrong = self.write("learn.yaml", re.sub("(?m)^scenario:.*$", "scenario: nosuch", learning.read_text()))
        self.refuse(wrong, None, "learn", wrong, "--out", out)
        for command in (stand_up, gait, ["bring-up", ROBOT], ["tune", study]):
            result = PROGRAM.run(*command, "--first-seed", 2**64 - 1, cwd=self.folder)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("--first-seed", result.stderr)
        for scheduler, program in ((["--slurm"], "sbatch"), (["--parallel", "2/localhost"], "parallel")):
            submitted = subprocess.run([PROGRAM.path, "lab", "submit", *scheduler, "--shards", "2", "--out", out, "experiment", "stand-up"],
                                       env={"PATH": "/nonexistent"}, capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(submitted.returncode, 2, submitted.stderr)
            self.assertIn(program, submitted.stderr)
        self.assertFalse(out.exists())

    def test_no_command_replaces_what_it_reads(self):
        log = self.write("can.asc", "(0.000000) vcan0 123#00\n")
        robot = shutil.copy(ROBOT / "robot.sdf", self.folder / "robot.sdf")
        gait = shutil.copy(ROBOT / "gait.yaml", self.folder / "walk.yaml")
        motion = shutil.copy(MOTION, self.folder / "squat.yaml")
        before = {path: path.read_bytes() for path in self.folder.iterdir()}
        for arguments in (["can", "export", log, "--out", log], ["gait", gait],
                          ["model", "export", robot, "--urdf", robot],
                          ["motion", "retarget", motion, "--from", ROBOT, "--to", ROBOT, "-o", motion]):
            with self.subTest(arguments):
                result = PROGRAM.run(*arguments, cwd=self.folder)
                self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
                self.assertIn("found the input as the output", result.stderr)
                self.assertEqual({path: path.read_bytes() for path in self.folder.iterdir()}, before)

    def test_unknown_options_and_commands(self):
        gyro_feedback = ["experiment", "gyro-feedback"]
        for arguments in (["dance"], ["run"], ["run", str(support.SQUAT), "--louder"], ["experiment"],
                          [*gyro_feedback, "--seeds", "0"], [*gyro_feedback, "--points", "8,many"],
                          [*gyro_feedback, "--feedback", "maybe"], [*gyro_feedback, "--section", "level"],
                          ["experiment", "tune-gait", "--evaluations", "1"]):
            with self.subTest(arguments):
                self.assertEqual(PROGRAM.run(*arguments).returncode, 2)


    def test_misspelt_commands_get_the_nearest(self):
        for arguments, nearest in ((["rnu"], "run"), (["can", "dmup"], "dump"), (["experiment", "terain"], "terrain")):
            result = PROGRAM.run(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertRegex(result.stderr, f"^koboshi.*: found the unknown command {arguments[-1]}, expected .*; the nearest is {nearest}\n$")
        self.assertRegex(PROGRAM.run("nonsense").stderr, "^koboshi: found the unknown command nonsense, expected run, .*\n$")

    def test_options_without_effect_are_refused(self):
        for arguments in (["run", support.SQUAT, "--speed", "2"], ["board", "--speed", "2"],
                          ["run", support.SQUAT, "--image", "image.elf"], ["bench", "--json"],
                          ["can", "dump", "runs/walk", "--can", "udp:239.74.163.2:43113"],
                          ["can", "stats", "runs/walk", "--duration", "3"],
                          ["experiment", "gyro-feedback", "--push", "1"]):
            with self.subTest(arguments):
                result = PROGRAM.run(*arguments)
                self.assertEqual((result.returncode, result.stdout), (2, ""))


class MotionFiles(unittest.TestCase):
    """Commands that edit motion files leave all files as they are if they refuse the input."""

    BAD_MOTIONS = {
        "not UTF-8": 'version: 2\nrobot: koboshi\nname: "M\xfcller"\nsteps: [end]\n'.encode("latin-1"),
        "UTF-16": "version: 2\nrobot: koboshi\nname: a\nsteps: [end]\n".encode("utf-16"),
        "other version": b"version: 3\nrobot: koboshi\nname: a\nsteps: [end]\n",
        "tab": b"version: 2\nrobot: koboshi\nname: a\nsteps:\n\t- end\n",
        "doubled key": b"version: 2\nrobot: koboshi\nname: a\nsteps: [end]\nsteps: [end]\n",
        "alias": b"version: 2\nrobot: koboshi\nname: a\nsteps: [&a {wait_s: 1}, *a]\n",
        "deep": b"version: 2\nrobot: koboshi\nname: a\nsteps: " + b"[" * 20000 + b"]" * 20000 + b"\n",
        "large": b"version: 2\nrobot: koboshi\nname: a\nsteps:\n" + b"  - {wait_s: 1}\n" * 100000,
        "empty": b"",
    }

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refuse(self, *arguments):
        before = {file: file.read_bytes() for file in self.folder.iterdir()}
        result = PROGRAM.run("motion", *arguments)
        self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
        self.assertRegex(result.stderr, "^[^\n]*: .*found .*, expected .*\n")
        for line in result.stderr.splitlines()[1:]:
            self.assertRegex(line, "^ *([0-9]* [|]|=) ?")  # the place in the file, and a hint
        self.assertEqual({file: file.read_bytes() for file in self.folder.iterdir()}, before)

    def test_bad_files_are_refused_by_every_command(self):
        file = self.folder / "motion.yaml"
        for name, content in self.BAD_MOTIONS.items():
            file.write_bytes(content)
            for arguments in (["format", file], ["mirror", file, "-o", file],
                              ["compile", file, "-o", self.folder / "motion.kmot"],
                              ["play", file, "--out", self.folder / "run"], ["upload", file]):
                with self.subTest(f"{name}: {arguments[0]}"):
                    self.refuse(*arguments)

    TOO_FAR = "version: 2\nrobot: koboshi\nname: bow\nsteps:\n  - {pose: {knee: 400}, time_s: 1}\n"

    def test_a_motion_that_does_not_compile_is_neither_played_nor_sent(self):
        file = self.folder / "motion.yaml"
        file.write_text(self.TOO_FAR, encoding="utf-8")
        self.refuse("play", file, "--out", self.folder / "run")
        self.refuse("upload", file)

    def test_the_bus_stays_silent_when_an_upload_is_refused(self):
        file = self.folder / "motion.yaml"
        with BusListener() as bus:
            file.write_text(self.TOO_FAR, encoding="utf-8")
            self.refuse("upload", file, "--can", bus.name)
            self.assertEqual(bus.datagrams(), 0)
            # A good motion is sent, although nobody answers: the listener hears.
            result = PROGRAM.run("motion", "upload", MOTION, "--can", bus.name)
            self.assertIn("no SDO answer", result.stderr)
            self.assertGreater(bus.datagrams(), 0)

    def test_a_scenario_is_not_formatted(self):
        file = self.folder / "scenario.yaml"
        file.write_text(SCENARIO, encoding="utf-8")
        self.refuse("format", file)

    def test_a_source_is_not_replaced_by_its_image(self):
        file = self.folder / "motion.yaml"
        file.write_bytes(MOTION.read_bytes())
        self.refuse("compile", file, "-o", file)
        image = self.folder / "motion.kmot"
        self.assertEqual(PROGRAM.run("motion", "compile", file, "-o", image).returncode, 0)
        self.refuse("decompile", image, "-o", image)

    def test_a_name_over_two_lines_is_refused(self):
        self.refuse("mirror", MOTION, "--name", "two\nlines", "-o", self.folder / "mirrored.yaml")

    def test_a_folder_is_no_image(self):
        folder = self.folder / "motion.kmot"
        folder.mkdir()
        result = PROGRAM.run("motion", "upload", folder)
        self.assertEqual((result.returncode, result.stderr), (2, f"{folder}: found a folder, expected the image of a motion\n"))


class StandardStreams(unittest.TestCase):
    """Standard streams that are closed or full change no exit status but that of what is printed."""

    BAD = (["run", "nosuch.yaml"], ["replay", "nosuch"], ["render", "nosuch", "--out", "film.mp4"], ["can", "dump", "nosuch.log"],
           ["board", "nosuch.yaml"], ["diff", "nosuch", "nosuch"], ["model", "check", "nosuch.sdf"],
           ["model", "set", "nosuch.sdf", "a.b=1"], ["model", "get", "nosuch.sdf"], ["motion", "format", "nosuch.yaml"],
           ["motion", "check", "nosuch.yaml"], ["motion", "play", "nosuch.yaml"], ["gait", "nosuch.yaml"],
           ["experiment", "gyro-feedback", "nosuch.yaml"], ["servo", "--robot", "nosuch.sdf"], ["dance"], ["run", "--louder"])

    def status(self, redirection, *arguments):
        command = ["sh", "-c", f'exec "$@" {redirection}', "sh", PROGRAM.path, *arguments]
        with tempfile.TemporaryDirectory() as folder:
            result = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=600, check=False)
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [], "something was written")
        return result.returncode

    def test_bad_input_is_2_although_nobody_hears_it(self):
        for arguments in self.BAD:
            for redirection in ("2>&-", "2>/dev/full", ">&- 2>&- <&-"):
                with self.subTest(arguments, redirection=redirection):
                    self.assertEqual(self.status(redirection, *arguments), 2)

    def test_printing_nothing_is_an_error(self):
        robot = str(ROBOT / "robot.sdf")
        for arguments in (["--version"], ["--help"], ["model", "get", robot], ["model", "check", robot], ["motion", "list"]):
            for redirection in (">&-", ">/dev/full", ">&- 2>&-", ">/dev/full 2>/dev/full"):
                with self.subTest(arguments, redirection=redirection):
                    self.assertEqual(self.status(redirection, *arguments), 2)

    def test_a_closed_stream_is_not_taken_by_a_file(self):
        for redirection in ("2>&-", ">&- 2>&-"):
            with tempfile.TemporaryDirectory() as folder:
                out = pathlib.Path(folder, "run")
                command = ["sh", "-c", f'exec "$@" {redirection}', "sh", PROGRAM.path, "run", str(support.SQUAT), "--duration",
                           "0.1", "--out", out]
                subprocess.run(command, cwd=support.ROOT, check=False, capture_output=True)
                for line in (out / "can.log").read_text().splitlines():
                    self.assertRegex(line, r"^\([0-9.]+\) ")


class Door(unittest.TestCase):
    """Every text is checked once where it enters."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_door_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "meshes").symlink_to(ROBOT / "meshes")
        self.robot = self.folder / "robot.sdf"
        self.scenario = self.folder / "scenario.yaml"
        self.scenario.write_text(SCENARIO.replace(str(ROBOT / "robot.sdf"), str(self.robot)), encoding="utf-8")

    def refuse(self, where, *arguments):
        result = subprocess.run([PROGRAM.path, *arguments], cwd=self.folder, capture_output=True, timeout=600, check=False)
        self.assertEqual(result.returncode, 2, result.stderr)
        text = result.stderr.decode("utf-8")  # raises for other bytes
        self.assertRegex(text, rf"\A{where}: found [^\n]+, expected [^\n]+\n\Z")
        self.assertNotIn("\x1b", text)
        return text

    def check(self):
        return subprocess.run([PROGRAM.path, "model", "check", self.robot], capture_output=True, timeout=600, check=False)

    def test_bytes_that_are_not_utf_8(self):
        good = (ROBOT / "robot.sdf").read_bytes()
        self.robot.write_bytes(good.replace(b'name="koboshi"', b'name="k\xf6boshi"', 1))
        self.refuse(rf"{self.robot}:\d+", "run", self.scenario, "--out", self.folder / "out")
        self.assertFalse((self.folder / "out").exists())
        checked = self.check()
        self.assertEqual(checked.returncode, 1)
        self.assertRegex(checked.stdout.decode("utf-8"), r"robot.sdf:\d+: error\[R001\]: found a byte that is not UTF-8")
        self.robot.write_bytes(good.replace(b'name="koboshi"', b'name="k&#xD800;boshi"', 1))
        self.refuse(rf"{self.robot}:\d+", "run", self.scenario, "--out", self.folder / "out")
        self.scenario.write_bytes(SCENARIO.encode() + b"# f\xfcr\n")
        self.refuse(rf"{self.scenario}:5", "run", self.scenario)
        for arguments in ([b"run", b"sc\xe9nario.yaml"], [b"d\xe4nce"], [b"run", bytes(support.SQUAT), b"--out", b"\xff"],
                          [b"run", bytes(support.SQUAT), b"--set", b"ground.material=\xff"]):
            with self.subTest(arguments):
                self.refuse("koboshi", *arguments)

    def test_a_long_message_ends_between_characters(self):
        self.scenario.write_text(SCENARIO.replace("robot.sdf", "x" + "\u00e4\u6f22\U0001f916" * 40), encoding="utf-8")
        self.refuse(rf"{self.scenario}:2", "run", self.scenario)

    def test_names_at_whose_edge_is_white_space(self):
        good = (ROBOT / "robot.sdf").read_text(encoding="utf-8")
        for name in ("head_pan ", " head_pan", "head_pan\t", "head_pan\u00a0", "head&#10;pan", "", "head_pan::", "__head__"):
            with self.subTest(name):
                self.robot.write_text(good.replace('<joint name="head_pan"', f'<joint name="{name}"', 1), encoding="utf-8")
                self.refuse(rf"{self.robot}:\d+", "run", self.scenario, "--out", self.folder / "out")
                self.assertEqual(self.check().returncode, 1)
        self.assertIn(b"  = Write head_pan.", self.check_of(good, "head_pan "))

    def check_of(self, good, name):
        self.robot.write_text(good.replace('<joint name="head_pan"', f'<joint name="{name}"', 1), encoding="utf-8")
        return self.check().stdout

    def test_empty_files_have_a_line(self):
        for text in ("", "\n\n", "# only a comment\n"):
            with self.subTest(text):
                self.scenario.write_text(text, encoding="utf-8")
                self.refuse(rf"{self.scenario}:1", "run", self.scenario)
                self.robot.write_text(text, encoding="utf-8")
                self.refuse(rf"{self.robot}:\d+", "dictionary", "--robot", self.robot, "write")

    def test_nesting_has_a_limit_that_is_told(self):
        for text in ("version: 1\nrobot: " + "[" * 600 + "]" * 600, "version: 1\nrobot: " + "{a: " * 600 + "1" + "}" * 600):
            self.scenario.write_text(text, encoding="utf-8")
            self.assertIn("nested deeper than 100 levels, expected at most 100 levels",
                          self.refuse(rf"{self.scenario}:2", "run", self.scenario))
        self.robot.write_text("<sdf>" * 600 + "</sdf>" * 600, encoding="utf-8")
        self.scenario.write_text(SCENARIO.replace(str(ROBOT / "robot.sdf"), str(self.robot)), encoding="utf-8")
        self.assertIn("nested deeper than 90 levels", self.refuse(rf"{self.robot}:1", "run", self.scenario))
        self.assertIn("nested deeper than 100 levels",
                      self.refuse("--set", "run", support.SQUAT, "--set", "faults=" + "[" * 600 + "]" * 600))

    # Changes that the run refuses, with the line of the check.
    REFUSED = {
        "delays of the channels": (r"(<koboshi:torque>.*?<delay_s>)[^<]*", r"\g<1>0.003"),
        "no inertial unit": (r'<sensor name="imu" type="imu">.*?</sensor>', ""),
        "resolutions of the ankles": (r'(name="right_ankle" type=.*?<koboshi:force>.*?<resolution>)[^<]*', r"\g<1>0.02"),
        "turned ankle sensor": (r'(<sensor name="right_ankle"[^>]*>\s*<pose>[^<]*) 0</pose>', r"\g<1> 0.5</pose>"),
        "role of a joint": (r'name="left_ankle_roll"', 'name="left_ankle_rol"'),
        "heavy link": (r'(<link name="trunk">.*?<mass>)[^<]*', r"\g<1>5.5"),
        "mirrored axis": (r'(<joint name="left_knee".*?<xyz[^>]*>)[^<]*', r"\g<1>0.6 0.8 0"),
        "long name": (r'<model name="koboshi"', '<model name="' + "k" * 40 + '"'),
        "name of another": (r'<model name="koboshi"', '<model name="okina"'),
    }

    def test_the_check_finds_what_the_run_refuses(self):
        good = (ROBOT / "robot.sdf").read_text(encoding="utf-8")
        shutil.copy(ROBOT / "parameters.yaml", self.folder)
        for name, (pattern, new) in self.REFUSED.items():
            with self.subTest(name):
                text, count = re.subn(pattern, new, good, count=1, flags=re.DOTALL)
                self.assertEqual(count, 1)
                self.robot.write_text(text, encoding="utf-8")
                self.refuse(rf"{self.folder}/[a-z.]+:\d+", "run", self.scenario, "--out", self.folder / "out")
                checked = self.check()
                self.assertEqual(checked.returncode, 1, checked.stdout)
                self.assertRegex(checked.stdout.decode(), r"\w:\d+: error\[R0(25|28|29)\]: ")

    def test_a_mesh_that_is_no_number_is_reported_and_not_exported(self):
        (self.folder / "meshes").unlink()
        shutil.copytree(ROBOT / "meshes", self.folder / "meshes")
        mesh = self.folder / "meshes" / "chest_cover.stl"
        content = bytearray(mesh.read_bytes())
        content[96:100] = struct.pack("<f", float("nan"))
        mesh.write_bytes(content)
        self.robot.write_text((ROBOT / "robot.sdf").read_text())
        self.assertRegex(self.check().stdout, rb"error\[R010\]: found chest_cover.stl, which cannot be shown: a vertex that is no")
        result = PROGRAM.run("run", self.scenario, "--duration", "0.1", "--out", self.folder / "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        warning = "koboshi: warning: The mesh chest_cover.stl of trunk cannot be shown: a vertex that is no finite number."
        self.assertIn(warning, result.stderr)
        glb = self.folder / "run.glb"
        result = PROGRAM.run("replay", self.folder / "out", "--gltf", glb)
        self.assertEqual(result.returncode, 0)
        self.assertIn(warning, result.stderr)
        self.assertNotIn(b"NaN", glb.read_bytes())
        self.assertNotIn(b"null", glb.read_bytes())


class BusListener:
    """Hears what is sent on a bus of its own (udp:GROUP:PORT)."""

    GROUP = "239.74.163.98"

    def __enter__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(("", 0))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               socket.inet_aton(self.GROUP) + socket.inet_aton("0.0.0.0"))
        self.socket.setblocking(False)
        self.name = f"udp:{self.GROUP}:{self.socket.getsockname()[1]}"
        return self

    def __exit__(self, *_):
        self.socket.close()

    def datagrams(self):
        count = 0
        try:
            while self.socket.recv(65536):
                count += 1
        except BlockingIOError:
            return count


class Help(unittest.TestCase):
    def test_help_teaches_and_version_tells(self):
        self.assertRegex(PROGRAM.run("--version").stdout, r"^koboshi \d+\.\d+\.\d+\n$")
        self.assertIn("koboshi run scenarios/walk.yaml", PROGRAM.run("--help").stdout)
        for command in (["run"], ["motion"], ["motion", "compile"]):
            result = PROGRAM.run(*command, "--help")
            self.assertEqual(result.returncode, 0, command)
            self.assertIn("koboshi", result.stdout)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
