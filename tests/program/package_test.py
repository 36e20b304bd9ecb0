"""The Debian packages that CPack makes of this build: contents, control fields, the same bytes each time, and a run of the
unpacked program by an ordinary user. `./run package` checks more, in a system of its own (tools/dev/check_packages.sh)."""

import gzip
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BUILD, VERSION = sys.argv[1:3]
NOBODY = 65534


def call(*command, **options):
    result = subprocess.run(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)
    if result.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: status {result.returncode}\n{result.stdout}")
    return result.stdout


def pack(folder):
    # gzip is faster than xz, and the contents are the same.
    call("cpack", "--config", f"{BUILD}/CPackConfig.cmake", "-B", folder, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip")
    return {path.name.partition("_")[0]: path for path in pathlib.Path(folder).glob("*.deb")}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="koboshi_package_")))
        cls.folder.chmod(0o755)
        call("cmake", "--build", BUILD, "--target", "koboshi_manual")
        os.umask(0o022)  # as `./run package` sets it
        cls.debs = pack(cls.folder / "first")
        cls.root = cls.folder / "root"
        for deb in cls.debs.values():
            call("dpkg-deb", "-x", deb, cls.root)

    def control(self, name):
        text = call("dpkg-deb", "--field", self.debs[name])
        return dict(re.findall(r"^(\S+): (.*(?:\n .*)*)", text, re.MULTILINE))

    def test_are_those_of_this_build(self):
        wanted = {"koboshi", "libkoboshi-dev"}
        if pathlib.Path(BUILD, "bin", "koboshi-studio").exists():
            wanted.add("koboshi-studio")
        if list(pathlib.Path(BUILD, "python").glob("koboshi.*.so")):
            wanted.add("python3-koboshi")
        self.assertEqual(wanted, set(self.debs))

    def test_are_the_same_each_time(self):
        again = pack(self.folder / "in_another_folder")
        for name, deb in self.debs.items():
            self.assertEqual(deb.name, again[name].name)
            self.assertEqual(deb.read_bytes(), again[name].read_bytes(), name)

    def test_control_fields(self):
        version = self.control("koboshi")["Version"]
        self.assertTrue(version.startswith(VERSION), version)
        for name in self.debs:
            fields = self.control(name)
            with self.subTest(name):
                self.assertEqual((name, version), (fields["Package"], fields["Version"]))
                self.assertRegex(fields["Maintainer"], r"^[^<>]+ <\S+@\S+>$")
                summary, _, text = fields["Description"].partition("\n")
                self.assertRegex(summary, r"^[a-z].{20,79}[^.]$")
                self.assertGreater(len(text), 100)
                if name in ("koboshi-studio", "python3-koboshi"):
                    self.assertIn(f"koboshi (= {version})", fields["Depends"])
                if name != "libkoboshi-dev":
                    self.assertIn("libc6 (>=", fields["Depends"])
        self.assertRegex(self.control("koboshi")["Depends"], r"\blibode\d")

    def test_checksums_are_those_of_the_files(self):
        for name, deb in self.debs.items():
            sums = call("dpkg-deb", "--info", deb, "md5sums")
            self.assertGreater(len(sums.splitlines()), 3, name)
            for line in sums.splitlines():
                digest, path = line.split("  ", 1)
                self.assertEqual(digest, hashlib.md5((self.root / path).read_bytes()).hexdigest(), path)

    def test_files_belong_to_root_and_are_readable(self):
        for deb in self.debs.values():
            for line in call("dpkg-deb", "--contents", deb).splitlines():
                self.assertRegex(line, r"^(drwxr-xr-x|-rw-r--r--|-rwxr-xr-x) root/root ")
                if line.startswith("-rwx"):
                    self.assertRegex(line, r" \./usr/bin/koboshi(-studio)?$")

    def test_have_copyright_and_changelog(self):
        for name in self.debs:
            folder = self.root / "usr/share/doc" / name
            with self.subTest(name):
                self.assertIn("Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/",
                              (folder / "copyright").read_text())
                changelog = gzip.decompress((folder / "changelog.gz").read_bytes()).decode()
                self.assertTrue(changelog.startswith(f"koboshi ({self.control(name)['Version']}) unstable; urgency=medium\n\n"))
                self.assertRegex(changelog, r"\n -- [^<>]+ <\S+>  \w{3}, \d\d \w{3} \d{4} \d\d:\d\d:\d\d \+0000\n$")

    def test_contents(self):
        wanted = ["bin/koboshi", "share/koboshi/scenarios/walk.yaml", "share/koboshi/robots/koboshi/robot.sdf",
                  "share/koboshi/studies/walk.yaml", "share/man/man1/koboshi.1.gz", "share/man/man1/koboshi-can-dump.1.gz",
                  "share/bash-completion/completions/koboshi", "share/doc/koboshi/README.md", "share/doc/koboshi/docs/README.md",
                  "include/koboshi/firmware/app/controller.h", "lib/cmake/koboshi/koboshiConfig.cmake"]
        if "koboshi-studio" in self.debs:
            wanted += ["bin/koboshi-studio", "share/man/man1/koboshi-studio.1.gz", "share/applications/koboshi-studio.desktop",
                       "share/icons/hicolor/scalable/apps/koboshi-studio.svg"]
        for path in wanted:
            self.assertTrue((self.root / "usr" / path).is_file(), path)
        for path in self.root.rglob("*.a"):
            self.assertNotIn(".debug_info", call("readelf", "--section-headers", "--wide", path))

    def test_runs_for_an_ordinary_user_in_an_empty_folder(self):
        home = self.folder / "home"
        here = home / "here"
        here.mkdir(parents=True)
        command = []
        if os.geteuid() == 0:
            for folder in (home, here):
                os.chown(folder, NOBODY, NOBODY)
            command = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
        environment = {"HOME": str(home), "PATH": f"{self.root}/usr/bin:/usr/bin:/bin", "LC_ALL": "C.UTF-8"}
        call(*command, "koboshi", "run", "walk", "--duration", "1", cwd=here, env=environment)
        self.assertTrue((here / "runs/walk/summary.json").is_file())
        self.assertEqual(["here"], [path.name for path in home.iterdir()])


if __name__ == "__main__":
    del sys.argv[1:3]
    unittest.main()
