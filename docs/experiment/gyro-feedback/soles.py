"""Measures how flat the soles lie on the floor while they bear load in the walk of scenarios/walk.yaml."""

import re

import koboshi
import numpy as np

WALKS_FROM_MS = 5000
WALKS_UNTIL_MS = 20000
LEAST_LOAD_N = 1.0


def sole_corners(robot, foot):
    """Returns the four lower corners of a foot's collision box in the link's frame [m]."""
    link = re.search(rf'<link name="{foot}">.*?</link>', robot, re.DOTALL).group()
    box = re.search(r"<collision.*?<pose>(.*?)</pose>.*?<size>(.*?)</size>", link, re.DOTALL)
    centre = np.array(box.group(1).split()[:3], dtype=float)
    size = np.array(box.group(2).split(), dtype=float)
    return np.array([centre + size / 2 * (x, y, -1) for x in (-1, 1) for y in (-1, 1)])


def main():
    with open("robots/koboshi/robot.sdf", encoding="utf-8") as file:
        robot = file.read()
    feet = ("left_foot", "right_foot")
    corners = [sole_corners(robot, foot) for foot in feet]
    for stepper in ("lumped", "mujoco"):
        sim = koboshi.Simulation("scenarios/walk.yaml", stepper=stepper, seed=1)
        links = [sim.link_names.index(foot) for foot in feet]
        sim.step(WALKS_FROM_MS)
        spread_mm = []
        for _ in range(WALKS_UNTIL_MS - WALKS_FROM_MS):
            sim.step(1)
            truth = sim.truth()
            for side, link in enumerate(links):
                if truth.foot_load_N[side] < LEAST_LOAD_N:
                    continue
                height = (truth.link_position_m[link] + corners[side] @ truth.link_rotation[link].T)[:, 2]
                spread_mm.append(1e3 * np.ptp(height))
        spread_mm = np.array(spread_mm)
        print(f"{stepper}: corners of a loaded sole within 1 mm of each other for {np.mean(spread_mm < 1):.1%}"
              f" of the time, within 2 mm for {np.mean(spread_mm < 2):.1%}")


if __name__ == "__main__":
    main()
