"""Shards of an experiment: merged, they are the results of one program, to the byte."""

import json
import os
import signal
import subprocess
import time
import unittest

import program as support

PROGRAM = None
RESULTS = ("trials.jsonl", "trials.csv", "result.json")
# Boots and begins to walk: 12 trials of two cells.
EXPERIMENT = ("experiment", "gyro-feedback", "--points", "8", "--seeds", "6", "--stepper", "lumped", "--duration", "1.5")
# Cells that end before all seeds are played: the robots of this ladder fall in the first batch.
LADDER = ("experiment", "robustness", "--only", "push-standing", "--factors", "impulse", "--levels", "0.01,3,4", "--seeds", "12", "--cliff",
          "0.1", "--stepper", "lumped")


def contents(folder):
    return {name: (folder / name).read_bytes() for name in RESULTS}


class Case(unittest.TestCase):
    @classmethod
    def played(cls, *arguments, status=0):
        result = PROGRAM.run(*arguments)
        if result.returncode != status:
            raise AssertionError(f"{arguments} ended with {result.returncode}: {result.stderr}")
        return result


class Shards(Case):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.alone = cls.folder / "alone"
        cls.played(*EXPERIMENT, "--jobs", "1", "--out", cls.alone)

    def shard(self, number, folder, command=EXPERIMENT, count=3):
        return self.played(*command, "--shard", f"{number}/{count}", "--jobs", "1", "--out", folder)

    def test_merge_into_the_results_of_one_program(self):
        folder = self.folder / "whole"
        for number in (2, 3, 1):
            self.assertIn(f"shard {number} of 3: 4 trials\n", self.shard(number, folder).stdout)
        for _ in range(2):
            merged = self.played("lab", "collect", folder)
            self.assertEqual(contents(self.alone), contents(folder))
        table = self.played(*EXPERIMENT, "--jobs", "1", "--out", self.alone).stdout
        self.assertEqual(table.splitlines()[:-1], merged.stdout.splitlines()[:-1])

    def test_missing_ones_are_named(self):
        folder = self.folder / "missing"
        self.shard(1, folder)
        self.shard(3, folder)
        self.assertRegex(self.played("lab", "status", folder, status=1).stdout, r"(?m)^\s*2\s+0\s+4\s+incomplete$")
        refused = self.played("lab", "collect", folder, status=2)
        self.assertRegex(refused.stderr, r"^\S*missing: found incomplete shards: 2 \(0 of 4 trials\), expected 3 complete ones .*\n$")
        self.shard(2, folder)
        self.assertRegex(self.played("lab", "status", folder).stdout, r"(?m)^\s*2\s+4\s+0\s+complete$")
        self.played("lab", "collect", folder)
        self.assertEqual(contents(self.alone), contents(folder))

    def test_a_killed_one_resumes(self):
        folder = self.folder / "killed"
        for number in (1, 3):
            self.shard(number, folder)
        file = folder / "shard-2-of-3.jsonl"
        command = [PROGRAM.path, *EXPERIMENT, "--shard", "2/3", "--jobs", "1", "--out", folder]
        with subprocess.Popen(command, cwd=support.ROOT, stdout=subprocess.DEVNULL) as shard:
            while shard.poll() is None and not (file.exists() and file.stat().st_size > 0):
                time.sleep(0.002)
            shard.send_signal(signal.SIGKILL)
        whole = file.read_bytes()
        file.write_bytes(whole[:-7])  # as if it had been killed while it wrote
        self.assertRegex(self.played("lab", "collect", folder, status=2).stderr, r"incomplete shards: 2 \(\d of 4 trials\)")
        self.shard(2, folder)
        self.played("lab", "collect", folder)
        self.assertEqual(contents(self.alone), contents(folder))

    def test_cells_that_stop_early(self):
        alone = self.folder / "ladder_alone"
        self.played(*LADDER, "--jobs", "1", "--out", alone)
        stops = [cell["stop"] for cell in json.loads((alone / "result.json").read_text())["cells"]]
        self.assertEqual(["all_seeds", "too_many"], stops)
        folder = self.folder / "ladder"
        for number in (1, 2):
            self.shard(number, folder, LADDER, 2)
        self.played("lab", "collect", folder)
        self.assertEqual(contents(alone), contents(folder))

    def test_from_another_directory(self):
        folder = self.folder / "elsewhere"
        for number in (1, 2, 3):
            self.shard(number, folder)
        merged = PROGRAM.run("lab", "collect", "elsewhere", cwd=self.folder)
        self.assertEqual(0, merged.returncode, merged.stderr)
        self.assertEqual(contents(self.alone), contents(folder))

    def test_bad_input(self):
        folder = self.folder / "bad"
        self.shard(1, folder)
        for arguments, message in (
                ((*EXPERIMENT, "--shard", "4/3", "--out", folder), "found the shard 4/3, expected K/N"),
                ((*EXPERIMENT, "--shard", "1/4", "--out", folder), "found 3 shards, expected 4"),
                ((*EXPERIMENT, "--disturbed", "--shard", "1/3", "--out", folder), "--disturbed, or a new folder"),
                ((*EXPERIMENT, "--shard", "1/3", "--out", self.alone), "found a folder with other files"),
                (("lab", "collect", self.alone), "job.json: found no such file"),
                (("lab", "status", self.folder / "none"), "job.json: found no such file"),
                (("lab", "submit", "--shards", "2", "--out", folder, *EXPERIMENT), "found neither, expected one of --slurm"),
                (("lab", "submit", "--slurm", "--shards", "2", "--out", folder), "found no command, expected experiment, tune or learn"),
                (("lab", "submit", "--slurm", "--shards", "2", "--out", folder, "run", "x"), "found run, expected experiment, tune or learn"),
                (("lab", "submit", "--slurm", "--shards", "2", "--out", folder, *EXPERIMENT, "--out", "x"), "expected --out and --jobs before it"),
                (("lab", "submit", "--slurm", "--shards", "2", "--out", self.folder / "new", *EXPERIMENT, "--stepper", "none"), "none not in"),
        ):
            with self.subTest(arguments[-3:]):
                result = self.played(*arguments, status=2)
                self.assertIn(message, result.stderr)
                self.assertEqual("", result.stdout)

    def test_a_training_by_gradients_is_refused_without_a_trace(self):
        folder = self.folder / "gradients"
        for shards in (("--shards", "plan"), ("--shard", "1/2"), ("--shards", "merge")):
            result = self.played("learn", "pushes", *shards, "--out", folder, status=2)
            self.assertRegex(result.stderr, r"pushes\.yaml:\d+: found algorithm ppo in shards, expected es, or one program\n$")
            self.assertFalse(folder.exists())

    def test_programs_that_are_not_installed(self):
        for option, message in ((("--slurm",), "sbatch: found no such program, expected Slurm's (apt install slurm-client)"),
                                (("--parallel", ":"), "parallel: found no such program, expected GNU parallel")):
            with self.subTest(option):
                folder = self.folder / option[0].strip("-")
                command = [PROGRAM.path, "lab", "submit", *option, "--shards", "2", "--out", folder, *EXPERIMENT]
                bare = self.folder / "bare"  # a path without these programs
                bare.mkdir(exist_ok=True)
                result = subprocess.run(command, cwd=support.ROOT, env={**os.environ, "PATH": str(bare)}, capture_output=True, text=True, check=False)
                self.assertEqual(2, result.returncode, result.stderr)
                self.assertEqual(1, result.stderr.count("\n"), result.stderr)
                self.assertIn(message, result.stderr)


STUDY = """version: 1
scenario: {scenario}
numbers:
  parameters.standing_gain_ankle_pitch_s: {{range: [0, 0.06], grid: 0.0005, start: 0.01}}
  parameters.step_height_mm: {{range: [20, 40], grid: 0.1, start: 32}}
trials:
  - {{name: forward, set: {{duration_s: 6.5}}, reward: forward, wanted: 0.4}}
"""
SEARCH_RESULTS = ("trials.jsonl", "evaluations.csv", "best.yaml", "report.md", "search.json")


class Search(Case):
    """A search of two islands in shards, of which one is killed."""

    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        study = cls.folder / "study.yaml"
        study.write_text(STUDY.format(scenario=support.ROOT / "scenarios" / "go.yaml"))
        cls.search = ("tune", study, "--stepper", "lumped", "--evaluations", "20", "--population", "5", "--islands", "2", "--migrate", "1", "--seeds", "1")

    def start(self, number, folder):
        command = [str(word) for word in (PROGRAM.path, *self.search, "--shard", f"{number}/2", "--jobs", "1", "--out", folder)]
        process = subprocess.Popen(command, cwd=support.ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.addCleanup(process.stdout.close)
        return process

    def test_a_killed_shard_changes_nothing(self):
        alone = self.folder / "alone"
        self.played(*self.search, "--jobs", "2", "--out", alone)
        self.played(*self.search, "--jobs", "1", "--out", self.folder / "one_thread")
        folder = self.folder / "shards"
        first, second = (self.start(number, folder) for number in (1, 2))
        file = folder / "shard-2-of-2.jsonl"
        deadline = time.monotonic() + 120
        while not (file.exists() and file.read_bytes().count(b"\n") >= 3):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.005)
        second.kill()
        second.wait()
        self.assertEqual(1, PROGRAM.run("lab", "status", folder).returncode)
        refused = self.played("lab", "collect", folder, status=2)
        self.assertRegex(refused.stderr, r"found incomplete shards: \d+ of 10 trials are missing after \d+ of 20 candidates, ")
        self.assertFalse((folder / "evaluations.csv").exists())
        second = self.start(2, folder)
        numbers = len(json.loads((alone / "search.json").read_text())["numbers"])
        rows = [line.split(",")[1:1 + numbers] for line in (alone / "evaluations.csv").read_text().splitlines()[1:]]
        different = len(set(map(tuple, rows)))
        self.assertLess(different, 20)  # candidates round to the same parameters in this search
        counts = f"20 candidates, {different} evaluated and {20 - different} repeated"
        for number, process in ((1, first), (2, second)):
            output = process.communicate(timeout=300)[0]
            self.assertEqual((0, f"shard {number} of 2: the search has ended after {counts}\n"), (process.returncode, output))
        self.played("lab", "status", folder)
        for _ in range(2):
            self.played("lab", "collect", folder)
            for name in SEARCH_RESULTS:
                self.assertEqual((self.folder / "one_thread" / name).read_bytes(), (folder / name).read_bytes(), name)
        # Threads finish in any order, but the strategy learns in one.
        for name in SEARCH_RESULTS[1:]:
            self.assertEqual((alone / name).read_bytes(), (folder / name).read_bytes(), name)

    def test_bad_input(self):
        result = self.played(*self.search, "--search", "nsga-2", "--shard", "1/2", "--out", self.folder / "front", status=2)
        self.assertEqual("--search: found nsga-2 in shards, expected cma-es\n", result.stderr)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
