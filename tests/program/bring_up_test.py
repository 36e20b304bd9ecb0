"""koboshi bring-up: a robot that nobody has tuned stands, squats and walks, and the files say how."""

import json
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

import program as support
import robot_sizes_test as sizes

PROGRAM = None
SOFTER = 7.0  # full-voltage error with which the robot steps on the spot, and makes good nearly nothing of a walk


RUNGS = ("loads", "hangs", "stands", "shifts its weight", "squats", "steps on the spot", "walks forward")


def contents(folder):
    """Returns the bytes of each file that bring-up has written, by its path."""
    return {file.relative_to(folder): file.read_bytes() for file in sorted(folder.rglob("*"))
            if file.is_file() and file.suffix in (".yaml", ".md", ".json", ".csv")}


class BringUp(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_bring_up_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.robot = self.make("kit")

    def make(self, name):
        robot = self.folder / name
        robot.mkdir()
        by = sizes.Scale(0.55, 3.2)
        (robot / "robot.sdf").write_text(sizes.scaled_robot((sizes.ROBOT / "robot.sdf").read_text(), by))
        shutil.copytree(sizes.ROBOT / "meshes", robot / "meshes")
        return robot

    def change(self, robot, name, factor, scaled=sizes.scaled_elements):
        file = robot / "robot.sdf"
        text = file.read_text()
        changed = scaled(text, name, factor)
        self.assertNotEqual(changed, text)
        file.write_text(changed)

    def climb(self, *arguments, robot=None):
        candidates = () if "--candidates" in arguments else ("--candidates", 0)
        return PROGRAM.run("bring-up", robot or self.robot, "--seeds", 1, *candidates, *arguments)

    def test_leads_from_a_model_to_a_robot_that_walks(self):
        result = self.climb("--until", "walks forward")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        for rung in RUNGS:
            self.assertRegex(result.stdout, rf"(?m)^{rung} +yes ")
        self.assertRegex(result.stdout, r"(?m)^squats .* at most [0-9]+ % of its stall torque, RMS [0-9]+ % ")
        self.assertRegex(result.stdout, r"(?m)^shifts its weight .* CoM at least [0-9.]+ mm and ZMP [0-9.]+ mm inside of the sole")
        self.assertIn("| walks forward | yes | 1 of 1 robots told ", (self.robot / "bring-up.md").read_text())
        with self.subTest("its files play"):
            played = PROGRAM.run("run", self.robot / "go.yaml", "--stepper", "lumped", "--record", "no", "--duration", 9,
                                 "--out", self.folder / "run")
            self.assertEqual(played.returncode, 0, played.stdout + played.stderr)
            self.assertIn("walks; did not fall; 0 faults", played.stdout)
            for motion in ("squat", "shift"):
                checked = PROGRAM.run("motion", "check", self.robot / f"motions/{motion}.yaml", "--robot", self.robot)
                self.assertEqual(checked.returncode, 0, checked.stdout)
        before = contents(self.robot)
        with self.subTest("a second call plays nothing again"):
            again = self.climb("--until", "walks forward")
            self.assertEqual(again.stdout, result.stdout)
            self.assertEqual(again.stderr.count("as before"), len(RUNGS))
            self.assertEqual(contents(self.robot), before)
        with self.subTest("a changed file is not overwritten"):
            own = self.robot / "parameters.yaml"
            own.write_text(own.read_text().replace("step_time_ms: ", "step_time_ms: 1"))
            changed = contents(self.robot)
            refused = self.climb("--until", "walks forward")
            self.assertEqual(refused.returncode, 2, refused.stdout)
            self.assertRegex(refused.stderr, r"parameters\.yaml: found changes since bring-up has written it, expected none \(to write it again: --restart\)")
            self.assertEqual(contents(self.robot), changed)
        with self.subTest("--restart begins anew"):
            anew = self.climb("--restart", "--until", "hangs")
            self.assertEqual(anew.returncode, 0, anew.stderr)
            self.assertNotIn("as before", anew.stderr)
            self.assertEqual((self.robot / "parameters.yaml").read_bytes(), before[pathlib.Path("parameters.yaml")])
            self.assertIn("parameters.yaml: may have been changed since bring-up has written it; kept as parameters.yaml.bak",
                          anew.stderr)
            self.assertEqual((self.robot / "parameters.yaml.bak").read_bytes(), changed[pathlib.Path("parameters.yaml")])
        with self.subTest("without the journal nobody knows which file was changed"):
            (self.robot / "bring-up.json").unlink()
            own.write_text(own.read_text() + "# mine\n")
            unknown = self.climb("--until", "hangs")
            self.assertEqual(unknown.returncode, 0, unknown.stderr)
            self.assertTrue((self.robot / "parameters.yaml.bak2").read_text().endswith("# mine\n"))
        with self.subTest("a misspelt world changes nothing"):
            untouched = contents(self.robot)
            misspelt = self.climb("--until", "hangs", "--world", "mlid")
            self.assertEqual(misspelt.returncode, 2, misspelt.stdout)
            self.assertEqual(contents(self.robot), untouched)
        with self.subTest("another model invalidates all rungs"):
            self.change(self.robot, "mass", 1.02)
            other = self.climb("--until", "hangs")
            self.assertEqual(other.returncode, 0, other.stderr)
            self.assertNotIn("as before", other.stderr)

    def test_continues_where_it_was_interrupted(self):
        self.assertEqual(self.climb("--until", "hangs").returncode, 0)
        before = contents(self.robot)
        command = [PROGRAM.path, "bring-up", self.robot, "--seeds", "1", "--candidates", "0", "--until", "stands"]
        with subprocess.Popen(command, cwd=support.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as climbing:
            for line in climbing.stderr:
                if line.endswith("3 of 12, stands\n"):
                    break
            climbing.send_signal(signal.SIGINT)
            rest = climbing.stderr.read()
        self.assertNotEqual(climbing.returncode, 0)
        self.assertIn("interrupted at 3 of 12, stands", rest)
        self.assertEqual(contents(self.robot), before)
        continued = self.climb("--until", "stands")
        self.assertEqual(continued.returncode, 0, continued.stderr)
        self.assertEqual(continued.stderr.count("as before"), 2)

    def test_a_rung_that_fails_ends_the_ladder_for_no_rung_that_does_not_need_it(self):
        """Windings that bear nearly nothing fail the squats alone; the motions of an earlier call are kept."""
        self.change(self.robot, "thermal_resistance_K_per_W", 100.0, sizes.scaled_attribute)
        first = self.climb("--until", "gets up from the front")
        self.assertEqual(first.returncode, 1, first.stdout + first.stderr)
        self.assertRegex(first.stdout, r"(?m)^squats +NO +\w+ needs [0-9]+ % of its stall torque in the mean ")
        for rung in ("shifts its weight", "steps on the spot", "walks forward", "falls protected", "gets up from the front"):
            self.assertRegex(first.stdout, rf"(?m)^{rung} +yes ")
        self.assertRegex(first.stdout, r"(?m)^gets up from the back +- +after the last rung to try$")
        page = (self.robot / "bring-up.md").read_text()
        self.assertRegex(page, r"(?m)^\| squats \| NO \| \w+ needs [0-9]+ % ")
        self.assertIn("| gets up from the back | - | after the last rung to try |", page)
        self.assertIn("fall_front", (self.robot / "go.yaml").read_text())
        before = contents(self.robot)
        again = self.climb("--until", "gets up from the front")
        self.assertEqual(again.stdout, first.stdout)
        self.assertEqual(again.returncode, 1, again.stderr)
        self.assertEqual(contents(self.robot), before)
        self.assertNotIn("squats: as before", again.stderr)
        self.assertIn("steps on the spot: as before", again.stderr)
        with self.subTest("a motion of the user's own is played, and only the rungs that play it"):
            own = self.robot / "motions/rise_prone.yaml"
            own.write_text(own.read_text().split("\n", 1)[1])
            text = own.read_text()
            third = self.climb("--until", "gets up from the front")
            self.assertEqual(third.returncode, first.returncode, third.stderr)
            self.assertIn("falls protected: as before", third.stderr)
            self.assertNotIn("gets up from the front: as before", third.stderr)
            self.assertEqual(own.read_text(), text)

    def test_a_search_gives_the_same_result_twice(self):
        found = []
        for name in ("one", "other"):
            robot = self.make(name)
            self.change(robot, "full_voltage_error_rad", SOFTER)
            result = self.climb("--candidates", 3, "--jobs", len(found) + 1, "--until", "walks forward", robot=robot)
            found.append(contents(robot))
            # Whatever the search has found, the rungs below carry it.
            for rung in RUNGS[:6]:
                self.assertRegex(result.stdout, rf"(?m)^{rung} +yes ")
        self.assertEqual(found[0], found[1])
        searched = json.loads(found[0][pathlib.Path("bring-up.json")])["searched"]  # three for each rung that needs it
        self.assertGreater(searched, 0)
        self.assertEqual(searched % 3, 0)

    def test_names_each_rung_that_fails_with_its_cause(self):
        self.change(self.robot, "resistance_ohm", 10.0)  # servos of a tenth of the torque
        result = self.climb("--until", "steps on the spot")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        failed = [line for line in result.stdout.splitlines() if " NO " in line]
        self.assertGreater(len(failed), 0, result.stdout)
        for line in failed:
            self.assertRegex(line, r"^(stands|shifts its weight|squats|steps on the spot) +NO +1 of 1 robots fall, the first [0-9.]+ s after ")
        self.assertRegex(result.stdout, r"(?m)^turns +- ")

    def test_keeps_an_edit_after_a_write_that_was_killed(self):
        self.assertEqual(self.climb("--until", "hangs").returncode, 0)
        journal = self.robot / "bring-up.json"
        state = json.loads(journal.read_text())
        # As the program leaves it between two files: one is of before, one of after.
        own = self.robot / "parameters.yaml"
        written = own.read_bytes()
        state.update({"complete": False, "next_files": state["files"], "files": {**state["files"], "motions/stand.yaml": "0" * 16}})
        journal.write_text(json.dumps(state))
        edited = own.read_text() + "# mine\n"
        own.write_text(edited)
        again = self.climb("--until", "hangs")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.robot / "parameters.yaml.bak").read_text(), edited)
        self.assertEqual(own.read_bytes(), written)
        self.assertEqual(list(self.robot.rglob("stand.yaml.bak*")), [])

    def test_refuses_a_reference_without_a_walk_before_it_writes(self):
        before = sorted(self.robot.rglob("*"))
        reference = self.make("reference")
        for text, expected in ((None, "no parameters.yaml beside the robot of --reference"),
                               ("version: 1\nrobot: koboshi\nparameters: {}\n", "no step_time_ms of the robot of --reference")):
            with self.subTest(expected):
                if text is not None:
                    (reference / "parameters.yaml").write_text(text)
                result = self.climb("--reference", reference)
                self.assertEqual(result.returncode, 2, result.stdout)
                self.assertIn(expected, result.stderr)
                self.assertEqual(sorted(self.robot.rglob("*")), before)

    def test_keeps_files_that_it_has_not_written(self):
        own = self.robot / "parameters.yaml"
        own.write_text("version: 1\nrobot: koboshi\nparameters: {}\n# Written by Anna\n")
        result = self.climb()
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertRegex(result.stderr, r"parameters\.yaml: found a file that bring-up has not written, expected ")
        self.assertIn("# Written by Anna", own.read_text())
        self.assertFalse((self.robot / "go.yaml").exists())


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
