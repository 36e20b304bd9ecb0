"""koboshi_env: the rules that Gymnasium's checker applies, without it; rewards, ends of episodes, and repeatability."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(sys.argv[1])))

import koboshi_env  # noqa: E402
import numpy as np  # noqa: E402


def short(**arguments):
    return koboshi_env.BalanceEnv(episode_s=0.5, **arguments)


class Balance(unittest.TestCase):
    def test_follows_the_rules_of_the_interface(self):
        env = short()
        first, info = env.reset(seed=3)
        self.assertEqual(info, {})
        self.assertIn(first, env.observation_space)
        self.assertEqual(first.dtype, np.float32)
        with self.subTest("the same seed begins with the same observation, and no seed with another"):
            np.testing.assert_array_equal(env.reset(seed=3)[0], first)
            self.assertTrue((env.reset()[0] != first).any())
        env.action_space.seed(1)
        action = env.action_space.sample()
        self.assertIn(action, env.action_space)
        observation, reward, terminated, truncated, info = env.step(action)
        self.assertIn(observation, env.observation_space)
        self.assertIs(type(reward), float)
        self.assertIs(type(terminated), bool)
        self.assertIs(type(truncated), bool)
        self.assertIsInstance(info, dict)
        self.assertIsNone(env.render())
        env.close()

    def test_repeats_an_episode_by_its_seed(self):
        env = short(world="rough", push_every_s=0.1)
        action = np.zeros(env.action_space.shape, np.float32)
        episodes = []
        for _ in range(2):
            env.reset(seed=11)
            episodes.append([env.step(action)[0] for _ in range(30)])
        np.testing.assert_array_equal(*episodes)

    def test_ends_after_its_time_and_wants_a_reset(self):
        env = short()
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(np.zeros(env.action_space.shape))
        env.reset(seed=1)
        ends = [env.step(np.zeros(env.action_space.shape))[2:4] for _ in range(50)]
        self.assertEqual(ends, [(False, False)] * 49 + [(False, True)])
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(np.zeros(env.action_space.shape))

    def test_ends_when_the_robot_is_lost(self):
        env = koboshi_env.BalanceEnv(push_N_s=0.0)
        env.reset(seed=1)
        action = np.zeros(env.action_space.shape)
        action[[env.robot.joint_names.index(f"{side}_ankle_pitch") for side in ("left", "right")]] = 1.0
        for _ in range(300):
            _, reward, terminated, truncated, info = env.step(action)
            if terminated:
                break
        self.assertTrue(terminated)
        self.assertEqual(reward, 0.0)
        self.assertGreater(info["tilt_rad"], 0.7)

    def test_refuses_actions_of_another_shape(self):
        env = short()
        env.reset(seed=1)
        with self.assertRaisesRegex(ValueError, "shape"):
            env.step(np.zeros(3))
        with self.assertRaisesRegex(ValueError, "render_mode"):
            short(render_mode="human")

    def test_refuses_numbers_that_no_episode_has(self):
        for milliseconds in (7, 0, -10, 15, 10.5, 10_010, float("nan"), float("inf"), np.int64(3)):
            text = f"found milliseconds={milliseconds}, expected a multiple of 10 from 10 to 10000"
            for make in (short, lambda **arguments: koboshi_env.BalanceVectorEnv(2, **arguments)):
                with self.subTest(text), self.assertRaises(ValueError) as raised:
                    make(milliseconds=milliseconds)
                self.assertEqual(str(raised.exception), text)
        for name in ("episode_s", "push_every_s", "lost_rad"):
            for value in (0, -1.0, float("nan"), float("inf")):
                with self.subTest(name), self.assertRaisesRegex(ValueError, f"^found {name}={value}, expected a number above 0$"):
                    koboshi_env.BalanceEnv(**{name: value})
        for name in ("action_rad", "push_N_s"):
            with self.subTest(name), self.assertRaisesRegex(ValueError, f"^found {name}=-1, expected a number of 0 or more$"):
                koboshi_env.BalanceEnv(**{name: -1})

    def test_takes_steps_of_numpy_integers(self):
        env = koboshi_env.BalanceEnv(milliseconds=np.int64(20), episode_s=0.1)
        env.reset(seed=1)
        ends = [env.step(np.zeros(env.action_space.shape))[3] for _ in range(5)]
        self.assertEqual(ends, [False] * 4 + [True])


class Vector(unittest.TestCase):
    def test_steps_robots_as_the_single_environment_does(self):
        env = koboshi_env.BalanceVectorEnv(3, episode_s=0.2, push_N_s=0.0, threads=2)
        observations, _ = env.reset(seed=5)
        self.assertIn(observations, env.observation_space)
        self.assertTrue((observations[0] != observations[1]).any())
        actions = np.zeros(env.action_space.shape, np.float32)
        for step in range(20):
            observations, rewards, terminated, truncated, _ = env.step(actions)
            self.assertEqual((rewards.shape, terminated.shape), ((3,), (3,)))
            self.assertTrue((rewards > 0.5).all())
            self.assertEqual(list(truncated), [step == 19] * 3)
        with self.subTest("the next step begins new episodes, in other worlds"):
            observations, rewards, terminated, truncated, _ = env.step(actions)
            self.assertEqual(list(rewards), [0.0] * 3)
            self.assertFalse(truncated.any() or terminated.any())
            self.assertFalse(env.step(actions)[3].any())
        again = koboshi_env.BalanceVectorEnv(3, episode_s=0.2, push_N_s=0.0, threads=1)
        np.testing.assert_array_equal(env.reset(seed=9)[0], again.reset(seed=9)[0])
        np.testing.assert_array_equal(env.step(actions)[0], again.step(actions)[0])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
