"""`koboshi model import` from outside: the default robot, imported from its own file, still walks."""

import filecmp
import shlex
import shutil
import unittest

import program as support

PROGRAM = None
ROBOT = support.ROOT / "robots" / "koboshi"


class ModelImport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        source = cls.folder / "source"
        source.mkdir()
        shutil.copy(ROBOT / "robot.sdf", source / "kit.sdf")
        (source / "meshes").symlink_to(ROBOT / "meshes")
        (cls.folder / "servos").symlink_to(ROBOT.parent / "servos")
        cls.source = source / "kit.sdf"
        cls.robot = cls.folder / "robots" / "kit"
        cls.first = PROGRAM.run("model", "import", cls.source, "-o", cls.robot)

    def test_says_what_it_wrote(self):
        self.assertEqual(self.first.returncode, 0, self.first.stderr)
        self.assertIn(f"{self.robot}/robot.sdf: 21 links, 20 joints", self.first.stdout + self.first.stderr)
        self.assertEqual({path.name for path in self.robot.iterdir()} & {"robot.sdf", "import.yaml", "import.md", "meshes"},
                         {"robot.sdf", "import.yaml", "import.md", "meshes"})

    def test_shows_the_robot_and_its_boxes(self):
        page = (self.robot / "import.md").read_text()
        for picture in ("robot.png", "boxes.png"):
            self.assertIn(f"]({picture})", page)
            self.assertEqual((self.robot / picture).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertNotEqual((self.robot / "robot.png").read_bytes(), (self.robot / "boxes.png").read_bytes())

    def test_gives_a_robot_without_errors_that_walks(self):
        check = PROGRAM.run("model", "check", self.robot)
        self.assertNotIn("error[", check.stdout)
        run = PROGRAM.run("run", "walk", "--robot", self.robot, "--duration", "8", "--record", "no", "--out", self.folder / "run")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("did not fall; 0 faults", run.stdout)

    def test_repeats_itself_from_its_decisions(self):
        kept = self.folder / "kept"
        shutil.copytree(self.robot, kept)
        again = PROGRAM.run("model", "import", self.source, "-o", self.robot)
        self.assertEqual(again.returncode, 0, again.stderr)
        names = [str(path.relative_to(kept)) for path in kept.rglob("*") if path.is_file()]
        self.assertEqual(filecmp.cmpfiles(kept, self.robot, names, shallow=False)[1:], ([], []))

    def test_obeys_an_edited_decision(self):
        edited = self.folder / "robots" / "edited"
        shutil.copytree(self.robot, edited)
        decisions = edited / "import.yaml"
        text = decisions.read_text()
        self.assertIn("  name: koboshi\n", text)
        decisions.write_text(text.replace("  name: koboshi\n", "  name: kit\n"))
        self.assertEqual(PROGRAM.run("model", "import", self.source, "-o", edited).returncode, 0)
        self.assertIn('<model name="kit"', (edited / "robot.sdf").read_text())

    def test_refuses_bad_input_in_one_line_and_leaves_no_folder(self):
        for source, expected in {"nosuch.urdf": "no such file", self.folder: "a folder", ROBOT / "meshes": "a folder"}.items():
            with self.subTest(source):
                out = self.folder / "refused"
                result = PROGRAM.run("model", "import", source, "-o", out)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertIn(expected, result.stderr)
                self.assertFalse(out.exists())

    def test_destroys_no_source_in_its_own_folder(self):
        own = self.folder / "own"
        shutil.copytree(self.robot, own)
        shutil.copy(self.source, own / "kit.sdf")  # beside the meshes of the import
        before = {path: path.read_bytes() for path in own.rglob("*") if path.is_file()}
        for source in ("robot.sdf", "kit.sdf"):
            with self.subTest(source):
                result = PROGRAM.run("model", "import", own / source, "-o", own)
                self.assertEqual(result.returncode, 2, result.stdout)
                self.assertEqual({path: path.read_bytes() for path in own.rglob("*") if path.is_file()}, before)

    def test_names_the_joint_that_cannot_be_simulated(self):
        source = self.folder / "source" / "heavy.sdf"
        text = self.source.read_text()
        # The trunk of 40 kg is more than the format holds.
        place = text.index("<mass>")
        source.write_text(text[:place] + "<mass>40</mass>" + text[text.index("</mass>", place) + 7:])
        out = self.folder / "heavy"
        result = PROGRAM.run("model", "import", source, "-o", out)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertRegex(result.stderr, r"found a robot that cannot be simulated: link trunk: ")
        self.assertFalse(out.exists())

    def test_shows_a_command_that_the_shell_reads_whatever_the_folder_is_called(self):
        out = self.folder / "Anna's robots" / "kit"
        result = PROGRAM.run("model", "import", self.source, "-o", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        page = (out / "import.md").read_text()
        shown = [line for line in page.splitlines() if line.startswith("`koboshi model map ")][0].split("`")[1]
        self.assertEqual(shlex.split(shown)[3], str(out))
        made_by = next(line for line in page.splitlines() if line.startswith("    koboshi model import "))
        self.assertEqual(shlex.split(made_by)[-1], str(out))


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
