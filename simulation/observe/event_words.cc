#include "simulation/observe/event_words.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "base/text/text.h"
#include "firmware/app/controller_objects.h"

namespace koboshi::simulation {
namespace {

void add_part(std::string& text, double amount, const char* unit, const char* positive,
              const char* negative) {
  if (amount == 0.0) return;
  if (!text.empty()) text += ", ";
  text += fmt::format("{:.2f} {} {}", std::abs(amount), unit, amount > 0.0 ? positive : negative);
}

}  // namespace

std::string name_of(behaviour::State state) {
  return std::string(canopen::name_of(app::kStateNames, static_cast<std::int64_t>(state)));
}

std::string name_of(behaviour::Reason reason) {
  return std::string(canopen::name_of(app::kReasonNames, static_cast<std::int64_t>(reason)));
}

std::string seconds_text(std::uint64_t time_us, int decimals) {
  return fmt::format("{:.{}f} s", static_cast<double>(time_us) / 1e6, decimals);
}

std::string velocity_text(const walk::Velocity& velocity) {
  std::string text;
  add_part(text, 1e-3 * velocity.forward_mm_per_s, "m/s", "forward", "backward");
  add_part(text, 1e-3 * velocity.left_mm_per_s, "m/s", "left", "right");
  add_part(text, 1e-3 * velocity.turn_mrad_per_s, "rad/s", "to the left", "to the right");
  return text.empty() ? "in place" : text;
}

// Direction of the horizontal part of the trunk's z axis, from pitch and roll; R_WB = Rz(yaw) Ry(pitch)
// Rx(roll).
std::string lean_direction(const Eigen::Vector3d& rpy_rad) {
  const double forward = std::sin(rpy_rad.y()) * std::cos(rpy_rad.x());
  const double left = -std::sin(rpy_rad.x());
  if (std::abs(forward) >= std::abs(left)) return forward >= 0.0 ? "front" : "back";
  return left >= 0.0 ? "left" : "right";
}

std::string direction_text(const Eigen::Vector3d& v_W, double heading_rad) {
  const double forward = std::cos(heading_rad) * v_W.x() + std::sin(heading_rad) * v_W.y();
  const double left = -std::sin(heading_rad) * v_W.x() + std::cos(heading_rad) * v_W.y();
  if (std::abs(v_W.z()) > std::hypot(forward, left)) return v_W.z() > 0.0 ? "up" : "down";
  if (std::abs(forward) >= std::abs(left)) return forward >= 0.0 ? "forward" : "backward";
  return left >= 0.0 ? "to the left" : "to the right";
}

std::string fault_text(const Fault& fault) {
  std::string text = Fault::kind_names()[static_cast<std::size_t>(fault.kind)];
  switch (fault.kind) {
    case Fault::Kind::kSupplyDrop:
      return text + " to " + number_text(fault.highest_V) + " V";
    case Fault::Kind::kBatteryDischarge:
      return text + " to " + number_text(fault.open_circuit_V) + " V within " +
             seconds_text(fault.over_us, 1);
    case Fault::Kind::kDriveSilent:
    case Fault::Kind::kDrivePowerLoss:
    case Fault::Kind::kEncoderBreak:
    case Fault::Kind::kDriveOverheat:
    case Fault::Kind::kAnkleStop:
      return text + " of " + fault.target.text;
    case Fault::Kind::kFramesLost:
    case Fault::Kind::kFramesCorrupted:
    case Fault::Kind::kFramesDelayed:
    case Fault::Kind::kFramesDoubled:
      return fault.target.text.empty() ? text : text + " of " + fault.target.text;
    default:
      return text;
  }
}

std::string count_text(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace koboshi::simulation
