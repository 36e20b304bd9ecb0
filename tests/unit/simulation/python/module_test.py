"""The Python module: arrays, commands, errors, repeatability, threads, and its type stubs."""

import ast
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[4]
MODULE_FOLDER = pathlib.Path(sys.argv[1])
PROGRAM = sys.argv[2]
sys.path.insert(0, str(MODULE_FOLDER))

import koboshi  # noqa: E402
import numpy as np  # noqa: E402

GO = ROOT / "scenarios/go.yaml"


def go(**arguments):
    return koboshi.Simulation(GO, stepper="lumped", **arguments)


class Simulation(unittest.TestCase):
    def test_gives_the_bits_of_koboshi_run(self):
        with tempfile.TemporaryDirectory() as out:
            subprocess.run([PROGRAM, "run", GO, "--stepper", "lumped", "--duration", "1.5", "--seed", "3", "--out", f"{out}/run"],
                           cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
            summary = json.loads(pathlib.Path(out, "run/summary.json").read_text())
        sim = go(seed=3)
        while sim.time_s < 1.4995:
            sim.step(7 if sim.time_s < 1.4925 else 1)
        self.assertEqual(sim.state_hash, summary["state_hash"])

    def test_walks_as_it_is_commanded(self):
        sim = go(set={"commands": [{"at_s": 2, "enable": True}]})
        sim.step(4200)
        self.assertEqual(sim.state().state, "standing")
        sim.command("walk", forward_m_per_s=0.15)
        sim.step(2500)
        self.assertEqual(sim.state().state, "walking")
        self.assertGreater(sim.truth().position_m[0], 0.05)
        sim.command("stop")
        self.assertTrue(any("walk" in text for _, text in sim.events()))

    def test_fields_have_their_shapes_and_belong_to_the_caller(self):
        sim = go()
        sim.step(20)
        before, truth = sim.state(), sim.truth()
        joints, links = len(sim.joint_names), len(sim.link_names)
        self.assertEqual(before.joint_position_rad.shape, (joints,))
        self.assertEqual(truth.link_rotation.shape, (links, 3, 3))
        np.testing.assert_allclose(truth.link_rotation @ truth.link_rotation.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (links, 3, 3)),
                                   atol=1e-9)
        kept = truth.joint_position_rad.copy()
        sim.step(3000)
        np.testing.assert_array_equal(truth.joint_position_rad, kept)
        self.assertGreater(np.abs(sim.truth().joint_position_rad - kept).max(), 0)

    def test_frames_are_those_since_the_last_call(self):
        sim = go(frames=True)
        sim.step(500)
        first = sim.frames()
        self.assertGreater(len(first), 100)
        self.assertTrue((np.diff(first["time_us"].astype(np.int64)) > 0).all())
        self.assertEqual(len(sim.frames()), 0)
        sim.step(10)
        self.assertGreater(sim.frames()["time_us"].min(), first["time_us"].max())
        with self.assertRaisesRegex(ValueError, "frames=True"):
            go().frames()

    def test_reset_begins_anew(self):
        sim = go(seed=1)
        sim.step(50)
        first = sim.state_hash
        sim.push([5, 0, 0], 0.01)
        sim.step(20)
        sim.reset()
        sim.step(50)
        self.assertEqual(sim.state_hash, first)
        sim.reset(2)
        sim.step(50)
        self.assertNotEqual(sim.state_hash, first)

    def test_a_snapshot_brings_back_the_same_future(self):
        sim = go(seed=1)
        sim.step(30)
        snapshot = sim.snapshot()
        self.assertAlmostEqual(snapshot.time_s, 0.03)
        sim.step(40)
        first = sim.state_hash
        for force_N in (5, -5):
            sim.restore(snapshot)
            sim.push([force_N, 0, 0], 0.01, link=sim.link_names[-1])  # the trunk is still held
            sim.step(40)
            self.assertNotEqual(sim.state_hash, first)
        sim.restore(snapshot)
        self.assertAlmostEqual(sim.time_s, 0.03)
        sim.step(40)
        self.assertEqual(sim.state_hash, first)
        with self.assertRaisesRegex(RuntimeError, "^found a snapshot of another simulation, expected one that this simulation has made$"):
            go(seed=1).restore(snapshot)
        sim.reset()
        with self.assertRaisesRegex(RuntimeError, "^found a snapshot from before the last reset of this simulation, expected one from after it$"):
            sim.restore(snapshot)

    def test_takes_numpy_numbers_and_names_what_it_does_not_take(self):
        sim = koboshi.Simulation(GO, stepper="lumped", set={"duration_s": np.float32(3)})
        sim.command("walk", forward_m_per_s=np.float32(0.1), turn_rad_per_s=np.int64(0))
        with self.assertRaisesRegex(TypeError, "found <class 'object'>, expected numbers"):
            sim.command("walk", forward_m_per_s=object())
        for bad in (np.ones((4, 3)), None):
            with self.assertRaisesRegex(ValueError, "expected a list of numbers") as raised:
                sim.push(bad, 0.1)
            self.assertNotIn("\n", str(raised.exception))
        with self.assertRaises(ValueError) as raised:
            sim.push(np.array([[1.0, 2.0], [3.0, 4.0]]), 0.1)
        self.assertEqual(str(raised.exception), "found array([[1., 2.], [3., 4.]]), expected a list of numbers")
        sims = koboshi.Simulations(GO, range(2), stepper="lumped")
        with self.assertRaisesRegex(IndexError, "found world 9, expected one of 2"):
            sims.push([0, 1, 0], 0.1, world=9)

    def test_a_push_moves_the_robot(self):
        sim = go()
        sim.step(10)
        before = sim.truth().link_position_m.copy()
        sim.push(np.array([0.0, 30.0, 0.0]), 0.2, link="left_hand" if "left_hand" in sim.link_names else sim.link_names[-1])
        sim.step(200)
        self.assertGreater(np.abs(sim.truth().link_position_m - before).max(), 1e-3)


def standing():
    sim = go(set={"commands": [{"at_s": 2, "enable": True}], "initial.held_until_s": 60})
    sim.step(3000)
    assert sim.state().state == "standing"  # and has rested for a second before
    return sim


class Stream(unittest.TestCase):
    def test_moves_a_joint_and_returns_without_sets(self):
        sim = standing()
        pose = sim.state().joint_target_rad
        joint = sim.joint_names.index("left_shoulder_roll")
        targets = pose.copy()
        targets[joint] += 0.3
        sim.command("stream")
        for _ in range(20):
            sim.stream(targets)
            sim.step(10)
        self.assertEqual(sim.state().state, "streaming")
        self.assertAlmostEqual(sim.state().joint_target_rad[joint], targets[joint], delta=1e-4)
        self.assertAlmostEqual(sim.state().joint_position_rad[joint], targets[joint], delta=0.02)
        others = np.arange(len(pose)) != joint
        np.testing.assert_allclose(sim.state().joint_target_rad[others], pose[others], atol=1e-4)
        sim.step(1500)
        self.assertEqual(sim.state().state, "standing")
        np.testing.assert_allclose(sim.state().joint_target_rad, pose, atol=2e-3)  # the feedback is on again

    def test_limits_torques(self):
        moved_rad = []
        for limit_percent in (100, 2):
            sim = standing()
            pose = sim.state().joint_target_rad
            limits = np.full(len(pose), 100.0)
            joint = sim.joint_names.index("left_shoulder_pitch")
            limits[joint] = limit_percent
            sim.command("stream")
            sim.step(10)
            for cycle in range(100):
                if cycle == 60:
                    sim.push([2, 0, 0], 0.4, link="left_forearm")
                sim.stream(pose, limits)
                sim.step(10)
            moved_rad.append(np.abs(sim.state().joint_position_rad[joint] - pose[joint]))
        self.assertLess(moved_rad[0], 0.1)
        self.assertGreater(moved_rad[1], 0.3)
        for bad in (-50.0, 0.0, 1e9):
            limits[joint] = bad
            with self.assertRaisesRegex(ValueError, "percent, expected 1 to 100"):
                sim.stream(pose, limits)

    def test_has_the_same_bits_after_a_snapshot(self):
        sim = standing()
        pose = sim.state().joint_target_rad
        sim.command("stream")
        sim.step(20)
        snapshot, hashes = sim.snapshot(), []
        for _ in range(2):
            sim.restore(snapshot)
            for step in range(5):
                sim.stream(pose + 0.01 * step)
                sim.step(10)
            hashes.append(sim.state_hash)
        self.assertEqual(*hashes)

    def test_is_held_by_the_operator_of_a_scenario(self):
        commands = [{"at_s": 2, "enable": True}, {"at_s": 3, "stream": {"joints_deg": {"head_pan": 20}}}, {"at_s": 4, "stop": True}]
        sim = go(set={"commands": commands, "initial.held_until_s": 60})
        run = sim.record(5500)
        angle_deg = np.degrees(run["joint_target_rad"][:, sim.joint_names.index("head_pan")])
        self.assertEqual(run["state_name"][389], "streaming")
        self.assertAlmostEqual(angle_deg[389], 20, delta=0.01)
        self.assertEqual(run["state_name"][-1], "standing")
        self.assertEqual(angle_deg[-1], angle_deg[290])
        self.assertFalse(any("Emergency" in text for _, text in sim.events()))

    def test_of_many_worlds_takes_a_set_for_each(self):
        sims = koboshi.Simulations(GO, seeds=[1, 2], stepper="lumped",
                                   set={"commands": [{"at_s": 2, "enable": True}], "initial.held_until_s": 60})
        sims.step(3000)
        targets = sims.state().joint_target_rad
        joint = sims.joint_names.index("head_pan")
        targets[:, joint] = [0.1, -0.1]
        sims.command("stream")
        for _ in range(10):
            sims.stream(targets)
            sims.step(10)
        np.testing.assert_allclose(sims.state().joint_target_rad[:, joint], [0.1, -0.1], atol=1e-4)
        with self.assertRaisesRegex(ValueError, "found 3 sets, expected 2"):
            sims.stream(np.zeros((3, targets.shape[1])))

    def test_refuses_sets_of_another_robot(self):
        sim = go()
        joints = len(sim.joint_names)
        for bad in ([0.0], [float("nan")] * joints):
            with self.assertRaisesRegex(ValueError, f"expected {joints} finite numbers"):
                sim.stream(bad)
        with self.assertRaisesRegex(koboshi.InputError, "unknown joint nose"):
            sim.command("stream", joints_deg={"nose": 1})


class Record(unittest.TestCase):
    def test_has_the_rows_of_the_recording(self):
        with tempfile.TemporaryDirectory() as out:
            subprocess.run([PROGRAM, "run", GO, "--stepper", "lumped", "--duration", "1", "--seed", "3", "--out", f"{out}/run"],
                           cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
            lines = pathlib.Path(out, "run/trace.csv").read_text().splitlines()
        rows = list(csv.DictReader(lines))
        sim = go(seed=3)
        run = sim.record(1000)
        self.assertEqual(run.shape, (100,))
        self.assertEqual(len(rows), 100)
        by_joint = {"joint_target_rad", "joint_encoder_rad", "joint_true_rad", "joint_torque_permille"}
        self.assertEqual([name for name in run.dtype.names if name not in by_joint],
                         [name for name in rows[0] if not any(name.startswith(joint) for joint in sim.joint_names)])
        for at in (0, 70, 99):
            for name in run.dtype.names:
                if name in by_joint:
                    wanted = [float(rows[at][joint + name.removeprefix("joint")]) for joint in sim.joint_names]
                    np.testing.assert_array_equal(run[name][at], wanted)
                elif run.dtype[name].kind == "U":
                    self.assertEqual(run[name][at], rows[at][name])
                else:
                    np.testing.assert_equal(float(run[name][at]), float(rows[at][name] or "nan"))

    def test_goes_on_and_changes_nothing(self):
        sim, other = go(seed=1), go(seed=1)
        first, second = sim.record(105), sim.record(20)
        other.step(125)
        self.assertEqual(sim.state_hash, other.state_hash)
        np.testing.assert_allclose(np.concatenate([first["time_s"], second["time_s"]]), 0.01 * np.arange(1, 13), atol=1e-12)

    def test_of_many_worlds_has_a_leading_dimension(self):
        sims = koboshi.Simulations(GO, seeds=[4, 5], stepper="lumped")
        runs = sims.record(100)
        self.assertEqual(runs.shape, (2, 10))
        self.assertEqual(runs[1].tobytes(), go(seed=5).record(100).tobytes())
        sims.reset(1, 9)
        sims.step(5)
        sims.reset(0, 9)
        with self.assertRaisesRegex(ValueError, "different times"):
            sims.record(100)


class Errors(unittest.TestCase):
    def test_are_those_of_the_command_line(self):
        with self.assertRaisesRegex(koboshi.InputError, r"nowhere\.yaml"):
            koboshi.Simulation("nowhere.yaml")
        with self.assertRaisesRegex(koboshi.InputError, "^set.*found"):
            go(set={"ground.friction": -1})
        with self.assertRaisesRegex(koboshi.InputError, "stepper.*expected"):
            koboshi.Simulation(GO, stepper="slow")
        sim = go()
        for call in (lambda: sim.command("wlk"), lambda: sim.command("walk", forwards=1), lambda: sim.push([1, 2], 0.1),
                     lambda: sim.push([1, 2, 3], 0.1, link="tail"), lambda: sim.write("step_time", 1)):
            with self.assertRaises(koboshi.InputError):
                call()
        self.assertTrue(issubclass(koboshi.InputError, ValueError))

    def test_an_input_error_always_has_a_text(self):
        with tempfile.TemporaryDirectory() as folder:
            scenario = pathlib.Path(folder, "scenario.yaml")
            robot = pathlib.Path(folder, "robot.sdf")
            pathlib.Path(folder, "meshes").symlink_to(ROOT / "robots/koboshi/meshes")
            scenario.write_text(f"version: 1\nrobot: {robot}\nduration_s: 1\n")
            good = (ROOT / "robots/koboshi/robot.sdf").read_bytes()
            delay = b"<delay_s>0.001"
            torque = good.index(delay, good.index(b"<koboshi:torque>"))
            for bad in (good.replace(b'name="koboshi"', b'name="k\xf6boshi"', 1),
                        good.replace(b'name="koboshi"', 'name="\u00e4\u6f22{}"'.format("\u6f22" * 60).encode(), 1),
                        good.replace(b'name="head_pan"', b'name="head_pan "', 1),
                        good[:torque] + b"<delay_s>0.002" + good[torque + len(delay):], b"", b"\xff"):
                robot.write_bytes(bad)
                with self.assertRaisesRegex(koboshi.InputError, r"robot\.sdf:\d+: found .+, expected .+"):
                    koboshi.Simulation(scenario)
        for arguments in ({"set": {"robot": "\u00e4" + "\u6f22" * 90}}, {"set": {"ground": {"shapes": [[[]]]}}}, {"seed": 2**64 - 1},
                          {"stepper": "w\u00f6rld"}, {"set": {"physics.step_ms": float("nan")}},
                          {"set": {"robot": "\U0001f916"}}):
            with self.subTest(arguments), self.assertRaisesRegex(koboshi.InputError, ".+: found .+, expected .+"):
                koboshi.Simulation(GO, **arguments)
        with self.assertRaisesRegex(koboshi.InputError, "found no seed"):
            koboshi.Simulations(GO, seeds=[])

    def test_a_refused_value_is_an_exception(self):
        sim = go(set={"commands": [{"at_s": 2, "enable": True}]})
        sim.step(3500)
        sim.write("mounting_roll_deg", 1)
        with self.assertRaisesRegex(koboshi.SdoFailed, "mounting_roll_deg"):
            sim.step(200)


class Simulations(unittest.TestCase):
    def test_have_the_world_as_first_dimension(self):
        sims = koboshi.Simulations(GO, range(3), threads=2, stepper="lumped")
        sims.step(100)
        self.assertEqual(len(sims), 3)
        state, truth = sims.state(), sims.truth()
        self.assertEqual(state.state.shape, (3,))
        self.assertEqual(truth.position_m.shape, (3, 3))
        self.assertEqual(truth.tilt_rad.shape, (3,))
        alone = go(seed=1)
        alone.step(100)
        np.testing.assert_array_equal(truth.link_position_m[1], alone.truth().link_position_m)
        self.assertEqual(state.zmp_m.shape, (3, 2))
        self.assertEqual(len(sims.verdicts), 3)
        self.assertEqual(sims.verdicts[1], alone.verdict)
        self.assertEqual(sims.events()[1], alone.events())
        self.assertEqual((sims.joint_names, sims.link_names), (alone.joint_names, alone.link_names))
        snapshots = sims.snapshot()
        sims.step(20)
        np.testing.assert_allclose(sims.time_s, [0.12] * 3)
        sims.restore(snapshots)
        np.testing.assert_allclose(sims.time_s, [0.1] * 3)
        with self.assertRaisesRegex(koboshi.InputError, "one for each simulation"):
            sims.restore(snapshots[:2])
        sims.push([0, 0, 5], 0.05, world=2)
        sims.step(50)
        alone.step(50)
        np.testing.assert_array_equal(sims.truth().link_position_m[1], alone.truth().link_position_m)


class Robot(unittest.TestCase):
    def test_stands_in_the_pose_that_it_is_told(self):
        robot = koboshi.Robot("joints", stepper="lumped")
        positions = robot.layout["joint_position_rad"]
        pose = robot.observation()[positions]
        for _ in range(200):
            observation = robot.step(pose)
        self.assertAlmostEqual(robot.time_s, 2.64)
        self.assertLess(robot.truth().tilt_rad, 0.1)
        self.assertLess(np.abs(observation[positions] - pose).max(), 0.05)
        self.assertEqual(robot.imu_samples().shape, (10, 6))
        self.assertEqual(robot.fault, "")
        self.assertTrue((robot.joint_limits_rad[:, 0] < robot.joint_limits_rad[:, 1]).all())
        self.assertEqual(max(part.stop for part in robot.layout.values()), len(observation))

    def test_snapshots_and_resets_repeat_the_bits(self):
        robot = koboshi.Robot(seed=5, stepper="lumped", world="rough")
        self.assertIn("friction", " ".join(robot.drawn))
        first = robot.observation()
        snapshot = robot.snapshot()
        after = robot.step(np.zeros(len(robot.joint_names)), 300)
        robot.restore(snapshot)
        np.testing.assert_array_equal(robot.observation(), first)
        np.testing.assert_array_equal(robot.step(np.zeros(len(robot.joint_names)), 300), after)
        np.testing.assert_array_equal(robot.reset(), first)
        with self.assertRaisesRegex(RuntimeError, "^found a snapshot of another robot, expected one that this robot has made$"):
            koboshi.Robot(seed=5, stepper="lumped", world="rough").restore(snapshot)
        self.assertTrue((robot.reset(6) != first).any())
        with self.assertRaisesRegex(RuntimeError, "^found a snapshot from before the last reset of this robot, expected one from after it$"):
            robot.restore(snapshot)

    def test_refuses_bad_actions(self):
        robot = koboshi.Robot(stepper="lumped")
        bad = np.zeros(len(robot.joint_names))
        bad[3] = np.inf
        for targets, text in ((bad, robot.joint_names[3]), (np.zeros(3), "shape"), (np.zeros((2, len(bad))), "shape")):
            with self.assertRaisesRegex(koboshi.InputError, text):
                robot.step(targets)
        with self.assertRaisesRegex(koboshi.InputError, "commands"):
            koboshi.Robot("go")

    def test_starts_no_more_threads_than_robots(self):
        before = len(os.listdir("/proc/self/task"))
        robots = koboshi.Robots("joints", seeds=[4, 8, 15], threads=1_000_000, stepper="lumped")
        self.assertLessEqual(len(os.listdir("/proc/self/task")), before + 2)
        self.assertEqual(len(robots), 3)

    def test_many_are_those_of_their_seeds(self):
        robots = koboshi.Robots("joints", seeds=[4, 8, 15], threads=2, stepper="lumped")
        joints = len(robots.joint_names)
        targets = np.full((3, joints), 0.1, dtype=np.float32)
        for _ in range(10):
            observations = robots.step(targets)
        alone = koboshi.Robot("joints", seed=8, stepper="lumped")
        for _ in range(10):
            observation = alone.step(targets[1])
        np.testing.assert_array_equal(observations[1], observation)
        self.assertEqual(robots.truth().position_m.shape, (3, 3))
        again = robots.reset(mask=[False, True, False], seeds=[0, 4, 0])
        np.testing.assert_array_equal(again[0], observations[0])
        robots.reset()
        np.testing.assert_array_equal(robots.observations()[0], robots.observations()[1])
        self.assertEqual(robots.faults, ["", "", ""])
        for bad in (np.zeros(joints), np.zeros((2, joints))):
            with self.assertRaisesRegex(koboshi.InputError, r"expected \(3, "):
                robots.step(bad)


class Threads(unittest.TestCase):
    def test_run_while_a_simulation_steps(self):
        sim = go()
        turned_away = []
        stepping = threading.Thread(target=lambda: sim.step(1500))
        stepping.start()
        counted = 0
        while stepping.is_alive():
            counted += 1
            try:
                sim.state()
            except RuntimeError as error:
                turned_away.append(str(error))
        stepping.join()
        self.assertGreater(counted, 1)
        self.assertTrue(turned_away and "another thread" in turned_away[0])
        self.assertEqual(sim.time_s, 1.5)


class Stubs(unittest.TestCase):
    def test_name_what_the_module_has(self):
        tree = ast.parse((MODULE_FOLDER / "koboshi.pyi").read_text())
        for node in (node for node in tree.body if isinstance(node, ast.ClassDef)):
            with self.subTest(node.name):
                actual = getattr(koboshi, node.name)
                if node.name in ("State", "Truth"):
                    self.assertEqual([item.target.id for item in node.body if isinstance(item, ast.AnnAssign)], list(actual._fields))
                elif node.name.startswith(("Simulation", "Robot")):
                    stub = {item.name for item in node.body if isinstance(item, ast.FunctionDef)} - {"__init__", "__len__"}
                    self.assertEqual(stub, {name for name in vars(actual) if not name.startswith("_")})
        self.assertRegex(koboshi.__version__, r"^\d+\.\d+\.\d+$")
        classes = {node.name for node in tree.body if isinstance(node, ast.ClassDef)}
        self.assertEqual(classes, {name for name in vars(koboshi) if not name.startswith("_")})

    def test_every_public_name_has_a_docstring(self):
        for owner in (koboshi.Simulation, koboshi.Simulations, koboshi.Robot, koboshi.Robots):
            for name in vars(owner):
                if not name.startswith("_"):
                    self.assertTrue(getattr(owner, name).__doc__, f"{owner.__name__}.{name}")
        for field in koboshi.State._fields:
            self.assertRegex(koboshi.State.__doc__, rf"(?m)^{field}: ")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
