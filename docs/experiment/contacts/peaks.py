#!/usr/bin/env python3
"""Largest joint torque of the default walk at several steps, and the torque below which 99.9 % of the samples are."""

import koboshi
import numpy as np

WALKS_FROM_MS = 4000
WALKS_UNTIL_MS = 20000


def main():
    print("| stepper | step [ms] | largest torque [N m] | 99.9 % of the samples below [N m] | distance [m] |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for stepper in ("lumped", "world", "mujoco"):
        for step_ms in (1, 0.5, 0.25, 0.125):
            sim = koboshi.Simulation("scenarios/walk.yaml", stepper=stepper, set={"physics.step_ms": step_ms})
            sim.step(WALKS_FROM_MS)
            torques_Nm = np.empty((WALKS_UNTIL_MS - WALKS_FROM_MS, len(sim.joint_names)))
            for row in torques_Nm:
                sim.step(1)
                row[:] = sim.truth().joint_torque_Nm
            print(
                f"| `{stepper}` | {step_ms} | {np.abs(torques_Nm).max():.1f} "
                f"| {np.quantile(np.abs(torques_Nm), 0.999):.2f} | {sim.truth().position_m[0]:.3f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
