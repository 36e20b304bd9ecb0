"""Streams joint targets through the firmware: the standing robot lifts an arm three times (docs/guide/python.md)."""

import koboshi
import numpy as np


def main():
    commands = [{"at_s": 1.5, "enable": True}]
    sim = koboshi.Simulation("go", seed=1, stepper="lumped", set={"commands": commands})
    sim.step(4500)  # boots, goes to the standing pose, and is released
    pose = sim.state().joint_target_rad
    targets = pose.copy()
    shoulder = sim.joint_names.index("left_shoulder_roll")
    sim.command("stream")
    for cycle in range(300):
        targets[shoulder] = pose[shoulder] + 0.5 * np.sin(2 * np.pi * cycle / 100) ** 2
        sim.stream(targets)
        sim.step(10)
    sim.command("stop")
    sim.step(1500)
    for time_s, text in sim.events()[-4:]:
        print(f"{time_s:6.2f} s  {text}")
    print(sim.verdict)


if __name__ == "__main__":
    main()
