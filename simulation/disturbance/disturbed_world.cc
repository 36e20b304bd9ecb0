#include "simulation/disturbance/disturbed_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim_board/random/random_stream.h"

namespace koboshi::simulation {
namespace {

using sim_board::RandomStream;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kHalfTorque = 0.5;
constexpr double kMillisecond_s = 1e-3;

class Draw {
 public:
  Draw(const WorldRanges& ranges, std::uint64_t seed) : ends_only_(ranges.ends_only), seed_(seed) {}

  double operator()(const Range& range, const std::string& factor) const {
    RandomStream random(seed_, factor);
    return in(range, random);
  }
  double in(const Range& range, RandomStream& random) const {
    const double part = random.uniform();
    if (ends_only_) return part < 0.5 ? range.low : range.high;
    return range.low + (range.high - range.low) * part;
  }
  // A whole number from `low` to `high`, both included, each as likely as the others.
  int whole(int low, int high, const std::string& factor) const {
    RandomStream random(seed_, factor);
    const double part = random.uniform();
    if (ends_only_) return part < 0.5 ? low : high;
    return low + static_cast<int>(part * (high - low + 1));
  }
  // From the value of the file to `high`, where that is more.
  std::optional<double> above(double nominal, double high, const std::string& factor) const {
    if (high <= nominal) return std::nullopt;
    return (*this)({ends_only_ ? high : nominal, high}, factor);
  }

 private:
  bool ends_only_;
  std::uint64_t seed_;
};

bool is_zero(const Range& range) { return range == Range{}; }

void draw_parts(const WorldRanges& ranges, const sim_board::RobotDescription& robot, const Draw& draw,
                DisturbedWorld& world) {
  const double scale = leg_length_m(robot) / kReferenceLeg_m;
  for (int axis = 0; axis < 3; ++axis)
    world.com_m[axis] = scale * draw(ranges.com_m, std::string("trunk com ") + "xyz"[axis]);
  for (const sim_board::LinkDescription& link : robot.links)
    world.mass_factors.push_back(draw(ranges.mass_factor, "mass of " + link.name));
  for (const sim_board::JointDescription& joint : robot.joints) {
    world.encoder_offset_rad.push_back(draw(ranges.encoder_offset_rad, "encoder offset of " + joint.name));
    // Without a rotor there is nothing that could cross the gap.
    const bool stays = is_zero(ranges.backlash_rad) || joint.servo.rotor_inertia_kg_m2 == 0.0;
    world.backlash_rad.push_back(
        stays ? std::nullopt : std::optional(draw(ranges.backlash_rad, "backlash of " + joint.name)));
  }
  if (ranges.weak_joint && !robot.joints.empty()) {
    RandomStream random(world.seed, "weak joint");
    world.weak_joint = static_cast<std::size_t>(random.uniform() * static_cast<double>(robot.joints.size()));
  }
}

void add_latency(sim_board::ChannelDescription& channel, double latency_s) { channel.delay_s += latency_s; }

void weaken(sim_board::ServoDescription& servo) {
  const double stall_A = servo.supply_V / servo.resistance_ohm;
  servo.current_limit_A = std::min(servo.current_limit_A, kHalfTorque * stall_A);
}

void apply_to_servo(const DisturbedWorld& world, sim_board::ServoDescription& servo) {
  servo.full_voltage_error_rad *= world.servo_gain_divisor;
  servo.load_friction.motor += world.load_friction;
  servo.load_friction.external += world.load_friction;
  servo.torque_constant_Nm_per_A *= world.motor_constant_factor;
  servo.command.write_delay_ms += world.drive_latency_ms;
}

void apply_to_sensors(const DisturbedWorld& world, sim_board::RobotDescription& robot) {
  if (robot.imu) {
    add_latency(robot.imu->gyro, world.sensor_latency_s);
    add_latency(robot.imu->accelerometer, world.sensor_latency_s);
    if (world.gyro_noise_density) robot.imu->gyro.noise_density = *world.gyro_noise_density;
    if (world.gyro_random_walk) robot.imu->gyro.random_walk = *world.gyro_random_walk;
  }
  for (auto* ankle : {&robot.left_ankle, &robot.right_ankle}) {
    if (!*ankle) continue;
    add_latency((*ankle)->force, world.sensor_latency_s);
    add_latency((*ankle)->torque, world.sensor_latency_s);
  }
}

}  // namespace

// Turned about x, then y, by the parts of a vector of the tilt's length.
double DisturbedWorld::roll_rad() const { return tilt_rad * std::cos(tilt_direction_rad); }
double DisturbedWorld::pitch_rad() const { return tilt_rad * std::sin(tilt_direction_rad); }

std::uint64_t DisturbedWorld::tick_jitter_us() const {
  return static_cast<std::uint64_t>(std::llround(1e6 * tick_jitter_s));
}

double leg_length_m(const sim_board::RobotDescription& robot) {
  const auto hip = robot.find_joint("left_hip_pitch");
  const auto knee = robot.find_joint("left_knee");
  const auto ankle = robot.find_joint("left_ankle_pitch");
  if (!hip || !knee || !ankle) return kReferenceLeg_m;
  const auto anchor = [&](int joint) { return robot.joints[static_cast<std::size_t>(joint)].p_MJ; };
  return (anchor(*hip) - anchor(*knee)).norm() + (anchor(*knee) - anchor(*ankle)).norm();
}

DisturbedWorld draw_world(const WorldRanges& ranges, const sim_board::RobotDescription& robot,
                          std::uint64_t seed) {
  const Draw draw(ranges, seed);
  DisturbedWorld world;
  world.name = ranges.name;
  world.seed = seed;
  draw_parts(ranges, robot, draw, world);
  world.servo_gain_divisor = draw(ranges.servo_gain_divisor, "servo gain");
  world.load_friction = draw(ranges.load_friction, "load friction");
  world.motor_constant_factor = draw(ranges.motor_constant_factor, "motor constant");
  world.supply_factor = draw(ranges.supply_factor, "supply");
  world.sensor_latency_s = draw(ranges.sensor_latency_s, "sensor latency");
  world.drive_latency_ms = draw.whole(
      static_cast<int>(std::lround(ranges.drive_latency_s.low / kMillisecond_s)),
      static_cast<int>(std::lround(ranges.drive_latency_s.high / kMillisecond_s)), "drive latency");
  world.tick_jitter_s = draw(ranges.tick_jitter_s, "tick jitter");
  if (!is_zero(ranges.friction)) world.friction = draw(ranges.friction, "ground friction");
  RandomStream tilt(seed, "ground tilt");
  world.tilt_rad = draw.in(ranges.tilt_rad, tilt);
  world.tilt_direction_rad = kTurn_rad * tilt.uniform();
  if (robot.imu) {
    world.gyro_noise_density =
        draw.above(robot.imu->gyro.noise_density, ranges.gyro_noise_density, "gyro noise");
    world.gyro_random_walk =
        draw.above(robot.imu->gyro.random_walk, ranges.gyro_random_walk, "gyro random walk");
  }
  return world;
}

void apply(const DisturbedWorld& world, sim_board::RobotDescription& robot) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    sim_board::LinkDescription& link = robot.links[i];
    // Two surfaces have the friction of the more slippery one (sim_board/world/surface_contact.h): the draw
    // counts in full only if the robot has it too.
    if (world.friction) {
      for (sim_board::BoxDescription& box : link.collisions)
        box.surface.friction = box.surface.friction_second = *world.friction;
    }
    link.mass_kg *= world.mass_factors[i];
    link.I_LCom_L *= world.mass_factors[i];
  }
  if (!robot.links.empty()) robot.links.front().p_LCom_L += world.com_m;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    sim_board::JointDescription& joint = robot.joints[i];
    joint.encoder.offset_rad += world.encoder_offset_rad[i];
    if (world.backlash_rad[i]) joint.servo.backlash_rad = *world.backlash_rad[i];
    if (world.weak_joint == i) weaken(joint.servo);
    if (!robot.battery) joint.servo.supply_V *= world.supply_factor;
    apply_to_servo(world, joint.servo);
  }
  if (robot.battery) robot.battery->open_circuit_V *= world.supply_factor;
  apply_to_sensors(world, robot);
}

}  // namespace koboshi::simulation
