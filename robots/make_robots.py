#!/usr/bin/python3
"""Writes robot.sdf of the robots that are made up for this project, beside Koboshi: robots/NAME/robot.sdf.

    robots/make_robots.py            writes all of them
    robots/make_robots.py chibi      writes one
    robots/make_robots.py --check    exit status 1 if a file differs from what the script writes

A robot is a table of links. Each link hangs on one hinge, its frame lies in the hinge, and all frames have the axes of the model:
x forward, y left, z up. Links of the left side have a mirror image. Masses are those of servos and plates; the inertia is that of a box
of uniform density around the link's servo or its collision box. No robot of this page exists: sizes and masses are those of its class.
"""

import dataclasses
import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
X, Y, Z = "1 0 0", "0 1 0", "0 0 1"


@dataclasses.dataclass
class Link:
    """A link and the hinge on which it hangs. Lengths in mm, masses in g, angles in degrees, of the left side."""
    name: str
    parent: str
    joint: str
    at: tuple  # of the hinge, in the parent's frame
    axis: str
    limits: tuple
    mass: float
    com: tuple
    box: tuple  # sides; of the servo, or of the collision box
    centre: tuple = None  # of the collision box; None: the link has none


@dataclasses.dataclass
class Robot:
    name: str
    about: str  # a comment
    servo: str  # a type of robots/servos/, or one of `servo_types`
    speed: float  # of the servo without load, rad/s
    battery_V: float
    hip_height: float  # of the trunk's frame, mm
    trunk_mass: float
    trunk_com: tuple
    trunk_box: tuple
    trunk_centre: tuple
    links: list
    feet: str  # XML of the sensor in a foot, after the side's name
    servo_types: str
    first_node: int = 16


def mirrored(link):
    """The link of the right side: y changes its sign, and with it the range of a hinge about x or z."""
    def side(text):
        return text.replace("left_", "right_")

    def other(point):
        return point and (point[0], -point[1], point[2])
    low, high = link.limits
    limits = (low, high) if link.axis == Y else (-high, -low)
    return dataclasses.replace(link, name=side(link.name), parent=side(link.parent), joint=side(link.joint), at=other(link.at),
                               limits=limits, com=other(link.com), centre=other(link.centre))


def both_sides(links):
    """The left links, then their mirror images, then those of the middle."""
    left = [link for link in links if link.name.startswith("left_")]
    return left + [mirrored(link) for link in left] + [link for link in links if not link.name.startswith("left_")]


def metres(values):
    return " ".join(f"{value / 1000:.6g}" for value in values)


def inertial(mass_g, com, sides):
    mass = mass_g / 1000
    x, y, z = (side / 1000 for side in sides)
    ixx, iyy, izz = (mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y)))
    return f"""      <inertial>
        <pose>{metres(com)} 0 0 0</pose>
        <mass>{mass:.6g}</mass>
        <inertia><ixx>{ixx:.4e}</ixx><iyy>{iyy:.4e}</iyy><izz>{izz:.4e}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>
      </inertial>
"""


def collision(centre, sides):
    return f"""      <collision name="box">
        <pose>{metres(centre)} 0 0 0</pose>
        <geometry><box><size>{metres(sides)}</size></box></geometry>
        <surface>
          <friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction>
          <contact><ode><soft_cfm>0.0001</soft_cfm><soft_erp>0.2</soft_erp></ode></contact>
        </surface>
      </collision>
"""


def visual(centre, sides):
    return f"""      <visual name="box">
        <pose>{metres(centre)} 0 0 0</pose>
        <geometry><box><size>{metres(sides)}</size></box></geometry>
      </visual>
"""


# The inertial unit of robots/koboshi/robot.sdf, which states the sources of its numbers.
IMU = """      <sensor name="imu" type="imu">
        <pose>{pose} 0 0 0</pose>
        <update_rate>1000</update_rate>
        <koboshi:gyro>
          <noise_density>8.72665e-05</noise_density><bias>0.349066</bias><bias_instability>3.15e-05</bias_instability>
          <random_walk>1.15e-06</random_walk><scale_error>0.03</scale_error><cross_axis>0.02</cross_axis>
          <g_sensitivity>0.00017797</g_sensitivity><bandwidth_Hz>98</bandwidth_Hz><range>17.4533</range>
          <resolution>0.000532632</resolution><delay_s>0.001</delay_s>
        </koboshi:gyro>
        <koboshi:accelerometer>
          <noise_density>0.00392266</noise_density><bias>0.490333</bias><bias_instability>0.00059</bias_instability>
          <random_walk>2.15e-05</random_walk><scale_error>0.03</scale_error><cross_axis>0.02</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz><range>39.2266</range><resolution>0.0011971</resolution><delay_s>0.001</delay_s>
        </koboshi:accelerometer>
      </sensor>
"""


def six_axes(force_range_N, torque_range_Nm):
    """The ankle sensor of robots/koboshi/robot.sdf, with its errors in proportion to the ranges."""
    force, torque = force_range_N / 100, torque_range_Nm / 4
    return f"""type="force_torque">
        <pose>0 0 0 0 0 0</pose>
        <update_rate>1000</update_rate>
        <force_torque><frame>sensor</frame><measure_direction>child_to_parent</measure_direction></force_torque>
        <koboshi:force>
          <noise_density>{0.001 * force:.4g}</noise_density><bias>{0.05 * force:.4g}</bias><cross_axis>0.005</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz><range>{force_range_N:.4g}</range><resolution>{0.005 * force:.4g}</resolution><delay_s>0.001</delay_s>
        </koboshi:force>
        <koboshi:torque>
          <noise_density>{2e-5 * torque:.4g}</noise_density><bias>{0.001 * torque:.4g}</bias><cross_axis>0.005</cross_axis>
          <bandwidth_Hz>98</bandwidth_Hz><range>{torque_range_Nm:.4g}</range><resolution>{2e-4 * torque:.4g}</resolution><delay_s>0.001</delay_s>
        </koboshi:torque>
        <koboshi:crosstalk>0.005</koboshi:crosstalk>
"""


def pressure_cells(corners_mm, range_N):
    """Four cells near the corners of the sole; noise, offset and resolution as shares of the range that load cells of kits have."""
    cells = "".join(f"<koboshi:cell>{x / 1000:.4g} {y / 1000:.4g}</koboshi:cell>" for x, y in corners_mm)
    return f"""type="koboshi:pressure_cells">
        <update_rate>1000</update_rate>
        {cells}
        <koboshi:cell_force>
          <noise_density>{3e-5 * range_N:.4g}</noise_density><bias>{0.002 * range_N:.4g}</bias><bandwidth_Hz>98</bandwidth_Hz>
          <range>{range_N:.4g}</range><resolution>{range_N / 4096:.4g}</resolution><delay_s>0.001</delay_s>
        </koboshi:cell_force>
"""


def joint_text(robot, link, node):
    low, high = (math.radians(limit) for limit in link.limits)
    sensor = ""
    if link.name.endswith("_foot"):
        side = link.name.removesuffix("_foot")
        sensor = f"""      <sensor name="{side}_ankle" {robot.feet}      </sensor>
"""
    return f"""    <joint name="{link.joint}" type="revolute">
      <parent>{link.parent}</parent>
      <child>{link.name}</child>
      <axis>
        <xyz>{link.axis}</xyz>
        <limit><lower>{low:.6f}</lower><upper>{high:.6f}</upper><velocity>{robot.speed:.4g}</velocity></limit>
      </axis>
      <koboshi:servo type="{robot.servo}"/>
      <koboshi:encoder bits="12" noise_counts="0.1"/>
      <koboshi:drive node_id="{node}" serial_number="{node}" sign="1" zero_rad="0"/>
{sensor}    </joint>
"""


def sdf(robot):
    text = f"""<?xml version="1.0"?>
<!--
{robot.about.strip(chr(10))}

  Written by robots/make_robots.py.
-->
<sdf version="1.9" xmlns:koboshi="https://koboshi.invalid/sdf">
  <model name="{robot.name}">
{robot.servo_types}    <koboshi:battery open_circuit_V="{robot.battery_V:g}" internal_resistance_ohm="0.06"/>
    <link name="trunk">
      <pose>0 0 {robot.hip_height / 1000:.6g} 0 0 0</pose>
"""
    text += inertial(robot.trunk_mass, robot.trunk_com, robot.trunk_box)
    text += collision(robot.trunk_centre, robot.trunk_box) + visual(robot.trunk_centre, robot.trunk_box)
    text += IMU.format(pose=metres(robot.trunk_com)) + "    </link>\n"
    for node, link in enumerate(both_sides(robot.links), robot.first_node):
        text += f"""    <link name="{link.name}">
      <pose relative_to="{link.parent}">{metres(link.at)} 0 0 0</pose>
"""
        text += inertial(link.mass, link.com, link.box)
        if link.centre:
            text += collision(link.centre, link.box) + visual(link.centre, link.box)
        text += "    </link>\n" + joint_text(robot, link, node)
    return text + "  </model>\n</sdf>\n"


def chibi():
    """0.35 m, 17 servos of 41.5 g."""
    servo = (21, 32, 38)
    links = [
        Link("left_hip_roll_link", "trunk", "left_hip_roll", (0, 28, 0), X, (-30, 60), 44, (-16, 0, 0), servo),
        Link("left_thigh", "left_hip_roll_link", "left_hip_pitch", (0, 0, 0), Y, (-115, 60), 48, (0, 0, -35), (18, 28, 46), (0, 0, -34)),
        Link("left_shank", "left_thigh", "left_knee", (0, 0, -60), Y, (0, 140), 50, (0, 0, -30), (18, 28, 40), (0, 0, -30)),
        Link("left_ankle_link", "left_shank", "left_ankle_pitch", (0, 0, -60), Y, (-90, 70), 44, (-16, 0, 0), servo),
        Link("left_foot", "left_ankle_link", "left_ankle_roll", (0, 0, 0), X, (-55, 55), 45, (8, 0, -26), (92, 52, 15), (10, 0, -29.5)),
        Link("left_shoulder_link", "trunk", "left_shoulder_pitch", (0, 66, 112), Y, (-175, 175), 44, (0, 0, 0), servo),
        Link("left_upper_arm", "left_shoulder_link", "left_shoulder_roll", (0, 0, 0), X, (-15, 130), 48, (0, 0, -32), (24, 24, 52), (0, 0, -32)),
        Link("left_forearm", "left_upper_arm", "left_elbow", (0, 0, -66), Y, (-130, 130), 15, (0, 0, -45), (20, 20, 80), (0, 0, -49)),
        Link("head", "trunk", "head_pan", (0, 0, 132), Z, (-90, 90), 30, (0, 0, 30), (46, 54, 44), (0, 0, 40)),
    ]
    return Robot(
        name="chibi", servo="krs_2552", speed=7.48, battery_V=7.6, hip_height=157,
        about="""
  A kit robot of 0.35 m and 17 servos: legs without hip yaw, arms of three joints, a head that pans. 0.98 kg. Its feet measure nothing but
  contact, by a switch in each sole.
""",
        trunk_mass=300, trunk_com=(0, 0, 78), trunk_box=(58, 78, 100), trunk_centre=(0, 0, 80), links=links,
        feet="""type="koboshi:contact_switch">
        <update_rate>1000</update_rate>
        <koboshi:closing_force_N>1</koboshi:closing_force_N>
""",
        servo_types="""    <koboshi:servo_types file="../servos/catalogue.xml"/>
""")


def hanpo():
    """0.5 m, 3 kg, hips and ankles whose axes do not meet, pressure cells."""
    servo = (30, 36, 48)
    links = [
        Link("left_hip_yaw_link", "trunk", "left_hip_yaw", (0, 42, 0), Z, (-60, 60), 95, (-10, 0, -12), servo),
        Link("left_hip_roll_link", "left_hip_yaw_link", "left_hip_roll", (0, 0, -24), X, (-30, 60), 95, (-20, 0, 0), servo),
        Link("left_thigh", "left_hip_roll_link", "left_hip_pitch", (12, 0, -14), Y, (-125, 50), 110, (0, 0, -45), (32, 40, 60), (0, 0, -46)),
        Link("left_shank", "left_thigh", "left_knee", (0, 0, -85), Y, (0, 145), 105, (0, 0, -42), (32, 40, 52), (0, 0, -42)),
        Link("left_ankle_link", "left_shank", "left_ankle_pitch", (0, 0, -85), Y, (-90, 65), 95, (-20, 0, -6), servo),
        Link("left_foot", "left_ankle_link", "left_ankle_roll", (0, 0, -14), X, (-45, 45), 90, (4, 0, -24), (146, 76, 18), (4, 0, -27)),
        Link("left_shoulder_link", "trunk", "left_shoulder_pitch", (0, 92, 168), Y, (-175, 175), 95, (0, 0, 0), servo),
        Link("left_upper_arm", "left_shoulder_link", "left_shoulder_roll", (0, 12, 0), X, (-15, 130), 100, (0, 0, -45), (34, 34, 74), (0, 0, -45)),
        Link("left_forearm", "left_upper_arm", "left_elbow", (0, 0, -92), Y, (-130, 130), 40, (0, 0, -70), (28, 28, 130), (0, 0, -76)),
        Link("neck", "trunk", "head_pan", (0, 0, 196), Z, (-90, 90), 95, (0, 0, 12), servo),
        Link("head", "neck", "head_tilt", (0, 0, 26), Y, (-45, 60), 60, (0, 0, 30), (70, 80, 60), (0, 0, 38)),
    ]
    return Robot(
        name="hanpo", servo="xm430_w350", speed=4.82, battery_V=12.0, hip_height=258,
        about="""
  A robot of 0.5 m and 3 kg with 20 servos of 82 g. Its hip and ankle axes do not meet: the roll axis of the hip lies 24 mm below the
  yaw servo, the pitch axis 14 mm below and 12 mm in front of it, and the roll axis of the ankle 14 mm below its pitch axis. Four
  pressure cells in each sole.
""",
        trunk_mass=1190, trunk_com=(0, 0, 82), trunk_box=(84, 110, 140), trunk_centre=(0, 0, 112), links=links,
        feet=pressure_cells(((67, 28), (67, -28), (-59, 28), (-59, -28)), 40),
        servo_types="""    <koboshi:servo_types file="../servos/catalogue.xml"/>
""")


def noppo():
    """1.0 m, 12 kg, a waist and 23 joints."""
    drive = (60, 70, 70)
    links = [
        Link("waist_link", "trunk", "waist_yaw", (0, 0, 60), Z, (-80, 80), 3600, (0, 0, 150), (150, 200, 240), (0, 0, 160)),
        Link("left_hip_yaw_link", "trunk", "left_hip_yaw", (0, 78, 0), Z, (-80, 80), 380, (-30, 0, 20), drive),
        Link("left_hip_roll_link", "left_hip_yaw_link", "left_hip_roll", (0, 0, 0), X, (-35, 80), 380, (-40, 0, 0), drive),
        Link("left_thigh", "left_hip_roll_link", "left_hip_pitch", (0, 0, 0), Y, (-120, 60), 560, (0, 0, -90), (50, 70, 120), (0, 0, -100)),
        Link("left_shank", "left_thigh", "left_knee", (0, 0, -172), Y, (0, 150), 480, (0, 0, -85), (50, 70, 110), (0, 0, -85)),
        Link("left_ankle_link", "left_shank", "left_ankle_pitch", (0, 0, -172), Y, (-90, 75), 330, (-40, 0, 0), drive),
        Link("left_foot", "left_ankle_link", "left_ankle_roll", (0, 0, 0), X, (-60, 60), 420, (25, 0, -70), (260, 148, 40), (32, 0, -86)),
        Link("left_shoulder_link", "waist_link", "left_shoulder_pitch", (0, 170, 260), Y, (-175, 175), 300, (0, 0, 0), drive),
        Link("left_upper_arm", "left_shoulder_link", "left_shoulder_roll", (0, 0, 0), X, (-15, 135), 340, (0, 0, -80), (56, 56, 140), (0, 0, -85)),
        Link("left_lower_arm", "left_upper_arm", "left_elbow", (0, 0, -180), Y, (-135, 135), 180, (0, 0, -60), (48, 48, 100), (0, 0, -64)),
        Link("left_hand", "left_lower_arm", "left_wrist_yaw", (0, 0, -130), Z, (-90, 90), 90, (0, 0, -40), (50, 30, 90), (0, 0, -50)),
        Link("neck", "waist_link", "head_pan", (0, 0, 296), Z, (-90, 90), 180, (0, 0, 20), drive),
        Link("head", "neck", "head_tilt", (0, 0, 46), Y, (-60, 60), 240, (0, 0, 50), (120, 150, 120), (0, 0, 66)),
    ]
    return Robot(
        name="noppo", servo="drive_36", speed=4.6, battery_V=24.0, hip_height=450, first_node=40,
        about="""
  A robot of 1.0 m and 12 kg with 23 joints: a waist that turns, arms of four joints, six-axis sensors in the ankles.
""",
        trunk_mass=1060, trunk_com=(0, 0, 30), trunk_box=(130, 180, 50), trunk_centre=(0, 0, 61), links=links,
        feet=six_axes(900, 60),
        servo_types="""    <!-- Assumed: a geared drive of 36 N m and 4.6 rad/s at 24 V, which are those of the default robot's servo scaled to this size and mass
         (dynamic similarity). kt V / R = T + Kc, kt (V - kt w) / R = Kc + Kv w. Friction as in the catalogue: 2.5 % of T. Rotor inertia: 0.034 by
         the rule of the catalogue, rounded down. -->
    <koboshi:servo_type name="drive_36">
      <torque_constant_Nm_per_A>5.05</torque_constant_Nm_per_A>
      <resistance_ohm>3.285</resistance_ohm>
      <supply_V>24</supply_V>
      <rotor_inertia_kg_m2>0.03</rotor_inertia_kg_m2>
      <coulomb_friction_Nm>0.9</coulomb_friction_Nm>
      <viscous_friction_Nm_s>0.07</viscous_friction_Nm_s>
      <full_voltage_error_rad>0.13</full_voltage_error_rad>
    </koboshi:servo_type>
""")


ROBOTS = {"chibi": chibi, "hanpo": hanpo, "noppo": noppo}


def main(arguments):
    check = "--check" in arguments
    names = [argument for argument in arguments if argument != "--check"] or list(ROBOTS)
    differs = False
    for name in names:
        if name not in ROBOTS:
            sys.exit(f"found the robot {name}, expected one of {', '.join(ROBOTS)}")
        file = FOLDER / name / "robot.sdf"
        text = sdf(ROBOTS[name]())
        if check:
            if not file.exists() or file.read_text() != text:
                print(f"{file} differs from what robots/make_robots.py writes")
                differs = True
            continue
        file.parent.mkdir(exist_ok=True)
        file.write_text(text)
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
