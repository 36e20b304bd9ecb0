"""Compares what the firmware estimates while it walks with the truth: docs/experiment/estimation.md.

    python3 docs/experiment/estimation.py --seeds 100 --first-seed 7000 --world rough --speed 0.2
"""

import argparse

import numpy as np

import koboshi

GRAVITY = 9.80665
ANKLE_HEIGHT_M = 0.04  # of the default robot: from the foot's frame down to the sole
STAND_S = 5.0  # the robot has stood for 1.5 s
WALK_S = 6.0
END_S = 27.0


def simulate(arguments):
    """Returns time and a dictionary of arrays: cycle by robot by value."""
    walk = {
        "duration_s": 40,
        "commands.1.at_s": WALK_S - 0.1,
        "commands.2.at_s": WALK_S,
        "commands.2.walk": {"forward_m_per_s": arguments.speed},
        "commands.3.at_s": 100,
        "commands.4.at_s": 101,
        "parameters.highest_velocity_forward_mm_per_s": 1000,
    }
    seeds = range(arguments.first_seed, arguments.first_seed + arguments.seeds)
    robots = koboshi.Simulations("go", seeds, stepper=arguments.stepper, world=arguments.world, set=walk)
    feet = [robots.link_names.index(name) for name in ("left_foot", "right_foot")]
    robots.step(round(1e3 * STAND_S))
    cycles = []
    while robots.time_s[0] < END_S:
        robots.step(10)
        state, truth = robots.state(), robots.truth()
        cycles.append({
            "dcm": state.dcm_m, "side": state.dcm_side, "odometer": state.odometer, "slope": state.slope_rad,
            "touches": state.foot_touches, "com": truth.com_m, "trunk": truth.position_m, "yaw": truth.rpy_rad[:, 2],
            "load": truth.foot_load_N, "foot": truth.link_position_m[:, feet], "axes": truth.link_rotation[:, feet],
            "walks": np.array(state.state) == "walking",
        })
    time_s = STAND_S + 0.01 * np.arange(1, len(cycles) + 1)
    return time_s, {key: np.array([cycle[key] for cycle in cycles]) for key in cycles[0]}


def in_heading(vector, heading_rad):
    """Returns the vector in axes that are turned by the heading."""
    cosine, sine = np.cos(heading_rad), np.sin(heading_rad)
    return np.stack([cosine * vector[..., 0] + sine * vector[..., 1],
                     cosine * vector[..., 1] - sine * vector[..., 0]], axis=-1)


def true_dcm(values, robot):
    """Returns the DCM in the frame of the sole that the firmware refers to."""
    cycles = np.arange(len(values["side"]))
    side = values["side"][:, robot].astype(int)
    axes = values["axes"][cycles, robot, side]
    sole = values["foot"][cycles, robot, side] + axes @ np.array([0, 0, -ANKLE_HEIGHT_M])
    com = values["com"][:, robot]
    above = com - sole
    velocity = np.gradient(com, 0.01, axis=0)
    dcm = above + velocity * np.sqrt(above[:, 2:] / GRAVITY)
    return in_heading(dcm, np.arctan2(axes[:, 1, 0], axes[:, 0, 0]))


def figures(time_s, values, robot):
    """Returns the errors of one robot: mm, %, degrees."""
    walk = np.searchsorted(time_s, WALK_S + 2.0)
    start = np.searchsorted(time_s, WALK_S - 0.15)
    error = 1e3 * (values["dcm"][:, robot] - true_dcm(values, robot))[walk:]
    way = values["trunk"][-1, robot] - values["trunk"][start, robot]
    told = values["odometer"][-1, robot] - values["odometer"][start, robot]
    miss = in_heading(told, values["odometer"][start, robot, 2]) - in_heading(way, values["yaw"][start, robot])
    turned = np.unwrap(values["yaw"][:, robot])
    heading = np.degrees(np.remainder(told[2] - (turned[-1] - turned[start]) + np.pi, 2 * np.pi) - np.pi)
    up = values["axes"][start, robot, 0][2]  # against gravity, in the left foot's axes
    slope = np.degrees(values["slope"][start, robot] - np.arctan2(up[:2], up[2]))
    return {
        "DCM, RMS of x [mm]": np.sqrt(np.mean(error[:, 0] ** 2)),
        "DCM, RMS of y [mm]": np.sqrt(np.mean(error[:, 1] ** 2)),
        "DCM, standard deviation of x [mm]": error[:, 0].std(),
        "DCM, standard deviation of y [mm]": error[:, 1].std(),
        "odometry [% of the way]": 100 * np.linalg.norm(miss) / np.linalg.norm(way[:2]),
        "heading [deg]": abs(heading),
        "slope, larger axis [deg]": np.abs(slope).max(),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=7000)
    parser.add_argument("--world", default="rough")
    parser.add_argument("--stepper", default="mujoco")
    parser.add_argument("--speed", type=float, default=0.2, help="m/s forward")
    arguments = parser.parse_args()
    time_s, values = simulate(arguments)
    standing = [robot for robot in range(arguments.seeds) if values["walks"][-1, robot]]
    print(f"{len(standing)} of {arguments.seeds} walk at the end")
    rows = [figures(time_s, values, robot) for robot in standing]
    for name in rows[0]:
        column = np.array([row[name] for row in rows])
        print(f"{name:36} median {np.median(column):6.2f}  95 of 100 {np.percentile(column, 95):6.2f}"
              f"  largest {column.max():6.2f}")


if __name__ == "__main__":
    main()
