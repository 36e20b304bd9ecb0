"""`koboshi model export` from outside: a reader of URDF that others wrote accepts the file, and it comes back as the same robot."""

import shutil
import subprocess
import unittest

import program as support

PROGRAM = None
ROBOT = support.ROOT / "robots" / "koboshi"


class ModelExport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.urdf = cls.folder / "urdf" / "koboshi.urdf"
        cls.exported = PROGRAM.run("model", "export", "koboshi", "--urdf", cls.urdf)

    def test_names_the_files_it_wrote(self):
        self.assertEqual(self.exported.returncode, 0, self.exported.stderr)
        written = set(self.exported.stdout.splitlines())
        self.assertEqual(written, {str(path) for path in self.urdf.parent.rglob("*") if path.is_file()})
        self.assertIn(str(self.urdf.parent / "LICENSE"), written)

    @unittest.skipUnless(shutil.which("check_urdf"), "no check_urdf (liburdfdom-tools)")
    def test_is_a_urdf_for_others(self):
        result = subprocess.run(["check_urdf", self.urdf], capture_output=True, text=True, timeout=30, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("root Link: trunk has 5 child(ren)", result.stdout)

    def test_comes_back_as_the_same_robot(self):
        back = self.folder / "robots" / "back"
        result = PROGRAM.run("model", "import", self.urdf, "-o", back)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("21 links, 20 joints, 1 answer, 0 repairs, 0 warnings", result.stdout)
        self.assertEqual((back / "robot.sdf").read_bytes(), (ROBOT / "robot.sdf").read_bytes())

    def test_writes_paths_of_a_package(self):
        urdf = self.folder / "package" / "koboshi.urdf"
        result = PROGRAM.run("model", "export", "koboshi", "--urdf", urdf, "--package", "koboshi_description")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('filename="package://koboshi_description/meshes/trunk_frame.stl"', urdf.read_text())

    def test_destroys_no_meshes(self):
        folder = self.folder / "others"
        shutil.copytree(ROBOT, folder, ignore=shutil.ignore_patterns("motions"))
        foreign = folder / "meshes" / "trunk_frame.stl"
        foreign.write_bytes(b"another robot's")
        before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        result = PROGRAM.run("model", "export", "koboshi", "--urdf", folder / "koboshi.urdf")
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn("trunk_frame.stl: found another file of this name", result.stderr)
        own = next(path for path in before if path.suffix == ".stl" and path != foreign)
        result = PROGRAM.run("model", "export", folder, "--urdf", own)
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn("found the input as the output", result.stderr)
        self.assertEqual({path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}, before)

    def test_replaces_an_earlier_export(self):
        robot = self.folder / "mine"
        shutil.copytree(ROBOT, robot, ignore=shutil.ignore_patterns("motions"))
        urdf = self.folder / "twice" / "koboshi.urdf"
        self.assertEqual(PROGRAM.run("model", "export", robot, "--urdf", urdf).returncode, 0)
        mesh = robot / "meshes" / "trunk_frame.stl"
        shutil.copy(robot / "meshes" / "left_foot.stl" if (robot / "meshes" / "left_foot.stl").exists()
                    else next(path for path in (robot / "meshes").iterdir() if path != mesh), mesh)
        result = PROGRAM.run("model", "export", robot, "--urdf", urdf)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((urdf.parent / "meshes" / "trunk_frame.stl").read_bytes(), mesh.read_bytes())

    def test_refuses_bad_input_in_one_line(self):
        folder = self.folder / "refused" / "folder"
        folder.mkdir(parents=True)
        for arguments in (["nosuch", "--urdf", folder / "a.urdf"], ["koboshi", "--urdf", folder]):
            with self.subTest(arguments):
                result = PROGRAM.run("model", "export", *arguments)
                self.assertNotEqual(result.returncode, 0)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertEqual([path.name for path in folder.parent.rglob("*")], ["folder"])


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
