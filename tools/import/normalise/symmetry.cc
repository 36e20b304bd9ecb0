#include "tools/import/normalise/symmetry.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/normalise/repair_links.h"

namespace koboshi::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Below these, left and right are equal: what CAD and four digits in a file leave.
constexpr double kSameMass = 1e-3;  // relative
constexpr double kSameCom_m = 0.5e-3;
constexpr double kSameLimit_rad = 0.1 * kRadPerDegree;
// A battery may lie beside the middle of the trunk; a tenth of its width is more than that.
constexpr double kBesideShare = 0.1;
constexpr double kBeside_m = 0.005;

Vector3d mirrored(const Vector3d& p) { return {p.x(), -p.y(), p.z()}; }
Matrix3d mirrored(const Matrix3d& tensor) {
  const Vector3d flip(1.0, -1.0, 1.0);
  return flip.asDiagonal() * tensor * flip.asDiagonal();
}

ImportedLink* find_link(ImportedRobot& robot, const std::string& name) {
  const auto found = std::ranges::find(robot.links, name, &ImportedLink::name);
  return found == robot.links.end() ? nullptr : &*found;
}

double off_centre(const ImportedLink& link) {
  const Eigen::AlignedBox3d extent = extent_of(link);
  return extent.isEmpty() ? 0.0 : (link.p_LCom_L - extent.center()).norm();
}

void pair_mass(ImportedLink& left, ImportedLink& right, Interview& interview, ImportReport& report) {
  const double mean_kg = 0.5 * (left.mass_kg + right.mass_kg);
  if (std::abs(left.mass_kg - right.mass_kg) > kSameMass * mean_kg &&
      !take_repair({.key = left.name + ".mass",
                    .found = fmt::format("{} of {:.1f} g and {} of {:.1f} g", left.name,
                                         1000.0 * left.mass_kg, right.name, 1000.0 * right.mass_kg),
                    .taken = fmt::format("{:.1f} g each, the mean", 1000.0 * mean_kg),
                    .because = "left and right are mirror images"},
                   interview, report))
    return;
  // The inertia is that of the same body with another mass.
  left.I_LCom_L *= mean_kg / left.mass_kg;
  right.I_LCom_L *= mean_kg / right.mass_kg;
  left.mass_kg = right.mass_kg = mean_kg;
}

// Gives the side of which the file lacks a mass that of the other, with its mirrored centre of mass and
// inertia: a mean would spoil the other. Returns whether exactly one side lacks a mass.
bool copy_known_side(ImportedLink& left, ImportedLink& right, Interview& interview, ImportReport& report) {
  if (left.lacks_mass == right.lacks_mass) return false;
  ImportedLink& guess = left.lacks_mass ? left : right;
  const ImportedLink& known = left.lacks_mass ? right : left;
  if (std::abs(guess.mass_kg - known.mass_kg) <= kSameMass * known.mass_kg) return false;
  if (!take_repair({.key = left.name + ".mass",
                    .found = fmt::format("{} of {:.1f} g and {} with a part without a mass", known.name,
                                         1000.0 * known.mass_kg, guess.name),
                    .taken = fmt::format("{:.1f} g each, that of {}", 1000.0 * known.mass_kg, known.name),
                    .because = "left and right are mirror images"},
                   interview, report))
    return true;
  guess.mass_kg = known.mass_kg;
  guess.p_LCom_L = mirrored(known.p_LCom_L);
  guess.I_LCom_L = mirrored(known.I_LCom_L);
  guess.lacks_mass = false;
  return true;
}

void pair_com(ImportedLink& left, ImportedLink& right, Interview& interview, ImportReport& report) {
  const Vector3d image = mirrored(right.p_LCom_L);
  const double apart_m = (left.p_LCom_L - image).norm();
  Vector3d taken = 0.5 * (left.p_LCom_L + image);
  if (apart_m > kSameCom_m) {
    const double left_off_m = off_centre(left);
    const double right_off_m = off_centre(right);
    // Where one of them is clearly off, such as by a wrong sign, the other is right.
    const bool one_is_off = std::abs(left_off_m - right_off_m) > 0.5 * apart_m;
    if (one_is_off) taken = left_off_m < right_off_m ? left.p_LCom_L : image;
    if (!take_repair(
            {.key = left.name + ".com",
             .found = fmt::format("centres of mass of {} at {} and of {} at {}", left.name,
                                  millimetres(left.p_LCom_L), right.name, millimetres(right.p_LCom_L)),
             .taken = millimetres(taken) +
                      (one_is_off ? ", which is nearer to the middle of its shape, and its mirror image"
                                  : ", the mean, and its mirror image"),
             .because = "left and right are mirror images"},
            interview, report))
      return;
  }
  left.p_LCom_L = taken;
  right.p_LCom_L = mirrored(taken);
}

void pair_limits(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  for (ImportedJoint& left : robot.joints) {
    if (!left.name.starts_with("left_")) continue;
    const auto index = robot.find_joint(mirrored_name(left.name));
    if (!index) continue;
    ImportedJoint& right = robot.joints[static_cast<std::size_t>(*index)];
    // The mirror image of a rotation about y is the same rotation; those about x and z change sign.
    const bool keeps_sign = std::abs(left.axis_L.y()) > 0.5;
    const double sign = left.axis_L.dot(right.axis_L) * (keeps_sign ? 1.0 : -1.0) > 0.0 ? 1.0 : -1.0;
    const double other_lower = sign > 0.0 ? *right.lower_rad : -*right.upper_rad;
    const double other_upper = sign > 0.0 ? *right.upper_rad : -*right.lower_rad;
    const double lower = std::max(*left.lower_rad, other_lower);
    const double upper = std::min(*left.upper_rad, other_upper);
    if (lower >= upper) continue;
    const double apart =
        std::max(std::abs(*left.lower_rad - other_lower), std::abs(*left.upper_rad - other_upper));
    if (apart > kSameLimit_rad &&
        !take_repair(
            {.key = left.name + ".limits",
             .found =
                 fmt::format("{} from {:.1f} to {:.1f} deg, {} from {:.1f} to {:.1f} deg", left.name,
                             kDegreesPerRad * *left.lower_rad, kDegreesPerRad * *left.upper_rad, right.name,
                             kDegreesPerRad * *right.lower_rad, kDegreesPerRad * *right.upper_rad),
             .taken = fmt::format("{:.1f} to {:.1f} deg on the left, the narrower, and its mirror image",
                                  kDegreesPerRad * lower, kDegreesPerRad * upper),
             .because = "left and right are mirror images"},
            interview, report))
      continue;
    left.lower_rad = lower;
    left.upper_rad = upper;
    right.lower_rad = sign > 0.0 ? lower : -upper;
    right.upper_rad = sign > 0.0 ? upper : -lower;
  }
}

void centre_mass(ImportedLink& link, Interview& interview, ImportReport& report) {
  const Eigen::AlignedBox3d extent = extent_of(link);
  if (extent.isEmpty()) return;
  const double beside_m = link.p_LCom_L.y();
  if (std::abs(beside_m) < std::max(kBeside_m, kBesideShare * extent.sizes().y()) ||
      std::abs(extent.center().y()) > kBeside_m)
    return;
  if (take_repair({.key = link.name + ".com",
                   .found = fmt::format("the centre of mass of {} {:.1f} mm beside the mid-plane", link.name,
                                        kMmPerM * std::abs(beside_m)),
                   .taken = "y = 0",
                   .because = "its shape is as wide on the left as on the right"},
                  interview, report))
    link.p_LCom_L.y() = 0.0;
}

}  // namespace

void repair_symmetry(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  if (!interview.yes({"symmetric", "Are left and right mirror images?", "yes", {}})) return;
  for (ImportedLink& left : robot.links) {
    const std::string other = mirrored_name(left.name);
    if (other == left.name) {
      centre_mass(left, interview, report);
      continue;
    }
    ImportedLink* const right = find_link(robot, other);
    if (!left.name.starts_with("left_") || right == nullptr) continue;
    if (copy_known_side(left, *right, interview, report)) continue;
    pair_mass(left, *right, interview, report);
    pair_com(left, *right, interview, report);
    left.I_LCom_L = 0.5 * (left.I_LCom_L + mirrored(right->I_LCom_L));
    right->I_LCom_L = mirrored(left.I_LCom_L);
  }
  pair_limits(robot, interview, report);
}

}  // namespace koboshi::tools
