#!/usr/bin/env python3
"""Walks the robot to points on the floor by a loop of its own around the firmware's controller."""

import argparse

import koboshi
import numpy as np

CYCLE_MS = 100
CLOSE_ENOUGH_M = 0.05
FORWARD_M_PER_S = 0.15
TURN_PER_S = 1.5  # rad/s for each radian that the robot does not head for the point
MAX_TURN_RAD_PER_S = 0.6
PATIENCE_S = 60.0


def velocity_towards(point_m, truth):
    """Forward speed and turn that lead to the point: a robot that faces away turns on the spot first."""
    way = point_m - truth.position_m[:2]
    error = np.arctan2(way[1], way[0]) - truth.rpy_rad[2]
    error = (error + np.pi) % (2 * np.pi) - np.pi
    turn = float(np.clip(TURN_PER_S * error, -MAX_TURN_RAD_PER_S, MAX_TURN_RAD_PER_S))
    return FORWARD_M_PER_S * max(0.0, float(np.cos(error))), turn


def go_to(sim, point_m):
    """Walks there. False if the robot does not come close enough in time."""
    end_s = sim.time_s + PATIENCE_S
    while sim.time_s < end_s:
        truth = sim.truth()
        if np.linalg.norm(point_m - truth.position_m[:2]) < CLOSE_ENOUGH_M:
            return True
        forward, turn = velocity_towards(point_m, truth)
        sim.command("walk", forward_m_per_s=forward, turn_rad_per_s=turn)
        sim.step(CYCLE_MS)
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=float, nargs="+", default=[0.4, 0, 0.4, 0.4, 0, 0.4, 0, 0], help="x y of each [m]")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    # The scenario without its own walk: the robot is let go of at 3.5 s and stands.
    sim = koboshi.Simulation("scenarios/go.yaml", seed=arguments.seed, stepper="lumped", set={"commands": [{"at_s": 2, "enable": True}]})
    sim.step(4500)
    for point_m in np.reshape(arguments.points, (-1, 2)):
        there = go_to(sim, point_m)
        print(f"{sim.time_s:6.1f} s  {'at' if there else 'not at'} {point_m}: {sim.truth().position_m[:2].round(3)}")
    sim.command("stop")
    sim.step(3000)
    print(sim.verdict)


if __name__ == "__main__":
    main()
