#!/usr/bin/env python3
"""A controller of your own: holds the robot upright by its ankles, with rates from the gyro, joint by joint."""

import argparse

import koboshi
import numpy as np

CYCLE_S = 0.01
TILT_GAIN = 0.3  # rad at the ankle for each radian of tilt
RATE_GAIN_S = 0.12  # rad at the ankle for each rad/s; by hand, with seeds 1 to 5
FILTER_S = 1.0  # the accelerometer corrects the tilt with this time constant


class Balance:
    """A PD controller of the trunk's tilt, which it estimates by a complementary filter."""

    def __init__(self, robot):
        self.layout = robot.layout
        self.pose = robot.observation()[self.layout["joint_position_rad"]].copy()
        self.pitch = [robot.joint_names.index(f"{side}_ankle_pitch") for side in ("left", "right")]
        self.tilt = None

    def targets(self, observation):
        rate = observation[self.layout["gyro_rad_per_s"]][1]
        force = observation[self.layout["accelerometer_m_per_s2"]]
        felt = np.arctan2(-force[0], force[2])
        self.tilt = felt if self.tilt is None else self.tilt + CYCLE_S * (rate + (felt - self.tilt) / FILTER_S)
        targets = self.pose.copy()
        targets[self.pitch] += TILT_GAIN * self.tilt + RATE_GAIN_S * rate
        return targets


def strongest_push(robot, controlled, forces_N):
    """The strongest of these pushes from behind, of 0.1 s each, after which the robot still stands."""
    balance = Balance(robot)
    for _ in range(250):  # the stand releases the robot at 1 s
        observation = robot.step(balance.targets(robot.observation()) if controlled else balance.pose)
    standing, tilt, survived_N = robot.snapshot(), balance.tilt, 0.0
    for force_N in forces_N:
        robot.restore(standing)
        balance.tilt = tilt
        robot.push([force_N, 0, 0], 0.1, shape="half-sine")
        for _ in range(300):
            observation = robot.step(balance.targets(observation) if controlled else balance.pose)
        if robot.truth().tilt_rad > 0.5:
            break
        survived_N = force_N
    return survived_N


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--forces-N", type=float, nargs="+", default=list(np.arange(3, 16, 0.5)))
    arguments = parser.parse_args()
    for seed in range(1, arguments.seeds + 1):
        pushes = [strongest_push(koboshi.Robot("joints", seed=seed, stepper="lumped"), controlled, arguments.forces_N)
                  for controlled in (False, True)]
        print(f"seed {seed}: pose held by the servos alone survives {pushes[0]:g} N, with the controller {pushes[1]:g} N")


if __name__ == "__main__":
    main()
