"""Koboshi: the firmware of a small humanoid robot on its simulated board.

Arrays are copies that belong to the caller: later steps do not change them.
"""

import os
from typing import Any, Iterable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

class InputError(ValueError):
    """A file or a value is not as it should be: file, line, what was found and what was expected."""

class WorldBlewUp(RuntimeError):
    """The physics gained energy or is no longer finite."""

class SdoFailed(RuntimeError):
    """The controller did not take a value."""

class State(NamedTuple):
    """Telemetry of the firmware on the bus. In Simulations the first dimension of every field is the world."""

    state: str
    reason: str
    time_s: float
    attitude_rad: NDArray[np.float64]
    rate_rad_per_s: NDArray[np.float64]
    foot_load_N: NDArray[np.float64]
    foot_zmp_m: NDArray[np.float64]
    com_m: NDArray[np.float64]
    joint_target_rad: NDArray[np.float64]
    joint_position_rad: NDArray[np.float64]
    joint_torque_permille: NDArray[np.float64]

class Truth(NamedTuple):
    """Ground truth of the robot in the world. In Simulations the first dimension of every field is the world."""

    time_s: float
    position_m: NDArray[np.float64]
    rpy_rad: NDArray[np.float64]
    rate_rad_per_s: NDArray[np.float64]
    tilt_rad: float
    com_m: NDArray[np.float64]
    zmp_m: NDArray[np.float64]
    zmp_margin_m: float
    foot_load_N: NDArray[np.float64]
    joint_position_rad: NDArray[np.float64]
    joint_speed_rad_per_s: NDArray[np.float64]
    joint_torque_Nm: NDArray[np.float64]
    link_position_m: NDArray[np.float64]
    link_rotation: NDArray[np.float64]

class Snapshot:
    """The state of a Simulation at one instant (Simulation.snapshot)."""

    @property
    def time_s(self) -> float: ...

class Simulation:
    """A robot with its firmware and board in a scenario."""

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        *,
        seed: int | None = None,
        stepper: str | None = None,
        set: Mapping[str, Any] = {},
        frames: bool = False,
    ) -> None: ...
    def step(self, milliseconds: int = 10) -> None: ...
    def reset(self, seed: int | None = None) -> None: ...
    def snapshot(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot) -> None: ...
    def command(self, verb: str, value: Any = None, **fields: float) -> None: ...
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
    """Simulations of one scenario with different seeds, stepped together on several threads."""

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        seeds: Iterable[int],
        *,
        threads: int | None = None,
        stepper: str | None = None,
        set: Mapping[str, Any] = {},
    ) -> None: ...
    def __len__(self) -> int: ...
    def step(self, milliseconds: int = 10) -> None: ...
    def reset(self, world: int, seed: int) -> None: ...
    def command(self, verb: str, value: Any = None, world: int | None = None, **fields: float) -> None: ...
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
