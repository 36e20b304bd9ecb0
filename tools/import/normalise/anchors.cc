#include "tools/import/normalise/anchors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

constexpr double kRounding_m = 1e-9;
constexpr double kMicron_m = 1e-6;  // the steps in which a file writes lengths

bool is_along(const Vector3d& axis, int index) { return axis == Vector3d::Unit(index); }

class Aligner {
 public:
  Aligner(JointAnchors& anchors, double max_miss_m, ImportReport& report)
      : anchors_(anchors), max_miss_m_(max_miss_m), report_(report) {}

  std::optional<std::size_t> find(const std::string& name) const {
    const auto found = std::ranges::find(anchors_.names, name);
    if (found == anchors_.names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - anchors_.names.begin());
  }
  Vector3d& point(std::size_t joint) { return anchors_.points_m[joint]; }

  // The plane midway between joints of both sides. Returns its y.
  double find_middle() {
    std::vector<double> middles;
    for (const std::string& name : anchors_.names) {
      if (!name.starts_with("left_")) continue;
      const auto left = find(name);
      const auto right = find(mirrored_name(name));
      if (left && right) middles.push_back(0.5 * (point(*left).y() + point(*right).y()));
    }
    if (middles.empty()) return 0.0;
    std::ranges::nth_element(middles, middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2));
    return middles[middles.size() / 2];
  }

  void align_leg(const std::string& side) {
    const auto hip = triple(side, {"hip_yaw", "hip_roll", "hip_pitch"});
    if (!hip || !align_hip(*hip)) return;
    const auto lower = triple(side, {"knee", "ankle_pitch", "ankle_roll"});
    if (!lower) return;
    const std::size_t yaw = (*hip)[0];
    const auto [knee, ankle_pitch, ankle_roll] = *lower;
    const double leg_y = point(yaw).y();
    for (const std::size_t joint : {knee, ankle_pitch})
      if (is_along(anchors_.axes[joint], 1)) slide_to({point(joint).x(), leg_y, point(joint).z()}, {joint});
    if (!is_along(anchors_.axes[ankle_pitch], 1) || !is_along(anchors_.axes[ankle_roll], 0)) return;
    const std::optional<double> ankle_z = crossing_of(ankle_pitch, ankle_roll, 2);
    const double beside_m = point(ankle_roll).y() - leg_y;
    if (std::abs(beside_m) > max_miss_m_) {
      warn_miss(anchors_.names[ankle_roll], anchors_.names[yaw], beside_m, 1);
      slide_to({point(ankle_pitch).x(), point(ankle_roll).y(), point(ankle_roll).z()}, {ankle_roll});
    } else if (ankle_z) {
      report_miss(anchors_.names[ankle_roll], anchors_.names[yaw], beside_m, 1);
      slide_to({point(ankle_pitch).x(), leg_y, *ankle_z}, {ankle_pitch, ankle_roll});
    }
  }

  // A pitch and a roll axis in the shoulder, where they meet.
  void align_shoulder(const std::string& side) {
    const auto pitch = find(side + "shoulder_pitch");
    const auto roll = find(side + "shoulder_roll");
    if (!pitch || !roll || !is_along(anchors_.axes[*pitch], 1) || !is_along(anchors_.axes[*roll], 0)) return;
    if (std::abs(point(*pitch).z() - point(*roll).z()) > max_miss_m_) return;
    const double z = *crossing_of(*pitch, *roll, 2);
    slide_to({point(*pitch).x(), point(*roll).y(), z}, {*pitch, *roll});
  }

  void mirror_pairs() {
    for (const std::string& name : anchors_.names) {
      if (!name.starts_with("left_")) continue;
      const auto left = find(name);
      const auto right = find(mirrored_name(name));
      if (!right) continue;
      const Vector3d image(point(*right).x(), -point(*right).y(), point(*right).z());
      // Along the hinge both anchors may be anywhere: a bracket that is the same part on both sides has its
      // horn in front on one of them.
      const Vector3d miss = point(*left) - image;
      const Vector3d& axis = anchors_.axes[*left];
      const double along_m = miss.dot(axis);
      const double miss_m = (miss - along_m * axis).norm();
      if (miss_m > max_miss_m_) {
        report_.warnings.push_back(fmt::format("{} and {}: anchors {:.2f} mm from mirror images", name,
                                               anchors_.names[*right], kMmPerM * miss_m));
        continue;
      }
      if (miss.norm() > kRounding_m)
        report_.normalised.push_back(fmt::format("{} and {}: anchors made mirror images, {:.3g} mm apart",
                                                 name, anchors_.names[*right], kMmPerM * miss.norm()));
      point(*left) = 0.5 * (point(*left) + image);
      round(*left);
      point(*right) = {point(*left).x(), -point(*left).y(), point(*left).z()};
    }
  }

  void centre_middle_joints() {
    for (std::size_t i = 0; i < anchors_.names.size(); ++i) {
      if (mirrored_name(anchors_.names[i]) != anchors_.names[i]) continue;
      const double miss_m = point(i).y();
      if (std::abs(miss_m) <= max_miss_m_ || is_along(anchors_.axes[i], 1)) {
        if (std::abs(miss_m) > kRounding_m)
          report_.normalised.push_back(fmt::format("{}: anchor moved by {:.3g} mm to the mid-plane",
                                                   anchors_.names[i], kMmPerM * miss_m));
        point(i).y() = 0.0;
      }
    }
  }

  void round_all() {
    for (std::size_t i = 0; i < anchors_.points_m.size(); ++i) round(i);
  }

 private:
  // Lets the axes of a hip meet; false if they are not along those of the base.
  bool align_hip(const std::array<std::size_t, 3>& hip) {
    const auto [yaw, roll, pitch] = hip;
    if (!is_along(anchors_.axes[yaw], 2) || !is_along(anchors_.axes[roll], 0) ||
        !is_along(anchors_.axes[pitch], 1))
      return false;
    // A hinge fixes the two coordinates across it.
    const std::optional<double> x = crossing_of(yaw, pitch, 0);
    const std::optional<double> y = crossing_of(yaw, roll, 1);
    const std::optional<double> z = crossing_of(roll, pitch, 2);
    if (x && y && z)
      slide_to({*x, *y, *z}, {yaw, roll, pitch});
    else
      slide_along(yaw, roll, pitch);
    return true;
  }

  std::optional<std::array<std::size_t, 3>> triple(const std::string& side,
                                                   const std::array<const char*, 3>& roles) const {
    std::array<std::size_t, 3> joints{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto joint = find(side + roles[i]);
      if (!joint) return std::nullopt;
      joints[i] = *joint;
    }
    return joints;
  }

  void round(std::size_t joint) {
    for (double& value : point(joint)) value = std::round(value / kMicron_m) * kMicron_m;
  }

  // The coordinate in which two hinges meet, midway between them; nothing if they miss by too much.
  std::optional<double> crossing_of(std::size_t one, std::size_t other, int index) {
    const double miss_m = point(other)[index] - point(one)[index];
    if (std::abs(miss_m) > max_miss_m_) {
      warn_miss(anchors_.names[one], anchors_.names[other], miss_m, index);
      return std::nullopt;
    }
    report_miss(anchors_.names[one], anchors_.names[other], miss_m, index);
    return 0.5 * (point(one)[index] + point(other)[index]);
  }

  void slide_to(const Vector3d& to, std::initializer_list<std::size_t> joints) {
    for (const std::size_t joint : joints) {
      const double along_m = (to - point(joint)).dot(anchors_.axes[joint]);
      if (std::abs(along_m) > kRounding_m)
        report_.normalised.push_back(fmt::format("{}: anchor slid by {:.3f} mm along its axis",
                                                 anchors_.names[joint], kMmPerM * along_m));
      point(joint) = to;
    }
  }

  // Hips whose axes do not meet: each anchor slides along its own hinge to where it is nearest to the others,
  // so that left and right, of which only one may miss by too much, stay mirror images.
  void slide_along(std::size_t yaw, std::size_t roll, std::size_t pitch) {
    slide_to({point(yaw).x(), point(yaw).y(), point(pitch).z()}, {yaw});
    slide_to({point(yaw).x(), point(roll).y(), point(roll).z()}, {roll});
    slide_to({point(pitch).x(), point(yaw).y(), point(pitch).z()}, {pitch});
  }

  void report_miss(const std::string& one, const std::string& other, double miss_m, int index) {
    if (std::abs(miss_m) <= kRounding_m) return;
    report_.normalised.push_back(fmt::format("{} and {}: axes made to meet, {:.3g} mm apart in {}", one,
                                             other, kMmPerM * std::abs(miss_m), "xyz"[index]));
  }
  // Axes that are far apart are meant to be: the firmware then finds the leg's angles in steps.
  void warn_miss(const std::string& one, const std::string& other, double miss_m, int index) {
    constexpr double kDesigned_m = 0.005;
    const bool is_designed = std::abs(miss_m) > std::max(kDesigned_m, max_miss_m_);
    (is_designed ? report_.normalised : report_.warnings)
        .push_back(fmt::format("{} and {}: axes {:.2f} mm apart in {}{}", one, other,
                               kMmPerM * std::abs(miss_m), "xyz"[index],
                               is_designed ? "; they stay there" : ", more than max_miss_mm"));
  }

  JointAnchors& anchors_;
  double max_miss_m_;
  ImportReport& report_;
};

}  // namespace

Vector3d align_anchors(JointAnchors& anchors, double max_miss_m, ImportReport& report) {
  Vector3d p_MB = Vector3d::Zero();
  Aligner aligner(anchors, max_miss_m, report);
  const double middle_m = aligner.find_middle();
  if (std::abs(middle_m) > kRounding_m)
    report.normalised.push_back(fmt::format("mid-plane found at y = {:.4g} mm", kMmPerM * middle_m));
  const auto move_origin = [&anchors, &p_MB](const Vector3d& by) {
    p_MB += by;
    for (Vector3d& point : anchors.points_m) point -= by;
  };
  move_origin({0.0, middle_m, 0.0});
  aligner.align_leg("left_");
  aligner.align_leg("right_");
  aligner.align_shoulder("left_");
  aligner.align_shoulder("right_");
  // The base: midway between the hips.
  const auto left = aligner.find("left_hip_pitch");
  const auto right = aligner.find("right_hip_pitch");
  if (left && right) {
    const Vector3d middle = 0.5 * (aligner.point(*left) + aligner.point(*right));
    move_origin({middle.x(), 0.0, middle.z()});
  }
  aligner.mirror_pairs();
  aligner.centre_middle_joints();
  aligner.round_all();
  return p_MB;
}

}  // namespace koboshi::tools
