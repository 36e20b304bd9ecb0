#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/description/schema/roles.h"
#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

// Left and right are compared in what a file with four digits can say.
constexpr double kSameLength_m = 2e-5;
constexpr double kSameShare = 1e-3;
constexpr double kSameAngle_rad = 2e-3;

Vector3d mirrored(const Vector3d& p) { return {p.x(), -p.y(), p.z()}; }

Eigen::Matrix3d mirrored(const Eigen::Matrix3d& tensor) {
  const Vector3d flip(1.0, -1.0, 1.0);
  return flip.asDiagonal() * tensor * flip.asDiagonal();
}

bool same_share(double a, double b) {
  return std::abs(a - b) <= kSameShare * std::max(std::abs(a), std::abs(b));
}

std::string text_of(const Vector3d& p_m) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", kMmPerM * p_m.x(), kMmPerM * p_m.y(), kMmPerM * p_m.z());
}

// A difference of the right element from the mirror image of the left one.
void differ(CheckedModel& model, const ModelPlace& place, const std::string& left, const std::string& right,
            const std::string& what, const std::string& found, const std::string& expected) {
  model.warn("R003", place, fmt::format("{} of {}: {}", what, right, found),
             fmt::format("{}, the mirror image of {}", expected, left),
             "Set both sides, or say why they differ in a comment.");
}

void compare_links(CheckedModel& model, const sim_board::LinkDescription& left,
                   const sim_board::LinkDescription& right) {
  const Vector3d origin_m = mirrored(Vector3d(left.X_ML.translation()));
  if ((right.X_ML.translation() - origin_m).norm() > kSameLength_m)
    differ(model, model.places.of("link", right.name), left.name, right.name, "the position",
           text_of(right.X_ML.translation()), text_of(origin_m));
  if (!same_share(left.mass_kg, right.mass_kg))
    differ(model, model.places.of("link", right.name, "inertial"), left.name, right.name, "the mass",
           fmt::format("{:.4g} kg", right.mass_kg), fmt::format("{:.4g} kg", left.mass_kg));
  // Centre of mass and inertia in the axes of the model.
  const Vector3d com_m = mirrored(Vector3d(left.X_ML * left.p_LCom_L));
  if ((right.X_ML * right.p_LCom_L - com_m).norm() > kSameLength_m)
    differ(model, model.places.of("link", right.name, "inertial"), left.name, right.name,
           "the centre of mass", text_of(right.X_ML * right.p_LCom_L), text_of(com_m));
  const auto in_model = [](const sim_board::LinkDescription& link) -> Eigen::Matrix3d {
    return link.X_ML.linear() * link.I_LCom_L * link.X_ML.linear().transpose();
  };
  const Eigen::Matrix3d inertia = mirrored(in_model(left));
  if ((in_model(right) - inertia).norm() > kSameShare * inertia.norm())
    differ(model, model.places.of("link", right.name, "inertial"), left.name, right.name, "the inertia",
           fmt::format("{:.3g} kg m^2 on the diagonal", right.I_LCom_L.trace()),
           fmt::format("{:.3g} kg m^2", left.I_LCom_L.trace()));
}

void check_links(CheckedModel& model) {
  for (const sim_board::LinkDescription& left : model.robot.links) {
    if (!left.name.starts_with("left_")) continue;
    const std::string name = "right_" + left.name.substr(5);
    const auto index = model.robot.find_link(name);
    if (!index) {
      model.warn("R003", model.places.of("link", left.name), "no " + name,
                 "the mirror image of " + left.name);
      continue;
    }
    compare_links(model, left, model.robot.links[static_cast<std::size_t>(*index)]);
  }
  // Links with other names are on the side of the joints that carry them.
  for (std::size_t i = 0; i < model.robot.joints.size(); ++i) {
    const sim_board::JointDescription& joint = model.robot.joints[i];
    const auto mirror = static_cast<std::size_t>(model.robot.mirror_of(static_cast<int>(i)));
    if (!joint.role().starts_with("left_") || mirror == i) continue;
    const auto link_of = [&](std::size_t of) -> const sim_board::LinkDescription& {
      return model.robot.links[static_cast<std::size_t>(model.robot.joints[of].child)];
    };
    if (!link_of(i).name.starts_with("left_")) compare_links(model, link_of(i), link_of(mirror));
  }
}

void compare_joints(CheckedModel& model, const sim_board::JointDescription& left,
                    const sim_board::JointDescription& right) {
  const ModelPlace& place = model.places.of("joint", right.name);
  if ((right.p_MJ - mirrored(left.p_MJ)).norm() > kSameLength_m)
    differ(model, place, left.name, right.name, "the position", text_of(right.p_MJ),
           text_of(mirrored(left.p_MJ)));
  // A robot may have its right joints turn as the mirror image, or about the same axis.
  const Vector3d image = sim_board::mirrored_axis(left.axis_M);
  const bool same = (right.axis_M - image).norm() < kSameAngle_rad;
  const bool opposite = (right.axis_M + image).norm() < kSameAngle_rad;
  if (!same && !opposite) {
    differ(model, place, left.name, right.name, "the axis",
           fmt::format("({:.3g}, {:.3g}, {:.3g})", right.axis_M.x(), right.axis_M.y(), right.axis_M.z()),
           fmt::format("({:.3g}, {:.3g}, {:.3g})", image.x(), image.y(), image.z()));
    return;
  }
  const double lower_rad = same ? left.lower_rad : -left.upper_rad;
  const double upper_rad = same ? left.upper_rad : -left.lower_rad;
  if (std::abs(right.lower_rad - lower_rad) > kSameAngle_rad ||
      std::abs(right.upper_rad - upper_rad) > kSameAngle_rad)
    differ(model, place, left.name, right.name, "the limits",
           fmt::format("{:.1f} to {:.1f} deg", kDegreesPerRad * right.lower_rad,
                       kDegreesPerRad * right.upper_rad),
           fmt::format("{:.1f} to {:.1f} deg", kDegreesPerRad * lower_rad, kDegreesPerRad * upper_rad));
}

void check_joints(CheckedModel& model) {
  for (std::size_t i = 0; i < model.robot.joints.size(); ++i) {
    const sim_board::JointDescription& left = model.robot.joints[i];
    if (!left.role().starts_with("left_")) continue;
    const auto mirror = static_cast<std::size_t>(model.robot.mirror_of(static_cast<int>(i)));
    if (mirror == i && model.robot.mirrored_follower(static_cast<int>(i)) != nullptr) {
      compare_joints(model, left, model.robot.mirrored_follower(static_cast<int>(i))->hinge);
      continue;
    }
    if (mirror == i) {
      model.warn("R003", model.places.of("joint", left.name), "no " + sim_board::other_side(left.role()),
                 "the mirror image of " + left.name);
      continue;
    }
    compare_joints(model, left, model.robot.joints[mirror]);
  }
}

}  // namespace

void check_sides(CheckedModel& model) {
  check_links(model);
  check_joints(model);
}

}  // namespace koboshi::tools
