"""Robots of 0.2 m and 0.5 kg and of 1.3 m and 30 kg pass the model check, stand and step on the spot with one firmware."""

import math
import pathlib
import re
import shutil
import tempfile
import unittest

import program as support

PROGRAM = None
ROBOT = support.ROOT / "robots" / "koboshi"
HEIGHT_M = 0.38
MASS_KG = 1.2


class Scale:
    """Factors of a robot that is similar to the default one and moves alike under the same gravity."""

    def __init__(self, height_m, mass_kg):
        self.length = height_m / HEIGHT_M
        self.mass = mass_kg / MASS_KG
        self.time = math.sqrt(self.length)
        self.torque = self.mass * self.length
        self.inertia = self.torque * self.length
        self.power = self.torque / self.time


def scaled_values(text, factor):
    return " ".join(f"{float(number) * factor:.9g}" for number in text.split())


def scaled_elements(text, names, factor):
    pattern = re.compile(rf"(<(?:{names})>)([^<]*)(</)")
    return pattern.sub(lambda match: match[1] + scaled_values(match[2], factor) + match[3], text)


def scaled_sensor(text, element, factor):
    """Scales range, resolution and errors of a channel."""
    return re.sub(rf"<{element}>.*?</{element}>",
                  lambda match: scaled_elements(match[0], "noise_density|bias|range|resolution", factor), text, flags=re.DOTALL)


def scaled_attribute(text, name, factor):
    return re.sub(rf'\b((?:{name})=")([^"]*)', lambda match: match[1] + scaled_values(match[2], factor), text)


def scaled_pose(text, factor):
    def pose(match):
        numbers = match[2].split()
        return match[1] + " ".join([scaled_values(" ".join(numbers[:3]), factor), *numbers[3:]])
    return re.sub(r"(<pose[^>]*>)([^<]*)", pose, text)


def scaled_robot(text, by):
    text = scaled_pose(text, by.length)
    text = scaled_elements(text, "size|scale", by.length)
    text = scaled_elements(text, "mass", by.mass)
    text = scaled_elements(text, "ixx|iyy|izz|ixy|ixz|iyz|rotor_inertia_kg_m2", by.inertia)
    text = scaled_elements(text, "coulomb_friction_Nm", by.torque)
    text = scaled_elements(text, "viscous_friction_Nm_s", by.torque * by.time)
    # The no-load speed is V / k, the stall torque k V / R.
    text = scaled_elements(text, "torque_constant_Nm_per_A", by.time)
    text = scaled_elements(text, "resistance_ohm", by.time / by.torque)
    text = scaled_elements(text, "velocity", 1 / by.time)
    text = scaled_attribute(text, "thermal_resistance_K_per_W|internal_resistance_ohm", 1 / by.power)
    text = scaled_attribute(text, "heat_capacity_J_per_K", by.power)
    text = scaled_elements(text, "soft_cfm", by.length / by.mass)
    text = scaled_sensor(text, "koboshi:force", by.mass)
    return scaled_sensor(text, "koboshi:torque", by.torque)


def factor_of_parameter(key, by):
    if key.startswith(("acceleration_forward", "acceleration_lateral")):
        return 1.0
    for end, factor in (("turn_mrad_per_s2", 1 / by.length), ("_mm_per_s", by.time), ("mrad_per_s", 1 / by.time),
                        ("deg_s_per_m", 1 / by.time), ("rad_per_m", 1 / by.length), ("deg_per_s", 1 / by.time), ("_mm", by.length),
                        ("step_time_ms", by.time), ("fall_lead_ms", by.time), ("_s", by.time)):
        if key.endswith(end):
            return factor
    return 1.0


def scaled_parameters(text, by):
    def line(match):
        key, value = match[1], float(match[2])
        number = value * factor_of_parameter(key, by)
        return f"  {key}: " + (f"{round(number)}" if key.endswith(("_ms", "mrad_per_s2", "mrad_per_s", "mm_per_s", "mm_per_s2"))
                               else f"{number:.4g}")
    return re.sub(r"^  ([a-z_0-9]+): (-?[0-9.]+)$", line, text, flags=re.MULTILINE)


class RobotSizes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_sizes_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def make(self, height_m, mass_kg):
        by = Scale(height_m, mass_kg)
        robot = self.folder / "robot"
        shutil.copytree(ROBOT, robot)
        for name, change in ("robot.sdf", scaled_robot), ("parameters.yaml", scaled_parameters), ("standing.yaml", scaled_parameters):
            file = robot / name
            file.write_text(change(file.read_text(), by))
        return robot

    def check(self, height_m, mass_kg):
        robot = self.make(height_m, mass_kg)
        checked = PROGRAM.run("model", "check", robot / "robot.sdf")
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertIn("no findings", checked.stdout)
        height_mm, = re.findall(r"([0-9.]+) mm high", checked.stdout)
        self.assertAlmostEqual(float(height_mm), 1e3 * height_m, delta=30 * height_m)
        kilograms, = re.findall(r"([0-9.]+) kg,", checked.stdout)
        self.assertAlmostEqual(float(kilograms), mass_kg, delta=0.02 * mass_kg)
        result = PROGRAM.run("run", "go", "--robot", robot / "robot.sdf", "--stepper", "lumped", "--record", "no", "--duration", "6",
                             "--out", self.folder / "run")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("Stands.", result.stdout)
        self.assertIn("walks; did not fall; 0 faults", result.stdout)

    def test_a_robot_of_200_mm_and_500_g_steps_on_the_spot(self):
        self.check(0.2, 0.5)

    def test_a_robot_of_1300_mm_and_30_kg_steps_on_the_spot(self):
        self.check(1.3, 30.0)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
