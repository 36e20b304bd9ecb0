#include "tests/unit/sim_board/description/robot_text.h"

#include <limits>
#include <sstream>

namespace koboshi::sim_board {
namespace {

class RobotWriter {
 public:
  RobotWriter() { out_.precision(std::numeric_limits<double>::max_digits10); }

  std::string text() const { return out_.str(); }

  template <class... Values>
  void write(const std::string& name, const Values&... values) {
    out_ << name;
    ((out_ << " | " << values), ...);
    out_ << "\n";
  }

  void write_colour(const std::optional<ColourDescription>& colour) {
    if (colour) write("colour", (*colour)[0], (*colour)[1], (*colour)[2]);
  }

  void write_box(const BoxDescription& box) {
    const SurfaceDescription& s = box.surface;
    write("box", box.name, box.X_LG.matrix(), box.size_m, s.friction, s.friction_second, s.bounce,
          s.bounce_threshold_m_per_s, s.error_reduction, s.constraint_force_mixing, s.reference_step_s,
          s.slip_m_per_N_s, s.material);
    if (s.friction_direction) write("direction", *s.friction_direction);
    write_colour(box.colour);
  }

  void write_link(const LinkDescription& link) {
    write("link", link.name, link.X_ML.matrix(), link.mass_kg, link.p_LCom_L, link.I_LCom_L);
    for (const BoxDescription& box : link.collisions) write_box(box);
    for (const BoxDescription& box : link.visual_boxes) write_box(box);
    for (const MeshDescription& mesh : link.meshes) {
      write("mesh", mesh.name, mesh.file.string(), mesh.X_LG.matrix(), mesh.scale);
      write_colour(mesh.colour);
    }
  }

  void write_meter(const std::optional<ScalarSensorDescription>& meter) {
    if (meter)
      write("meter", meter->noise, meter->offset, meter->scale_error, meter->lowest, meter->highest,
            meter->resolution, meter->sample_period_s);
  }

  void write_servo(const ServoDescription& servo) {
    write("servo", servo.torque_constant_Nm_per_A, servo.resistance_ohm, servo.supply_V,
          servo.rotor_inertia_kg_m2, servo.coulomb_friction_Nm, servo.viscous_friction_Nm_s,
          servo.full_voltage_error_rad, servo.velocity_gain_V_s_per_rad, servo.max_duty,
          servo.current_limit_A, servo.backlash_rad);
    write("stribeck", servo.stribeck.friction_Nm, servo.stribeck.speed_rad_per_s, servo.stribeck.exponent);
    for (const LoadShares& shares :
         {servo.load_friction, servo.stribeck_load_friction, servo.quadratic_load_friction_per_Nm})
      write("shares", shares.motor, shares.external);
    if (const auto& w = servo.winding)
      write("winding", w->thermal_resistance_K_per_W, w->heat_capacity_J_per_K, w->ambient_C, w->derating_C,
            w->shutdown_C, w->derated_share, w->copper_per_K);
    write("command", servo.command.period_ms, servo.command.write_delay_ms, servo.command.read_delay_ms,
          servo.command.dead_band_rad);
    write_meter(servo.voltmeter);
    write_meter(servo.thermometer);
  }

  void write_joint(const JointDescription& joint) {
    write("joint", joint.name, joint.parent, joint.child, joint.p_MJ, joint.axis_M, joint.lower_rad,
          joint.upper_rad, joint.max_speed_rad_per_s);
    write_servo(joint.servo);
    write("encoder", joint.encoder.bits, joint.encoder.offset_rad, joint.encoder.noise_counts);
    write("drive", int{joint.drive.node_id}, joint.drive.vendor_id, joint.drive.product_code,
          joint.drive.serial_number, joint.drive.sign, joint.drive.zero_rad);
    if (!joint.stated_role.empty()) write("role", joint.stated_role);
    if (!joint.stated_mirror.empty()) write("mirror", joint.stated_mirror);
    if (joint.maker)
      write("maker", joint.maker->servo_id, joint.maker->sign, joint.maker->zero_ticks,
            joint.maker->ticks_per_turn);
  }

  void write_channel(const ChannelDescription& c) {
    write("channel", c.noise_density, c.bias, c.bias_instability, c.random_walk, c.scale_error, c.cross_axis,
          c.bandwidth_Hz, c.range, c.resolution, c.sample_period_s, c.jitter_s, c.delay_s);
  }

  void write_ankle(const std::optional<AnkleSensorDescription>& ankle) {
    if (!ankle) return;
    write("ankle", ankle->name, ankle->joint, ankle->X_LS.matrix(), ankle->height_above_sole_m,
          ankle->crosstalk);
    if (ankle->kind != hal::AnkleKind::kSixAxis) {
      write("kind", static_cast<int>(ankle->kind), ankle->closing_force_N);
      for (const Eigen::Vector2d& cell : ankle->cells_S_m) write("cell", cell.x(), cell.y());
    }
    write_channel(ankle->force);
    write_channel(ankle->torque);
  }

  void write_robot(const RobotDescription& robot) {
    write("robot", robot.name);
    for (const LinkDescription& link : robot.links) write_link(link);
    for (const JointDescription& joint : robot.joints) write_joint(joint);
    for (const FollowerDescription& follower : robot.followers) {
      write_joint(follower.hinge);
      write("follower", follower.leader, follower.multiplier, follower.offset_rad);
    }
    if (const auto& b = robot.battery) write("battery", b->open_circuit_V, b->internal_resistance_ohm);
    if (const auto& imu = robot.imu) {
      write("imu", imu->name, imu->link, imu->X_LS.matrix(), imu->g_sensitivity);
      write_channel(imu->gyro);
      write_channel(imu->accelerometer);
    }
    write_ankle(robot.left_ankle);
    write_ankle(robot.right_ankle);
  }

 private:
  std::ostringstream out_;
};

}  // namespace

std::string robot_text(const RobotDescription& robot) {
  RobotWriter writer;
  writer.write_robot(robot);
  return writer.text();
}

}  // namespace koboshi::sim_board
