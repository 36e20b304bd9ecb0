"""`koboshi motion import --all`: each page of a file into a motion file of its own."""

import unittest

import program as support

PROGRAM = None
SOURCE = support.ROOT / "docs" / "tutorial" / "bring-your-motions"
HEAD = "type=motion\nversion=1.01\nenable=0 1 1\n"
PAGE = "page_begin\nname={}\nplay_param=0 0 1 1 32\nstep=0 512 512 0 1\nstep=0 {} 512 0.5 1\npage_end\n"


class MotionImport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def run_import(self, file, *options):
        return PROGRAM.run("motion", "import", file, "--map", SOURCE / "servos.yaml", *options)

    def test_writes_each_page_as_it_is_imported_alone(self):
        out = self.folder / "pages"
        result = self.run_import(SOURCE / "pages.mtn", "--all", "-o", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, f"2 of 2 pages imported into {out}\n")
        names = ["001_look_left.yaml", "002_look_round.yaml"]
        self.assertEqual(sorted(file.name for file in out.iterdir()), names)
        for page, name in enumerate(names, start=1):
            alone = self.run_import(f"{SOURCE / 'pages.mtn'}:{page}")
            self.assertEqual((out / name).read_text(), alone.stdout)
            self.assertIn(f"{SOURCE / 'pages.mtn'}:{page}: ", result.stderr)
            self.assertEqual(PROGRAM.run("motion", "check", out / name).returncode, 0)

    def test_names_a_page_that_it_leaves_out(self):
        file = self.folder / "far.mtn"
        file.write_text(HEAD + PAGE.format("Far", 1000) + PAGE.format("Wave: 2", 612))
        out = self.folder / "far"
        result = self.run_import(file, "--clamp", "1", "--all", "-o", out)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stdout, f"1 of 2 pages imported into {out}\n")
        self.assertRegex(result.stderr, r"(?m)far\.mtn:1: left out: .*head_pan")
        self.assertEqual([file.name for file in out.iterdir()], ["002_wave_2.yaml"])

    def test_overwrites_nothing(self):
        out = self.folder / "kept"
        self.assertEqual(self.run_import(SOURCE / "pages.mtn", "--all", "-o", out).returncode, 0)
        (out / "001_look_left.yaml").unlink()
        (out / "002_look_round.yaml").write_text("mine")
        result = self.run_import(SOURCE / "pages.mtn", "--all", "-o", out)
        self.assertEqual(result.returncode, 2)
        self.assertIn("002_look_round.yaml: found a file of this name, expected", result.stderr)
        self.assertEqual([file.read_text() for file in out.iterdir()], ["mine"])

    def test_refuses_a_bad_map_once(self):
        bad = self.folder / "bad.yaml"
        bad.write_text("version: 1\njoints:\n  1: {joint: tail}\n")
        out = self.folder / "bad"
        result = PROGRAM.run("motion", "import", SOURCE / "pages.mtn", "--map", bad, "--all", "-o", out)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertFalse(out.exists())

    def test_refuses_what_it_cannot_mean(self):
        for options, expected in ((["--all"], "-o FOLDER"), (["--all", "--list"], "excludes")):
            result = self.run_import(SOURCE / "pages.mtn", *options)
            self.assertEqual(result.returncode, 2, options)
            self.assertIn(expected, result.stderr)
        result = self.run_import(f"{SOURCE / 'pages.mtn'}:1", "--all", "-o", self.folder / "one")
        self.assertEqual(result.returncode, 2)
        self.assertIn("page 1 and --all", result.stderr)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
