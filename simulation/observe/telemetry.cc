#include "simulation/observe/telemetry.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/drive/configuration.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/sensor/sensor_node.h"

namespace koboshi::simulation {
namespace {

constexpr double kRadPerTurn = 2.0 * std::numbers::pi;
constexpr double kRadPerAngleUnit = kRadPerTurn / (1 << 16);  // unit of angles in the telemetry PDOs
constexpr double kMetrePerLengthUnit = 1.0 / (1 << 15);
constexpr double kRadPerSPerRateUnit = kRadPerTurn / (1 << 12);

// The controller's TPDOs from the fifth on use the identifiers of this node id, which no drive has.
constexpr std::uint8_t kBalanceNode = drive::kControllerNodeId + 1;

constexpr std::uint16_t kTpdo2Base = canopen::kTpdo1Base + canopen::kPdoStep;
constexpr std::uint16_t kTpdo3Base = kTpdo2Base + canopen::kPdoStep;
constexpr std::uint16_t kRpdo2Base = canopen::kRpdo1Base + canopen::kPdoStep;
constexpr double kMetrePerMillimetre = 1e-3;
constexpr std::uint16_t kTpdo4Base = kTpdo3Base + canopen::kPdoStep;

double signed_16(const hal::CanFrame& frame, std::size_t at) {
  return static_cast<std::int16_t>(canopen::load_u16(&frame.data[at]));
}

std::int32_t signed_32(const hal::CanFrame& frame, std::size_t at) {
  return static_cast<std::int32_t>(canopen::load_u32(&frame.data[at]));
}

}  // namespace

bool has_node(const robot::RobotModel& model, std::uint8_t node_id) {
  constexpr std::uint8_t kOthers[] = {drive::kControllerNodeId, sim_board::kInertialNode,
                                      sim_board::kLeftAnkleNode, sim_board::kRightAnkleNode};
  const auto joints = std::span(model.joints).first(model.joint_count);
  return std::ranges::find(kOthers, node_id) != std::end(kOthers) ||
         std::ranges::any_of(joints,
                             [&](const robot::Joint& joint) { return joint.drive.node_id == node_id; });
}

TelemetryReader::TelemetryReader(const robot::RobotModel& model) : model_(model) {
  joint_of_node_.fill(kNoJoint);
  for (std::size_t joint = 0; joint < model.joint_count; ++joint) {
    joint_of_node_[model.joints[joint].drive.node_id] = static_cast<std::uint8_t>(joint);
  }
}

void TelemetryReader::on_bus_frame(const hal::CanFrame& frame, std::uint64_t, std::uint64_t) {
  if (frame.remote) return;  // without data: a request for a frame
  const auto node = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  const auto base = static_cast<std::uint16_t>(frame.identifier & ~0x7F);
  if (base == canopen::kEmergencyBase && node != 0) {
    const bool is_error = frame.size == 8 && canopen::load_u16(frame.data.data()) != 0;
    if (is_error && has_node(model_, node)) ++telemetry_.emergencies;
    return;
  }
  if (node == drive::kControllerNodeId) return read_controller(base, frame);
  if (node == kBalanceNode) return read_balance(base, frame);
  const std::uint8_t index = joint_of_node_[node];
  if (index == kNoJoint) return;
  Telemetry::Joint& joint = telemetry_.joints[index];
  const robot::Drive& drive = model_.joints[index].drive;
  if (base == canopen::kRpdo1Base && frame.size == 6) {
    joint.target_rad = fixed::to_double(robot::joint_angle(drive, signed_32(frame, 2)));
  } else if (base == canopen::kTpdo1Base && frame.size == 8) {
    joint.statusword = canopen::load_u16(frame.data.data());
    joint.position_rad = fixed::to_double(robot::joint_angle(drive, signed_32(frame, 2)));
    joint.torque_permille = drive.sign * signed_16(frame, 6);
  }
}

void TelemetryReader::read_controller(std::uint16_t base, const hal::CanFrame& frame) {
  // Not a number on a robot that does not measure it.
  const auto load_N = [&] {
    if (!model_.measures_loads()) return std::numeric_limits<double>::quiet_NaN();
    return fixed::to_double(model_.scales.ankle_force) * signed_16(frame, 0) / (1 << 15);
  };
  switch (base) {
    case canopen::kTpdo1Base:
      if (frame.size != 8) return;
      telemetry_.state = static_cast<behaviour::State>(frame.data[0]);
      telemetry_.reason = static_cast<behaviour::Reason>(frame.data[1]);
      telemetry_.motion = frame.data[2];
      telemetry_.drive_fault = static_cast<drive::DriveFault>(frame.data[3]);
      telemetry_.faulty_joint = frame.data[4];
      telemetry_.refusal = static_cast<behaviour::Reason>(frame.data[7]);
      break;
    case kTpdo2Base:
      telemetry_.roll_rad = kRadPerAngleUnit * signed_16(frame, 0);
      telemetry_.pitch_rad = kRadPerAngleUnit * signed_16(frame, 2);
      telemetry_.rate_rad_per_s[0] = kRadPerSPerRateUnit * signed_16(frame, 4);
      telemetry_.rate_rad_per_s[1] = kRadPerSPerRateUnit * signed_16(frame, 6);
      break;
    case kTpdo3Base:
      telemetry_.foot_load_N[0] = load_N();
      telemetry_.rate_rad_per_s[2] = kRadPerSPerRateUnit * signed_16(frame, 6);
      break;
    case kTpdo4Base:
      telemetry_.foot_load_N[1] = load_N();
      break;
    default:
      break;
  }
}

// The flags come last. The values of an invalid ZMP are zero, or app::kNoLength.
void TelemetryReader::read_balance(std::uint16_t base, const hal::CanFrame& frame) {
  const auto length_m = [&](std::size_t at) { return kMetrePerLengthUnit * signed_16(frame, at); };
  switch (base) {
    case canopen::kTpdo1Base:
      for (std::size_t side = 0; side < 2; ++side) {
        telemetry_.foot_zmp[side].x_m = length_m(4 * side);
        telemetry_.foot_zmp[side].y_m = length_m(4 * side + 2);
      }
      break;
    case kTpdo2Base:
      telemetry_.zmp.x_m = length_m(0);
      telemetry_.zmp.y_m = length_m(2);
      telemetry_.com_S_m[0] = length_m(4);
      telemetry_.com_S_m[1] = length_m(6);
      break;
    case kTpdo3Base: {
      const std::uint8_t flags = frame.data[2];
      telemetry_.com_S_m[2] = length_m(0);
      telemetry_.foot_zmp[0].valid = (flags & app::kLeftZmpValid) != 0;
      telemetry_.foot_zmp[1].valid = (flags & app::kRightZmpValid) != 0;
      telemetry_.contact = {(flags & (app::kLeftZmpValid | app::kLeftContact)) != 0,
                            (flags & (app::kRightZmpValid | app::kRightContact)) != 0};
      telemetry_.zmp.valid = (flags & app::kZmpValid) != 0;
      telemetry_.zmp.frame = (flags & app::kFrameIsRight) != 0 ? hal::Side::kRight : hal::Side::kLeft;
      telemetry_.planned_zmp = {
          .x_m = length_m(3),
          .y_m = length_m(5),
          .valid = (flags & app::kPlannedZmpValid) != 0,
          .frame = (flags & app::kPlanIsInRight) != 0 ? hal::Side::kRight : hal::Side::kLeft};
      const std::uint8_t com_flags = frame.data[7];
      Telemetry::ComMotion& motion = telemetry_.com_motion;
      motion.valid = (com_flags & app::kComValid) != 0;
      motion.compared = (com_flags & app::kDcmErrorValid) != 0;
      motion.touches = {(com_flags & app::kLeftTouches) != 0, (com_flags & app::kRightTouches) != 0};
      motion.frame = (com_flags & app::kComIsInRight) != 0 ? hal::Side::kRight : hal::Side::kLeft;
      break;
    }
    case canopen::kRpdo1Base: {
      const std::uint8_t flags = frame.data[6];
      Telemetry::Place& place = telemetry_.place;
      place.x_m = kMetrePerMillimetre * signed_16(frame, 0);
      place.y_m = kMetrePerMillimetre * signed_16(frame, 2);
      place.heading_rad = kRadPerAngleUnit * signed_16(frame, 4);
      place.ground_valid = (flags & app::kGroundValid) != 0;
      break;
    }
    case kRpdo2Base:
      for (std::size_t axis = 0; axis < 2; ++axis) {
        telemetry_.place.slope_rad.at(axis) = kRadPerAngleUnit * signed_16(frame, 2 * axis);
        telemetry_.place.attitude_zero_rad.at(axis) = kRadPerAngleUnit * signed_16(frame, 4 + 2 * axis);
      }
      break;
    case kTpdo4Base:
      telemetry_.com_motion.dcm_m = {length_m(0), length_m(2)};
      telemetry_.com_motion.dcm_error_m = {length_m(4), length_m(6)};
      break;
    default:
      break;
  }
}

void TelemetryReader::archive(sim_board::StateArchive& archive) { archive(telemetry_); }

}  // namespace koboshi::simulation
