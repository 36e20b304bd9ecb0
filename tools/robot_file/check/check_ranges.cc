#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/common/model_constants.h"
#include "tools/import/decide/role_joints.h"
#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

constexpr int kSteps = 5;  // of each joint of a pair, from one end of its range to the other

using LinkPair = std::pair<std::size_t, std::size_t>;

struct Contact {
  std::array<std::size_t, 2> joints{};
  std::array<double, 2> angles_rad{};
  double depth_m = 0.0;

  double away_rad() const { return std::hypot(angles_rad[0], angles_rad[1]); }
};

// Turns each two joints of a limb through the ranges that a humanoid uses, with all others at zero, and finds
// the contact of each two links that is nearest to zero.
class RangeSampler {
 public:
  explicit RangeSampler(const sim_board::RobotDescription& robot)
      : robot_(robot), tree_(sim_board::hinge_tree(robot)), angles_rad_(robot.joints.size(), 0.0) {
    for (std::size_t link = 0; link < robot.links.size(); ++link)
      if (!robot.links[link].collisions.empty()) with_boxes_.push_back(link);
  }

  std::map<LinkPair, Contact> contacts() {
    pose();
    for (const std::size_t a : with_boxes_)
      for (const std::size_t b : with_boxes_)
        if (a < b && overlap_m(a, b) > kTouchingBoxes_m) touching_.insert({a, b});  // R007
    for (std::size_t one = 0; one < robot_.joints.size(); ++one)
      for (std::size_t other = 0; other < robot_.joints.size(); ++other)
        if (one != other && tree_.carries(tree_.hinges()[one].child, tree_.hinges()[other].child))
          sample(one, other);
    return std::move(found_);
  }

 private:
  std::array<double, 2> range_rad(std::size_t index) const {
    const sim_board::JointDescription& joint = robot_.joints[index];
    std::array<double, 2> range_rad = usual_range_rad(joint.role());
    int axis = 0;
    joint.axis_M.cwiseAbs().maxCoeff(&axis);
    if (joint.axis_M[axis] < 0.0) range_rad = {-range_rad[1], -range_rad[0]};
    return {std::max(range_rad[0], joint.lower_rad), std::min(range_rad[1], joint.upper_rad)};
  }

  void pose() { tree_.poses(robot_.links.front().X_ML, angles_rad_, X_ML_); }

  double overlap_m(std::size_t a, std::size_t b) const {
    if (tree_.distance(a, b) < sim_board::kMinJointsBetween) return 0.0;
    return tools::overlap_m(robot_.links[a], X_ML_[a], robot_.links[b], X_ML_[b]);
  }

  void sample(std::size_t one, std::size_t other) {
    const std::array<double, 2> first_rad = range_rad(one);
    const std::array<double, 2> second_rad = range_rad(other);
    for (int i = 0; i < kSteps; ++i) {
      angles_rad_[one] = std::lerp(first_rad[0], first_rad[1], i / (kSteps - 1.0));
      for (int k = 0; k < kSteps; ++k) {
        angles_rad_[other] = std::lerp(second_rad[0], second_rad[1], k / (kSteps - 1.0));
        pose();
        find_contacts(one, other);
      }
    }
    angles_rad_[one] = 0.0;
    angles_rad_[other] = 0.0;
  }

  // Looks for contacts between links that both joints move and links that carry both. Contacts with another
  // limb depend on where that one is.
  void find_contacts(std::size_t one, std::size_t other) {
    for (const std::size_t moved : with_boxes_) {
      if (!tree_.carries(tree_.hinges()[other].child, moved)) continue;
      for (const std::size_t still : with_boxes_) {
        if (!tree_.carries(still, tree_.hinges()[one].parent)) continue;
        const LinkPair pair = std::minmax(moved, still);
        if (touching_.contains(pair)) continue;
        const Contact contact{{one, other}, {angles_rad_[one], angles_rad_[other]}, overlap_m(moved, still)};
        if (contact.depth_m <= kTouchingBoxes_m) continue;
        const auto [found, is_new] = found_.try_emplace(pair, contact);
        if (!is_new && contact.away_rad() < found->second.away_rad()) found->second = contact;
      }
    }
  }

  const sim_board::RobotDescription& robot_;
  const mechanics::HingeTree tree_;
  std::vector<std::size_t> with_boxes_;
  std::vector<double> angles_rad_;
  std::vector<Eigen::Isometry3d> X_ML_;
  std::set<LinkPair> touching_;  // at joint angles zero
  std::map<LinkPair, Contact> found_;
};

}  // namespace

void check_ranges(CheckedModel& model) {
  for (const auto& [links, contact] : RangeSampler(model.robot).contacts()) {
    const auto joint = [&](std::size_t i) {
      return fmt::format("{} at {:.0f} deg", model.robot.joints[contact.joints[i]].name,
                         kDegreesPerRad * contact.angles_rad[i]);
    };
    model.warn(
        "R032", model.places.of("link", model.robot.links[links.second].name),
        fmt::format("{} and {} overlapping by {:.1f} mm with {} and {}", model.robot.links[links.first].name,
                    model.robot.links[links.second].name, kMmPerM * contact.depth_m, joint(0), joint(1)),
        "no contact in the range of walking, squats and getting up",
        "Make a box smaller: a joint that a contact holds does not reach its target.");
  }
}

}  // namespace koboshi::tools
