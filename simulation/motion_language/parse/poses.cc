#include "simulation/motion_language/parse/poses.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {
namespace {

using fixed::Angle;
using Support = BodyTargets::Support;

// Tolerance of joint limits: the robot file gives them in radians, the motion in degrees, and rounding may
// differ.
constexpr double kLimitTolerance_deg = 1e-4;
// Longest chain of derived poses, for the stack.
constexpr std::size_t kMaxDerivations = 64;
constexpr double kMaxTarget_mm = 10'000.0;

const std::vector<std::string> kTargetKeys{"trunk",      "com",       "left_foot",
                                           "right_foot", "left_hand", "right_hand"};

double degrees(Angle angle) { return fixed::to_double(angle) * kDegreesPerRad; }
std::string limit_text(const robot::Joint& joint) {
  return degrees_text(fixed::to_double(joint.lower)) + " to " + degrees_text(fixed::to_double(joint.upper));
}

bool is_target(const std::string& key) {
  return std::find(kTargetKeys.begin(), kTargetKeys.end(), key) != kTargetKeys.end();
}

bool is_pose_key(const std::string& key, int version) {
  if (key == "others") return true;
  return version >= 2 && (key == "from" || key == "mirror" || key == "support" || is_target(key));
}

}  // namespace

void mirror_angles(const JointNames& joints, std::vector<std::optional<Angle>>& angles) {
  std::vector<std::optional<Angle>> mirrored(angles.size());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (angles[i]) mirrored[joints.mirror(i)] = joints.mirror_sign(i) < 0 ? -*angles[i] : *angles[i];
  }
  angles = std::move(mirrored);
}

PoseBuilder::PoseBuilder(const JointNames& joints, std::uint32_t allowed, int version, Reader& reader)
    : joints_(joints), allowed_(allowed), version_(version), reader_(reader) {}

void PoseBuilder::read(const YamlNode& poses) {
  if (!reader_.is_map(poses)) return;
  if (poses.items.size() > motion::kMaxPoses) {
    reader_.error(code::kTooMany, Reader::key_place(poses.items[motion::kMaxPoses]),
                  std::to_string(poses.items.size()) + " poses",
                  "at most " + std::to_string(motion::kMaxPoses));
    return;
  }
  for (const YamlNode& node : poses.items) {
    indices_[node.key] = poses_.size();
    poses_.push_back({.name = node.key, .place = Reader::key_place(node)});
    nodes_.push_back(&node);
  }
  states_.assign(poses_.size(), State::kUnread);
  for (std::size_t i = 0; i < nodes_.size(); ++i) resolve(i);
}

void PoseBuilder::resolve(std::size_t index) {
  // A chain of derived poses is read from its far end, without recursion.
  std::vector<std::size_t> chain{index};
  while (states_[chain.back()] == State::kUnread && chain.size() <= kMaxDerivations) {
    const YamlNode* base = nodes_[chain.back()]->find("from");
    if (base == nullptr) base = nodes_[chain.back()]->find("mirror");
    if (base == nullptr || version_ < 2) break;
    const auto found = indices_.find(base->scalar);
    if (found == indices_.end() || states_[found->second] == State::kRead) break;
    if (std::find(chain.begin(), chain.end(), found->second) != chain.end()) {
      reader_.error(code::kCyclicPoses, Reader::value_place(*base),
                    "the pose '" + one_line(base->scalar) + "', which is derived from this one",
                    "a pose that is not");
      for (const std::size_t pose : chain) states_[pose] = State::kRead;
      return;
    }
    chain.push_back(found->second);
  }
  if (chain.size() > kMaxDerivations) {
    reader_.error(code::kTooMany, poses_[index].place, "a chain of more than 64 derived poses",
                  "a shorter one");
    for (const std::size_t pose : chain) states_[pose] = State::kRead;
    return;
  }
  for (auto pose = chain.rbegin(); pose != chain.rend(); ++pose) {
    if (states_[*pose] == State::kRead) continue;
    states_[*pose] = State::kRead;
    build(*nodes_[*pose], poses_[*pose]);
  }
}

PoseSource* PoseBuilder::resolve(const std::string& name, const YamlNode& user, const char* what) {
  const auto found = indices_.find(name);
  if (found != indices_.end()) return &poses_[found->second];
  std::vector<std::string> names;
  for (const auto& [known, index] : indices_) names.push_back(known);
  reader_.error(code::kUnknownPose, Reader::value_place(user), "the pose '" + one_line(name) + "'", what,
                did_you_mean(name, names));
  return nullptr;
}

void PoseBuilder::build(const YamlNode& value, PoseSource& pose) {
  pose.angles.assign(joints_.count(), std::nullopt);
  if (!reader_.is_map(value)) return;
  take_base(value, pose);
  std::uint32_t given = 0;
  for (const YamlNode& item : value.items) {
    if (!is_pose_key(item.key, version_)) set_angles(item, pose, given);
  }
  if (version_ >= 2) set_targets(value, pose, given);
  set_others(value, pose);
}

void PoseBuilder::take_base(const YamlNode& map, PoseSource& pose) {
  if (version_ < 2) return;
  const YamlNode* from = map.find("from");
  const YamlNode* mirrored = map.find("mirror");
  if (from != nullptr && mirrored != nullptr) {
    reader_.error(code::kContradiction, Reader::key_place(*mirrored), "from and mirror in one pose",
                  "one of them");
    return;
  }
  const YamlNode* base = from != nullptr ? from : mirrored;
  if (base == nullptr) return;
  const auto name = reader_.text(*base);
  if (!name) return;
  PoseSource* source = resolve(*name, *base, "one of the poses of this file");
  if (source == nullptr || source->angles.empty()) return;
  source->is_base = true;
  pose.angles = source->angles;
  if (base == mirrored) mirror(*base, pose.angles);
}

void PoseBuilder::mirror(const YamlNode& user, Angles& angles) {
  mirror_angles(joints_, angles);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!angles[i]) continue;
    const robot::Joint& limits = joints_.robot().model.joints[i];
    static_cast<void>(
        is_within_limits(Reader::value_place(user), i, degrees(*angles[i]), " in the mirror image"));
    angles[i] = robot::clamp_to_limits(limits, *angles[i]);
  }
}

// Returns whether the angle is within the joint's limits, or beyond one by less than a step of its encoder,
// as a pose that was read from the robot at its stop can be: of that it warns.
bool PoseBuilder::is_within_limits(const Place& place, std::size_t joint, double angle_deg,
                                   const std::string& where) {
  const robot::Joint& limits = joints_.robot().model.joints[joint];
  const double beyond_deg = std::max(degrees(limits.lower) - angle_deg, angle_deg - degrees(limits.upper));
  if (beyond_deg <= kLimitTolerance_deg) return true;
  const std::string& name = joints_.name(joint);
  const std::string found = number_text(std::round(angle_deg * 1e4) / 1e4) + " degrees for " + name + where;
  if (beyond_deg < joints_.robot().encoder_steps_rad[joint] * kDegreesPerRad) {
    reader_.diagnostics().add({.code = code::kClamped,
                               .severity = Severity::kWarning,
                               .place = place,
                               .found = found + ", less than a step of its encoder beyond the limit",
                               .expected = limit_text(limits) + "; the limit is taken"});
    return true;
  }
  reader_.error(code::kBeyondLimits, place, found, limit_text(limits), {}, "the limits of " + name);
  return false;
}

// Sets one joint by its name, or both sides by the name without the side; the right joint then mirrors the
// left.
void PoseBuilder::set_angles(const YamlNode& item, PoseSource& pose, std::uint32_t& given) {
  const auto joint = joints_.find(item.key);
  const auto left = joints_.find_left(item.key);
  if (!joint && !left) {
    reader_.error(code::kUnknownJoint, Reader::key_place(item), "the joint '" + one_line(item.key) + "'",
                  "a joint of " + joints_.robot().robot, did_you_mean(item.key, joints_.all(false)));
    return;
  }
  const auto angle_deg = reader_.number(item);
  if (!angle_deg) return;
  if (joint) return set_angle(item, *joint, *angle_deg, pose, given);
  set_angle(item, *left, *angle_deg, pose, given);
  const std::size_t right = joints_.mirror(*left);  // the same where one motor turns both sides
  if (right != *left) set_angle(item, right, *angle_deg * joints_.mirror_sign(*left), pose, given);
}

void PoseBuilder::set_angle(const YamlNode& item, std::size_t joint, double angle_deg, PoseSource& pose,
                            std::uint32_t& given) {
  const robot::Joint& limits = joints_.robot().model.joints[joint];
  const std::string& name = joints_.name(joint);
  if ((given >> joint & 1u) != 0) {
    reader_.error(code::kSecondAngle, Reader::key_place(item), "a second angle for " + name,
                  "one angle a joint");
    return;
  }
  given |= 1u << joint;
  if ((allowed_ >> joint & 1u) == 0) {
    reader_.error(code::kJointNotListed, Reader::key_place(item), "an angle for " + name,
                  "a joint of the list `joints` of this file");
    return;
  }
  if (!is_within_limits(Reader::value_place(item), joint, angle_deg, "")) return;
  pose.angles[joint] = robot::clamp_to_limits(limits, fixed::from_double<Angle>(angle_deg * kRadPerDegree));
}

void PoseBuilder::set_others(const YamlNode& map, PoseSource& pose) {
  const YamlNode* others = map.find("others");
  if (others == nullptr) return;
  const auto value = reader_.one_of(*others, {"hold", "zero"});
  if (!value || *value == "hold") return;
  for (std::size_t i = 0; i < pose.angles.size(); ++i) {
    if (pose.angles[i] || (allowed_ >> i & 1u) == 0) continue;
    const robot::Joint& limits = joints_.robot().model.joints[i];
    if (robot::clamp_to_limits(limits, Angle()) != Angle()) {
      reader_.error(code::kBeyondLimits, Reader::key_place(*others), "0 degrees for " + joints_.name(i),
                    limit_text(limits), {}, "the limits of " + joints_.name(i));
    }
    pose.angles[i] = robot::clamp_to_limits(limits, Angle());
  }
}

Support PoseBuilder::read_support(const YamlNode& map) {
  const YamlNode* support = map.find("support");
  if (support == nullptr) return Support::kBoth;
  const auto name = reader_.one_of(*support, {"left", "right", "both"});
  return !name || *name == "both" ? Support::kBoth : *name == "left" ? Support::kLeft : Support::kRight;
}

Target PoseBuilder::read_target(const YamlNode& map, const std::string& key, bool with_angles) {
  static const std::vector<std::string> kPositions{"x_mm", "y_mm", "z_mm"};
  static const std::vector<std::string> kAngles{"roll_deg", "pitch_deg", "yaw_deg"};
  Target target;
  const YamlNode* node = map.find(key);
  if (node == nullptr || !reader_.is_map(*node)) return target;
  std::vector<std::string> known = kPositions;
  if (with_angles) known.insert(known.end(), kAngles.begin(), kAngles.end());
  reader_.check_keys(*node, known);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (const YamlNode* value = node->find(kPositions[axis])) {
      if (const auto mm = reader_.number(*value, {.min = -kMaxTarget_mm, .max = kMaxTarget_mm}))
        target.position_m[axis] = *mm / kMmPerM;
    }
    if (!with_angles) continue;
    if (const YamlNode* value = node->find(kAngles[axis])) {
      if (const auto deg = reader_.number(*value, {.min = -180.0, .max = 180.0}))
        target.rpy_rad[axis] = *deg * kRadPerDegree;
    }
  }
  return target;
}

bool PoseBuilder::check_targets(const YamlNode& map, const BodyTargets& targets) {
  const std::size_t errors = reader_.diagnostics().error_count();
  const auto refuse = [&](const std::string& key, const std::string& found, const std::string& expected) {
    const YamlNode* node = map.find(key);
    reader_.error(code::kBadTarget, Reader::key_place(node == nullptr ? map : *node), found, expected);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (targets.trunk.position_m[axis] && targets.com.position_m[axis])
      refuse("com", "a coordinate of both trunk and com", "it for one of them: the trunk moves the com");
  }
  if (targets.support == Support::kLeft && targets.feet[0].is_given())
    refuse("left_foot", "a target for the support foot", "targets for other parts, or support: right");
  if (targets.support == Support::kRight && targets.feet[1].is_given())
    refuse("right_foot", "a target for the support foot", "targets for other parts, or support: left");
  return reader_.diagnostics().error_count() == errors;
}

void PoseBuilder::set_targets(const YamlNode& map, PoseSource& pose, std::uint32_t given) {
  const std::size_t errors = reader_.diagnostics().error_count();
  BodyTargets targets{.support = read_support(map),
                      .trunk = read_target(map, "trunk", true),
                      .com = read_target(map, "com", false),
                      .feet = {read_target(map, "left_foot", true), read_target(map, "right_foot", true)},
                      .hands = {read_target(map, "left_hand", false), read_target(map, "right_hand", false)}};
  const bool has_hand = targets.hands[0].is_given() || targets.hands[1].is_given();
  if (!targets.moves_legs() && !has_hand) {
    if (const YamlNode* support = map.find("support"))
      reader_.error(code::kBadTarget, Reader::key_place(*support), "support without a target",
                    "trunk, com, a foot or a hand with it");
    return;
  }
  if (!check_targets(map, targets) || reader_.diagnostics().error_count() != errors) return;
  std::vector<Angle> angles(joints_.count());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    angles[i] = pose.angles[i].value_or(robot::clamp_to_limits(joints_.robot().model.joints[i], Angle()));
  }
  const BodySolution solution = solve_targets(joints_.robot(), targets, angles);
  if (!solution.unreached.empty()) return report_unreached(map, solution);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if ((solution.joints >> i & 1u) == 0) continue;
    if ((given >> i & 1u) != 0 || (allowed_ >> i & 1u) == 0) {
      const bool twice = (given >> i & 1u) != 0;
      reader_.error(twice ? code::kSecondAngle : code::kJointNotListed, pose.place,
                    twice ? "an angle for " + joints_.name(i) + ", which the targets determine"
                          : "targets that move " + joints_.name(i),
                    twice ? "an angle or a target" : "joints of the list `joints` of this file");
      return;
    }
    pose.angles[i] = solution.angles[i];
  }
}

void PoseBuilder::report_unreached(const YamlNode& map, const BodySolution& solution) {
  // A foot is out of reach because of the trunk or the centre of mass, unless it has a target of its own.
  const YamlNode* node = map.find(solution.unreached);
  for (const char* key : {"trunk", "com", "left_foot", "right_foot"}) {
    if (node == nullptr) node = map.find(key);
  }
  std::string found = "a target of " + solution.unreached + " that is out of reach";
  if (std::isfinite(solution.missing_m)) found += fmt::format(" by {:.1f} mm", solution.missing_m * kMmPerM);
  if (solution.missing_rad > 1e-3)
    found += fmt::format(" and {:.1f} degrees", solution.missing_rad * kDegreesPerRad);
  reader_.error(code::kUnreachable, Reader::key_place(node == nullptr ? map : *node), found,
                "a target within the limits of the joints", {}, "the reach of " + solution.unreached);
}

std::size_t PoseBuilder::add(PoseSource pose) {
  std::vector<std::int64_t> key;
  for (const auto& angle : pose.angles) key.push_back(angle ? angle->raw() : std::int64_t{1} << 40);
  const auto [place, is_new] = by_angles_.emplace(std::move(key), poses_.size());
  if (is_new) poses_.push_back(std::move(pose));
  return place->second;
}

std::optional<std::size_t> PoseBuilder::pose_of_step(const YamlNode& value, bool mirrored) {
  std::size_t index = 0;
  if (value.kind == YamlNode::Kind::kMap && version_ >= 2) {
    PoseSource pose{.name = {}, .place = Reader::value_place(value)};
    const std::size_t errors = reader_.diagnostics().error_count();
    build(value, pose);
    if (reader_.diagnostics().error_count() != errors) return std::nullopt;
    if (std::none_of(pose.angles.begin(), pose.angles.end(),
                     [](const auto& angle) { return angle.has_value(); })) {
      reader_.error(code::kEmptyPose, pose.place, "a pose without a joint", "at least one joint");
      return std::nullopt;
    }
    index = add(std::move(pose));
  } else {
    const auto name = reader_.text(value);
    if (!name || resolve(*name, value, "one of the poses of this file") == nullptr) return std::nullopt;
    index = indices_[*name];
  }
  if (!mirrored) return index;
  if (const auto known = mirrored_.find(index); known != mirrored_.end()) return known->second;
  PoseSource image{.name = {}, .place = Reader::value_place(value), .angles = poses_[index].angles};
  if (image.angles.empty()) return std::nullopt;  // an error was reported
  mirror(value, image.angles);
  return mirrored_[index] = add(std::move(image));
}

}  // namespace koboshi::simulation
