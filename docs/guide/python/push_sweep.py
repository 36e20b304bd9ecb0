#!/usr/bin/env python3
"""Pushes a standing robot from all sides, harder and harder, and draws what it bears."""

import argparse

import koboshi
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DURATION_S = 0.1


def fell(sims):
    """Which of the robots lean by more than 60 degrees, or do not stand."""
    return (sims.truth().tilt_rad > np.radians(60)) | (sims.state().state != "standing")


def strongest_survived(directions_rad, forces_N, seeds, stepper):
    """For each direction the force [N] up to which every seed stayed on its feet."""
    survived = np.zeros(len(directions_rad))
    for i, direction in enumerate(directions_rad):
        axis = np.array([np.cos(direction), np.sin(direction), 0.0])
        for force_N in forces_N:
            sims = koboshi.Simulations("scenarios/go.yaml", seeds, stepper=stepper, set={"commands": [{"at_s": 2, "enable": True}]})
            sims.step(4500)  # it is let go of at 3.5 s
            sims.push(force_N * axis, DURATION_S, shape="half-sine")
            sims.step(2000)
            if fell(sims).any():
                break
            survived[i] = force_N
    return survived


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--directions", type=int, default=8)
    parser.add_argument("--forces-N", type=float, nargs="+", default=[4, 6, 7, 8, 9, 10, 11, 12])
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--stepper", default="lumped")
    parser.add_argument("--out", default="push_sweep.png")
    arguments = parser.parse_args()

    directions_rad = np.linspace(0, 2 * np.pi, arguments.directions, endpoint=False)
    survived_N = strongest_survived(directions_rad, arguments.forces_N, range(1, arguments.seeds + 1), arguments.stepper)
    print("force survived, N:", survived_N)

    axes = plt.subplot(projection="polar")
    axes.set_theta_zero_location("N")  # forward is up, left is left
    axes.plot(np.append(directions_rad, directions_rad[0]), np.append(survived_N, survived_N[0]), marker="o")
    axes.set_title(f"Peak of a half sine of {DURATION_S} s that {arguments.seeds} robots survive [N]")
    plt.savefig(arguments.out, dpi=120, bbox_inches="tight")


if __name__ == "__main__":
    main()
