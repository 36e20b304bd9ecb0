"""Environments for reinforcement learning: a robot that is controlled joint by joint and should stay upright.

    env = koboshi_env.BalanceEnv(world="rough")
    observation, info = env.reset(seed=1)
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())

`BalanceVectorEnv` steps many robots on all cores, with arrays by robot. Both have Gymnasium's interface and are
subclasses of its classes where Gymnasium is installed; without it they bring the few things of it that they need.
"""

import koboshi
import numpy as np

try:
    import gymnasium
    from gymnasium.spaces import Box
    from gymnasium.vector import AutoresetMode

    _Env, _VectorEnv = gymnasium.Env, gymnasium.vector.VectorEnv
    _NEXT_STEP = AutoresetMode.NEXT_STEP
except ImportError:
    _Env = _VectorEnv = object
    _NEXT_STEP = "NextStep"

    class Box:
        """The part of gymnasium.spaces.Box that these environments use: a box of float32 numbers."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
            shape = np.shape(low) if shape is None else tuple(shape)
            self.low = np.full(shape, low, dtype)
            self.high = np.full(shape, high, dtype)
            self.shape, self.dtype = shape, np.dtype(dtype)
            self.seed(seed)

        def seed(self, seed=None):
            self._random = np.random.default_rng(seed)

        def sample(self):
            bounded = np.isfinite(self.low) & np.isfinite(self.high)
            numbers = self._random.normal(size=self.shape)
            low, high = np.where(bounded, self.low, 0), np.where(bounded, self.high, 1)
            return np.where(bounded, self._random.uniform(low, high), numbers).astype(self.dtype)

        def contains(self, x):
            x = np.asarray(x)
            return bool(np.can_cast(x.dtype, self.dtype) and x.shape == self.shape and (x >= self.low).all() and (x <= self.high).all())

        def __contains__(self, x):
            return self.contains(x)


_MAX_SEED = 2**31
_CONTROL_PERIOD_MS = 10
_LONGEST_STEP_MS = 10_000


def _step_ms(milliseconds):
    """The argument as an integer: the drives take a target each 10 ms, so that a step is a multiple of that."""
    if milliseconds != milliseconds // 1 or not 0 < milliseconds <= _LONGEST_STEP_MS or milliseconds % _CONTROL_PERIOD_MS:
        raise ValueError(f"found milliseconds={milliseconds}, expected a multiple of {_CONTROL_PERIOD_MS} "
                         f"from {_CONTROL_PERIOD_MS} to {_LONGEST_STEP_MS}")
    return int(milliseconds)


def _check_number(name, value, may_be_zero):
    if not (0 <= value < float("inf")) or (value == 0 and not may_be_zero):
        raise ValueError(f"found {name}={value}, expected a number {'of 0 or more' if may_be_zero else 'above 0'}")


class _Balance:
    """What both environments share: the actions, the observations and the reward, for arrays by robot."""

    metadata = {"render_modes": [], "autoreset_mode": _NEXT_STEP}

    def __init__(self, robot, action_rad, milliseconds, episode_s, push_N_s, push_every_s, lost_rad):
        self.milliseconds = _step_ms(milliseconds)
        for name, value in (("episode_s", episode_s), ("push_every_s", push_every_s), ("lost_rad", lost_rad)):
            _check_number(name, value, False)
        for name, value in (("action_rad", action_rad), ("push_N_s", push_N_s)):
            _check_number(name, value, True)
        self.layout = robot.layout
        self.limits = robot.joint_limits_rad
        self.episode_steps = max(1, round(1000 * episode_s / milliseconds))
        self.action_rad, self.push_N_s, self.lost_rad = action_rad, push_N_s, lost_rad
        self.push_steps = max(1, round(1000 * push_every_s / milliseconds))
        self.joints = len(robot.joint_names)
        self.size = max(part.stop for part in self.layout.values()) + self.joints

    def spaces(self, number=None):
        """The spaces of observations and actions, of this number of robots or of one."""
        lead = () if number is None else (number,)
        return (Box(-np.inf, np.inf, (*lead, self.size), np.float32), Box(-1.0, 1.0, (*lead, self.joints), np.float32))

    def targets(self, pose, action):
        action = np.clip(np.asarray(action, np.float64), -1.0, 1.0)
        return np.clip(pose + self.action_rad * action, self.limits[:, 0], self.limits[:, 1])

    def observation(self, measured, pose, targets):
        """Measurements, with positions relative to the pose, and the targets relative to it."""
        measured = measured.copy()
        measured[..., self.layout["joint_position_rad"]] -= pose
        return np.concatenate([measured, targets - pose], axis=-1).astype(np.float32)

    def reward(self, tilt_rad, targets, before, lost):
        """1 for each step upright, less for a tilt and for haste: the square of the change of the targets, in rad."""
        haste = np.square(targets - before).sum(axis=-1)
        return np.where(lost, 0.0, 1.0 - np.minimum(1.0, np.abs(tilt_rad) / self.lost_rad) - np.minimum(1.0, 0.5 * haste))


class BalanceEnv(_Env):
    """A robot that should stand upright while it is pushed.

    The action of each joint, -1 to 1, moves its target by up to `action_rad` about the pose in which the robot was
    released. An observation is that of koboshi.Robot, with the positions and the targets relative to this pose. Each
    `push_every_s` a push of 0.1 s from any side follows, whose momentum is up to `push_N_s`. An episode ends when the
    trunk leans by more than `lost_rad` or a drive fails (terminated), or after `episode_s` (truncated).

    scenario, stepper, robot, world, set: arguments of koboshi.Robot.
    milliseconds: simulated time of a step, a multiple of 10 from 10 to 10,000.
    """

    metadata = _Balance.metadata

    def __init__(self, scenario="joints", *, stepper="lumped", robot=None, world=None, set=None, milliseconds=10, episode_s=10.0,
                 action_rad=0.3, push_N_s=0.5, push_every_s=2.0, lost_rad=0.7, render_mode=None):
        if render_mode is not None:
            raise ValueError(f"found render_mode={render_mode!r}, expected None: koboshi replay shows recorded runs")
        self.render_mode = None
        self.robot = koboshi.Robot(scenario, seed=0, stepper=stepper, robot=robot, world=world, set=set or {})
        self.balance = _Balance(self.robot, action_rad, milliseconds, episode_s, push_N_s, push_every_s, lost_rad)
        self.observation_space, self.action_space = self.balance.spaces()
        self._random = np.random.default_rng()
        self._ready = False

    def reset(self, *, seed=None, options=None):
        """Begins an episode in a world of the seed; without one, in the next of the sequence that the last seed began."""
        if _Env is not object:
            super().reset(seed=seed)
        if seed is not None:
            self._random = np.random.default_rng(seed)
        measured = self.robot.reset(int(self._random.integers(_MAX_SEED)), until_s=self.robot.release_s)
        self.pose = measured[self.balance.layout["joint_position_rad"]].copy()
        self.steps, self.last, self._ready = 0, self.pose.copy(), True
        return self.balance.observation(measured, self.pose, self.last), {}

    def step(self, action):
        if not self._ready:
            raise RuntimeError("found step() at the end of an episode, expected reset() before it")
        if np.shape(action) != self.action_space.shape:
            raise ValueError(f"found an action of shape {np.shape(action)}, expected {self.action_space.shape}")
        if self.steps % self.balance.push_steps == self.balance.push_steps - 1:
            _push(self.robot, self.balance, self._random)
        targets = self.balance.targets(self.pose, action)
        measured = self.robot.step(targets, self.balance.milliseconds)
        self.steps += 1
        tilt_rad = self.robot.tilt_rad
        terminated = bool(tilt_rad > self.balance.lost_rad or self.robot.fault)
        truncated = self.steps >= self.balance.episode_steps
        reward = float(self.balance.reward(tilt_rad, targets, self.last, terminated))
        self.last, self._ready = targets, not (terminated or truncated)
        return self.balance.observation(measured, self.pose, targets), reward, terminated, truncated, {"tilt_rad": tilt_rad}

    def render(self):
        return None

    def close(self):
        self._ready = False


class BalanceVectorEnv(_VectorEnv):
    """Many robots as in BalanceEnv, stepped in parallel. All arrays have the robot as their first dimension.

    A robot whose episode has ended begins the next one in the following step, which ignores its action and has the
    reward 0 (Gymnasium's autoreset mode "next step").

    num_envs: number of robots.
    threads:  number of threads; default: one per core.
    Other arguments are those of BalanceEnv.
    """

    metadata = _Balance.metadata

    def __init__(self, num_envs, scenario="joints", *, threads=None, stepper="lumped", robot=None, world=None, set=None,
                 milliseconds=10, episode_s=10.0, action_rad=0.3, push_N_s=0.5, push_every_s=2.0, lost_rad=0.7):
        self.num_envs, self.render_mode = num_envs, None
        self.robots = koboshi.Robots(scenario, seeds=range(num_envs), threads=threads, stepper=stepper, robot=robot, world=world, set=set or {})
        self.balance = _Balance(self.robots, action_rad, milliseconds, episode_s, push_N_s, push_every_s, lost_rad)
        self.single_observation_space, self.single_action_space = self.balance.spaces()
        self.observation_space, self.action_space = self.balance.spaces(num_envs)
        self._random = np.random.default_rng()
        self._done = np.zeros(num_envs, bool)
        self._ready = False

    def reset(self, *, seed=None, options=None):
        """Begins an episode of every robot; the seed determines the worlds of all that follow."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        self.pose = np.zeros((self.num_envs, self.balance.joints))
        self.last = np.zeros_like(self.pose)
        self.steps = np.zeros(self.num_envs, int)
        measured = self._begin(np.ones(self.num_envs, bool))
        self._done[:], self._ready = False, True
        return self.balance.observation(measured, self.pose, self.last), {}

    def _begin(self, mask):
        """Restarts these robots and lets the stand release them; the others stay as they are."""
        seeds = [int(seed) for seed in self._random.integers(_MAX_SEED, size=self.num_envs)]
        measured = self.robots.reset(mask, seeds, until_s=self.robots.release_s)
        self.pose[mask] = measured[mask][:, self.balance.layout["joint_position_rad"]]
        self.last[mask], self.steps[mask] = self.pose[mask], 0
        return measured

    def step(self, actions):
        if not self._ready:
            raise RuntimeError("found step() without an episode, expected reset() before it")
        if np.shape(actions) != self.action_space.shape:
            raise ValueError(f"found actions of shape {np.shape(actions)}, expected {self.action_space.shape}")
        begins = self._done.copy()
        for robot in np.flatnonzero(~begins & (self.steps % self.balance.push_steps == self.balance.push_steps - 1)):
            _push(self.robots, self.balance, self._random, int(robot))
        if begins.any():
            self._begin(begins)
        targets = np.where(begins[:, None], self.pose, self.balance.targets(self.pose, actions))
        measured = self.robots.step(targets, self.balance.milliseconds)
        self.steps += ~begins
        tilt_rad = self.robots.tilt_rad
        faulty = np.array([bool(fault) for fault in self.robots.faults])
        terminated = ~begins & ((tilt_rad > self.balance.lost_rad) | faulty)
        truncated = ~begins & (self.steps >= self.balance.episode_steps)
        reward = np.where(begins, 0.0, self.balance.reward(tilt_rad, targets, self.last, terminated))
        self.last, self._done = targets, terminated | truncated
        return self.balance.observation(measured, self.pose, targets), reward, terminated, truncated, {"tilt_rad": tilt_rad}

    def render(self):
        return None

    def close(self, **kwargs):
        self._ready = False


def _push(robot, balance, random, number=None):
    angle, momentum_N_s = random.uniform(0, 2 * np.pi), random.uniform(0, balance.push_N_s)
    force_N = momentum_N_s / 0.1 * np.array([np.cos(angle), np.sin(angle), 0.0])
    arguments = {} if number is None else {"robot": number}
    robot.push(force_N, 0.1, **arguments)
