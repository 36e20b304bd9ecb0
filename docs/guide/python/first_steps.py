#!/usr/bin/env python3
"""A robot in a script: steps, a push, commands, frames and the verdict."""

import koboshi

sim = koboshi.Simulation("scenarios/go.yaml", seed=1, stepper="lumped", frames=True)
sim.step(5000)  # milliseconds
print(sim.state().state, sim.truth().position_m)

sim.push([0, 5, 0], duration_s=0.1, shape="half-sine")  # N, in the axes of the world
sim.command("walk", forward_m_per_s=0.1, turn_rad_per_s=0.2)
sim.write("step_height_mm", 25)
sim.step(3000)
for frame in sim.frames()[:3]:
    print(f"{frame['time_us']:9d} us  {frame['identifier']:03X}  {bytes(frame['data'][:frame['size']]).hex(' ')}")
print(sim.verdict)

walking = sim.snapshot()
for force_N in (5, 10, 20):
    sim.restore(walking)
    sim.push([0, force_N, 0], duration_s=0.1)
    sim.step(1000)
    print(f"{force_N} N: {sim.verdict}")
