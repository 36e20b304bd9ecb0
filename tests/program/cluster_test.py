"""Shards on Slurm and by GNU parallel over ssh, on this machine: what was killed and run again equals what was not."""

import os
import pathlib
import shutil
import subprocess
import time
import unittest

import program as support

PROGRAM = None
TOOLS = support.ROOT / "tools" / "dev"
RESULTS = ("trials.jsonl", "trials.csv", "result.json")
# 32 trials, each of some tenths of a second.
EXPERIMENT = ("experiment", "gyro-feedback", "--points", "8", "--seeds", "16", "--stepper", "lumped", "--duration", "8")
SHARDS = 8
STUDY = """version: 1
scenario: {scenario}
numbers:
  parameters.step_width_mm: {{range: [66, 96], grid: 0.1, start: 84}}
  parameters.step_height_mm: {{range: [20, 40], grid: 0.1, start: 32}}
trials:
  - {{name: forward, set: {{duration_s: 6.5}}, reward: forward, wanted: 0.4}}
"""
PATIENCE_s = 240


def needs(*programs):
    path = os.environ["PATH"] + ":/usr/sbin"
    missing = [name for name in programs if shutil.which(name, path=path) is None]
    return unittest.skipIf(missing, f"not installed: {' '.join(missing)}")


class Cluster(unittest.TestCase):
    environment = {}

    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.alone = cls.folder / "alone"
        cls.koboshi(*EXPERIMENT, "--jobs", "1", "--out", cls.alone)

    @classmethod
    def command(cls, *arguments, status=0):
        result = subprocess.run([str(argument) for argument in arguments], cwd=support.ROOT, env={**os.environ, **cls.environment}, capture_output=True,
                                text=True, timeout=600, check=False)
        if status is not None and result.returncode != status:
            raise AssertionError(f"{arguments} ended with {result.returncode}: {result.stdout}{result.stderr}")
        return result.stdout

    @classmethod
    def koboshi(cls, *arguments, status=0):
        return cls.command(PROGRAM.path, *arguments, status=status)

    def await_that(self, what, condition):
        deadline = time.monotonic() + PATIENCE_s
        while not condition():
            self.assertLess(time.monotonic(), deadline, f"after {PATIENCE_s} s no {what}")
            time.sleep(0.02)

    def trials_of(self, folder, shard):
        file = folder / f"shard-{shard}-of-{SHARDS}.jsonl"
        return file.read_bytes().count(b"\n") if file.exists() else 0

    def assert_equal_to_one_program(self, folder):
        self.koboshi("lab", "collect", folder)
        for name in RESULTS:
            self.assertEqual((self.alone / name).read_bytes(), (folder / name).read_bytes(), name)
        lines = sum(self.trials_of(folder, shard) for shard in range(1, SHARDS + 1))
        self.assertEqual(32, lines, "no trial is played twice")


@needs("slurmctld", "slurmd", "munged", "sbatch")
@unittest.skipIf(os.geteuid() != 0, "slurmd needs root")
class Slurm(Cluster):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.slurm = cls.folder / "slurm"
        cls.addClassCleanup(cls.command, TOOLS / "one_node_slurm.sh", "stop", cls.slurm)
        cls.command(TOOLS / "one_node_slurm.sh", "start", cls.slurm, 3)
        cls.environment = {"SLURM_CONF": str(cls.slurm / "slurm.conf")}

    def states(self, job):
        """Returns the states of the tasks that are in the queue."""
        return self.command("squeue", "--noheader", "--array", "--format=%T", f"--jobs={job}", status=None).split()

    def submit(self, folder):
        output = self.koboshi("lab", "submit", "--slurm", "--shards", SHARDS, "--out", folder, *EXPERIMENT)
        self.assertRegex(output, r"^job \d+ plays the shards ")
        return output.split()[1], output.split()[5].rstrip(";")

    def await_end(self, job):
        def ended():
            # Slurm waits for two minutes before it starts a task again.
            if self.states(job):
                self.command("scontrol", "update", f"JobId={job}", "StartTime=now", status=None)
            return not self.states(job)

        self.await_that("end of the array", ended)

    def test_an_undisturbed_array(self):
        folder = self.folder / "undisturbed"
        job, shards = self.submit(folder)
        self.assertEqual("1-8", shards)
        self.assertRegex(self.koboshi("lab", "status", folder, status=1), rf"Slurm job {job}: .*(running|pending|configuring)")
        refused = subprocess.run([PROGRAM.path, "lab", "submit", "--slurm", "--shards", str(SHARDS), "--out", folder, *EXPERIMENT], cwd=support.ROOT,
                                 env={**os.environ, **self.environment}, capture_output=True, text=True, check=False)
        self.assertEqual(2, refused.returncode)
        self.assertIn(f"job {job} in the queue", refused.stderr)
        self.await_end(job)
        self.assertIn(f"Slurm job {job}: not in the queue", self.koboshi("lab", "status", folder))
        self.assert_equal_to_one_program(folder)
        self.assertRegex(self.koboshi("lab", "submit", "--slurm", "--shards", SHARDS, "--out", folder, *EXPERIMENT), "all 8 shards are complete")

    def test_a_killed_task_and_a_node_that_fails(self):
        folder = self.folder / "disturbed"
        job, _ = self.submit(folder)
        self.await_that("shard in its middle", lambda: 0 < self.trials_of(folder, 2) < 3)
        self.command("scancel", "--full", "--signal=KILL", f"{job}_2")
        self.await_that("shard in its middle", lambda: any(0 < self.trials_of(folder, shard) < 3 for shard in (3, 4, 5, 6)))
        self.command(TOOLS / "one_node_slurm.sh", "stop-node", self.slurm)
        finished = [self.trials_of(folder, shard) for shard in range(1, SHARDS + 1)]
        self.assertLess(sum(finished), 32)
        self.assertIn("incomplete", self.koboshi("lab", "status", folder, status=1))
        self.command(TOOLS / "one_node_slurm.sh", "start-node", self.slurm)
        self.await_end(job)
        # Slurm queues again what its node lost, but not what somebody killed.
        self.assertLess(self.trials_of(folder, 2), 4)
        self.assertEqual([4] * 6, [self.trials_of(folder, shard) for shard in range(3, SHARDS + 1)])
        self.koboshi("lab", "collect", folder, status=2)
        job, shards = self.submit(folder)
        self.assertEqual("2", shards)
        self.await_end(job)
        self.assert_equal_to_one_program(folder)

    def test_a_task_that_is_queued_again(self):
        folder = self.folder / "requeued"
        job, _ = self.submit(folder)
        self.await_that("shard in its middle", lambda: 0 < self.trials_of(folder, 1) < 3)
        self.command("scontrol", "requeue", f"{job}_1")
        self.await_end(job)
        self.assert_equal_to_one_program(folder)


    def test_a_search_of_which_a_shard_is_killed(self):
        study = self.folder / "study.yaml"
        study.write_text(STUDY.format(scenario=support.ROOT / "scenarios" / "go.yaml"))
        search = ("tune", study, "--stepper", "lumped", "--evaluations", "24", "--population", "6", "--seeds", "2")
        alone, folder = self.folder / "search_alone", self.folder / "search"
        self.koboshi(*search, "--jobs", "1", "--out", alone)
        job = self.koboshi("lab", "submit", "--slurm", "--shards", SHARDS, "--out", folder, *search).split()[1]
        # Three of the eight run at a time. The search ends without the one that dies and those that never began.
        self.await_that("shard in its middle", lambda: self.trials_of(folder, 2) >= 2)
        self.command("scancel", "--full", "--signal=KILL", f"{job}_2")
        self.await_end(job)
        self.koboshi("lab", "status", folder)
        self.koboshi("lab", "collect", folder)
        for name in ("trials.jsonl", "evaluations.csv", "best.yaml", "report.md", "search.json"):
            self.assertEqual((alone / name).read_bytes(), (folder / name).read_bytes(), name)


@needs("parallel", "sshd", "ssh")
class Parallel(Cluster):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        server = cls.folder / "ssh"
        cls.addClassCleanup(cls.command, TOOLS / "loopback_ssh.sh", "stop", server)
        cls.command(TOOLS / "loopback_ssh.sh", "start", server)
        cls.environment = {"PARALLEL_SSH": f"ssh -F {server}/ssh_config", "PARALLEL_HOME": str(cls.folder / "parallel")}
        (cls.folder / "parallel").mkdir()

    def submit(self, folder, status=0):
        return self.koboshi("lab", "submit", "--parallel", "2/localhost", "--shards", SHARDS, "--out", folder, *EXPERIMENT, status=status)

    def test_over_ssh(self):
        folder = self.folder / "undisturbed"
        self.submit(folder)
        log = (folder / "parallel.joblog").read_text().splitlines()[1:]
        self.assertEqual(["localhost"] * SHARDS, [line.split("\t")[1] for line in log])
        self.assert_equal_to_one_program(folder)

    def test_a_killed_shard_is_run_again(self):
        folder = self.folder / "disturbed"
        command = [PROGRAM.path, "lab", "submit", "--parallel", "2/localhost", "--shards", SHARDS, "--out", folder, *EXPERIMENT]
        with subprocess.Popen([str(word) for word in command], cwd=support.ROOT, env={**os.environ, **self.environment}, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True) as submit:
            self.await_that("shard in its middle", lambda: 0 < self.trials_of(folder, 2) < 3)
            self.kill_shard(folder, 2)
            output = submit.communicate(timeout=PATIENCE_s)[0]
        self.assertEqual(1, submit.returncode, output)
        self.assertIn("parallel ended with status 1", output)
        self.koboshi("lab", "collect", folder, status=2)
        (folder / f"shard-5-of-{SHARDS}.jsonl").unlink()  # its success is in the log, but a disk has lost it
        self.submit(folder)
        self.assert_equal_to_one_program(folder)

    def kill_shard(self, folder, shard):
        """Kills the program of this folder and shard, which the server of ssh has started."""
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            if words[0] == str(PROGRAM.path) and f"{shard}/{SHARDS}" in words and str(folder) in words:
                os.kill(int(process.name), 9)
                return
        self.fail(f"shard {shard} does not run")


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
