"""Koboshi: the firmware of a small humanoid robot on its simulated board.

Arrays are copies that belong to the caller: later steps do not change them.
"""

import os
from typing import Any, Iterable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

__version__: str

class InputError(ValueError):
    """Invalid file or value: file, line, what was found and what was expected."""

class WorldBlewUp(RuntimeError):
    """The physics state gained energy or is no longer finite."""

class SdoFailed(RuntimeError):
    """The controller rejected a value."""

class State(NamedTuple):
    """Telemetry of the firmware on the bus. In Simulations every field has a leading dimension: the simulation."""

    state: str
    reason: str
    time_s: float
    attitude_rad: NDArray[np.float64]  # roll, pitch of the trunk
    rate_rad_per_s: NDArray[np.float64]  # in the trunk's axes
    foot_load_N: NDArray[np.float64]  # left, right
    foot_zmp_m: NDArray[np.float64]  # (left, right) by (x, y), each in the frame of its sole
    zmp_m: NDArray[np.float64]  # x, y of both feet, in the frame of the sole with more load
    com_m: NDArray[np.float64]  # in the frame of the sole with more load
    dcm_m: NDArray[np.float64]  # x, y of the divergent component of motion, in the frame of the sole of dcm_side
    dcm_error_m: NDArray[np.float64]  # dcm_m less the plan of a walk for its moment; nan outside of a walk
    dcm_side: float  # 0: left, 1: right
    foot_touches: NDArray[np.float64]  # 1 while the left and the right foot bear load
    odometer: NDArray[np.float64]  # x, y of the trunk in m, its heading in rad, since power-on; ten times a second
    slope_rad: NDArray[np.float64]  # of the ground along the sole's axes, when the robot last stood still
    joint_target_rad: NDArray[np.float64]
    joint_position_rad: NDArray[np.float64]
    joint_torque_permille: NDArray[np.float64]

class Truth(NamedTuple):
    """Ground truth of the robot. In Simulations every field has a leading dimension: the simulation.

    Positions and vectors are in the world frame, z up.
    """

    time_s: float
    position_m: NDArray[np.float64]  # of the trunk's origin
    rpy_rad: NDArray[np.float64]  # of the trunk: Rz(yaw) Ry(pitch) Rx(roll)
    rate_rad_per_s: NDArray[np.float64]  # of the trunk
    tilt_rad: float  # of the trunk's z axis from the vertical
    com_m: NDArray[np.float64]
    zmp_m: NDArray[np.float64]
    zmp_margin_m: float  # distance from the edge of the support polygon, positive inside
    foot_load_N: NDArray[np.float64]  # left, right
    joint_position_rad: NDArray[np.float64]
    joint_speed_rad_per_s: NDArray[np.float64]
    joint_torque_Nm: NDArray[np.float64]
    link_position_m: NDArray[np.float64]  # link by (x, y, z)
    link_rotation: NDArray[np.float64]  # link by 3 by 3: from the link's frame to the world

class Snapshot:
    """Complete state of a Simulation at one instant, made by Simulation.snapshot()."""

    @property
    def time_s(self) -> float: ...

class Simulation:
    """Simulation of a scenario: the robot with its firmware and board."""

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        seed: int | None = None,
        stepper: str | None = None,
        robot: str | os.PathLike[str] | None = None,
        world: str | None = None,
        set: Mapping[str, Any] = {},
        frames: bool = False,
    ) -> None: ...
    def step(self, milliseconds: int = 10) -> None: ...
    def record(self, milliseconds: int) -> NDArray[np.void]: ...
    def reset(self, seed: int | None = None) -> None: ...
    def snapshot(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot) -> None: ...
    def command(self, verb: str, value: Any = None, **fields: Any) -> None: ...
    def stream(
        self,
        targets_rad: Sequence[float] | NDArray[np.float64],
        torque_limits_percent: Sequence[float] | NDArray[np.float64] | None = None,
    ) -> None: ...
    def push(
        self,
        force_N: Sequence[float] | NDArray[np.float64],
        duration_s: float,
        link: str | None = None,
        at_m: Sequence[float] | NDArray[np.float64] | None = None,
        shape: str = "rectangle",
    ) -> None: ...
    def write(self, parameter: str, value: float) -> None: ...
    def state(self) -> State: ...
    def truth(self) -> Truth: ...
    def frames(self) -> NDArray[np.void]: ...
    def events(self) -> list[tuple[float, str]]: ...
    @property
    def drawn(self) -> dict[str, str]: ...
    @property
    def verdict(self) -> str: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def time_s(self) -> float: ...
    @property
    def finished(self) -> bool: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def link_names(self) -> list[str]: ...

class Simulations:
    """Simulations of one scenario with different seeds, stepped in parallel."""

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        seeds: Iterable[int],
        *,
        threads: int | None = None,
        stepper: str | None = None,
        robot: str | os.PathLike[str] | None = None,
        world: str | None = None,
        set: Mapping[str, Any] = {},
    ) -> None: ...
    def __len__(self) -> int: ...
    def step(self, milliseconds: int = 10) -> None: ...
    def record(self, milliseconds: int) -> NDArray[np.void]: ...
    def reset(self, world: int, seed: int) -> None: ...
    def command(self, verb: str, value: Any = None, world: int | None = None, **fields: Any) -> None: ...
    def stream(
        self,
        targets_rad: Sequence[Any] | NDArray[np.float64],
        torque_limits_percent: Sequence[Any] | NDArray[np.float64] | None = None,
        world: int | None = None,
    ) -> None: ...
    def push(
        self,
        force_N: Sequence[float] | NDArray[np.float64],
        duration_s: float,
        world: int | None = None,
        link: str | None = None,
        at_m: Sequence[float] | NDArray[np.float64] | None = None,
        shape: str = "rectangle",
    ) -> None: ...
    def write(self, parameter: str, value: float, world: int | None = None) -> None: ...
    def state(self) -> State: ...
    def truth(self) -> Truth: ...
    def events(self) -> list[list[tuple[float, str]]]: ...
    def snapshot(self) -> list[Snapshot]: ...
    def restore(self, snapshots: Sequence[Snapshot]) -> None: ...
    @property
    def verdicts(self) -> list[str]: ...
    @property
    def time_s(self) -> NDArray[np.float64]: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def link_names(self) -> list[str]: ...

class RobotSnapshot:
    """Complete state of a Robot at one instant, made by Robot.snapshot()."""

    @property
    def time_s(self) -> float: ...

class Robot:
    """A robot that is controlled joint by joint, without the firmware's behaviour."""

    def __init__(
        self,
        scenario: str | os.PathLike[str] = "joints",
        *,
        seed: int | None = None,
        stepper: str | None = None,
        robot: str | os.PathLike[str] | None = None,
        world: str | None = None,
        set: Mapping[str, Any] = {},
    ) -> None: ...
    def step(
        self, targets_rad: Sequence[float] | NDArray[np.float64] | None = None, milliseconds: int = 10
    ) -> NDArray[np.float64]: ...
    def observation(self) -> NDArray[np.float64]: ...
    def reset(self, seed: int | None = None, *, until_s: float = 0.0) -> NDArray[np.float64]: ...
    def limit_torques(self, shares: Sequence[float] | NDArray[np.float64]) -> None: ...
    def enable(self, on: bool = True) -> None: ...
    def push(
        self,
        force_N: Sequence[float] | NDArray[np.float64],
        duration_s: float,
        link: str | None = None,
        at_m: Sequence[float] | NDArray[np.float64] | None = None,
        shape: str = "rectangle",
    ) -> None: ...
    def imu_samples(self) -> NDArray[np.float64]: ...
    def truth(self) -> Truth: ...
    def snapshot(self) -> RobotSnapshot: ...
    def restore(self, snapshot: RobotSnapshot) -> None: ...
    @property
    def release_s(self) -> float: ...
    @property
    def tilt_rad(self) -> float: ...
    @property
    def layout(self) -> dict[str, slice]: ...
    @property
    def joint_limits_rad(self) -> NDArray[np.float64]: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def link_names(self) -> list[str]: ...
    @property
    def fault(self) -> str: ...
    @property
    def drawn(self) -> dict[str, str]: ...
    @property
    def time_s(self) -> float: ...

class Robots:
    """Robots of one scenario with different seeds, stepped in parallel."""

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        seeds: Iterable[int],
        *,
        threads: int | None = None,
        stepper: str | None = None,
        robot: str | os.PathLike[str] | None = None,
        world: str | None = None,
        set: Mapping[str, Any] = {},
    ) -> None: ...
    def __len__(self) -> int: ...
    def step(
        self, targets_rad: NDArray[np.float64] | None = None, milliseconds: int = 10
    ) -> NDArray[np.float64]: ...
    def observations(self) -> NDArray[np.float64]: ...
    def reset(
        self,
        mask: Sequence[bool] | NDArray[np.bool_] | None = None,
        seeds: Iterable[int] | None = None,
        *,
        until_s: float = 0.0,
    ) -> NDArray[np.float64]: ...
    def push(
        self,
        force_N: Sequence[float] | NDArray[np.float64],
        duration_s: float,
        robot: int | None = None,
        link: str | None = None,
        at_m: Sequence[float] | NDArray[np.float64] | None = None,
        shape: str = "rectangle",
    ) -> None: ...
    def truth(self) -> Truth: ...
    @property
    def release_s(self) -> float: ...
    @property
    def tilt_rad(self) -> NDArray[np.float64]: ...
    @property
    def faults(self) -> list[str]: ...
    @property
    def layout(self) -> dict[str, slice]: ...
    @property
    def joint_limits_rad(self) -> NDArray[np.float64]: ...
    @property
    def joint_names(self) -> list[str]: ...
