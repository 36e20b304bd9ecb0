#include "tools/motion_files/joint_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <set>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "base/yaml/yaml_reader.h"
#include "tools/motion_files/joint_map_file.h"

namespace koboshi::tools {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

// --- Names

// The words of a name in lower case: "LHipYawPitch", "l_hip_pitch_joint" and "left-hip-pitch" are all words.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words{""};
  char last = '_';
  for (const char c : name) {
    const bool upper = c >= 'A' && c <= 'Z';
    const bool lower = c >= 'a' && c <= 'z';
    const bool digit = c >= '0' && c <= '9';
    const bool after_lower = last >= 'a' && last <= 'z';
    const bool after_side = words.back() == "l" || words.back() == "r";
    if (!(upper || lower || digit) || (upper && (after_lower || after_side))) {
      if (!words.back().empty()) words.emplace_back();
    }
    if (upper || lower || digit) words.back() += upper ? static_cast<char>(c + 32) : c;
    last = c;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

// Returns the word of the roles in sim_board/description/roles.h that means the same; empty if none does.
std::string meaning(const std::string& word) {
  struct Synonym {
    std::string_view word, meaning;
  };
  constexpr std::array<Synonym, 20> kSynonyms{
      {{"l", "left"},     {"r", "right"},     {"sho", "shoulder"}, {"shoulder", "shoulder"},
       {"el", "elbow"},   {"arm", "arm"},     {"neck", "head"},    {"calf", "knee"},
       {"kne", "knee"},   {"ank", "ankle"},   {"foot", "ankle"},   {"leg", ""},
       {"joint", ""},     {"servo", ""},      {"motor", ""},       {"j", ""},
       {"swing", "roll"}, {"torso", "waist"}, {"trunk", "waist"},  {"thigh", "thigh"}}};
  for (const Synonym& synonym : kSynonyms) {
    if (synonym.word == word) return std::string(synonym.meaning);
  }
  return word;
}

// The meaning of a name as a role: "l_hip_pitch_joint" is left_hip_pitch, "head_yaw" is head_pan.
std::string role_meant(const std::string& name) {
  std::set<std::string> words;
  for (const std::string& word : words_of(name)) {
    if (const std::string meant = meaning(word); !meant.empty()) words.insert(meant);
  }
  const auto swap = [&](const char* part, const char* from, const char* to) {
    if (words.contains(part) && words.erase(from) > 0) words.insert(to);
  };
  swap("head", "yaw", "pan");
  swap("head", "pitch", "tilt");
  if (words.contains("knee")) words.erase("pitch");
  if (words.contains("elbow")) {
    words.erase("pitch");
    words.erase("roll");
  }
  std::string role;
  for (const char* word : {"left", "right", "head", "waist", "shoulder", "elbow", "hip", "knee", "ankle",
                           "pan", "tilt", "yaw", "roll", "pitch"}) {
    if (words.erase(word) > 0) role += (role.empty() ? "" : "_") + std::string(word);
  }
  return words.empty() ? role : std::string();
}

std::optional<std::size_t> joint_with_name(const std::string& name,
                                           const sim_board::RobotDescription& robot) {
  if (const auto joint = robot.find_joint(name)) return static_cast<std::size_t>(*joint);
  const std::string meant = role_meant(name);
  std::optional<std::size_t> found;
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    const std::string& own = robot.joints[joint].name;
    if (meant.empty() || (robot.joints[joint].role() != meant && role_meant(own) != meant)) continue;
    if (found) return std::nullopt;
    found = joint;
  }
  return found;
}

// Joints of DARwIn-OP (ROBOTIS OP2) by their names in Webots and in public URDF files. Its motors mirror each
// other; the signs of the legs are those with which its walking pose has level soles.
struct KnownJoint {
  std::string_view webots, urdf, role;
  double sign;
};
constexpr std::array<KnownJoint, 20> kDarwin{{{"ShoulderR", "j_shoulder_r", "right_shoulder_pitch", 1.0},
                                              {"ShoulderL", "j_shoulder_l", "left_shoulder_pitch", -1.0},
                                              {"ArmUpperR", "j_high_arm_r", "right_shoulder_roll", 1.0},
                                              {"ArmUpperL", "j_high_arm_l", "left_shoulder_roll", 1.0},
                                              {"ArmLowerR", "j_low_arm_r", "right_elbow", -1.0},
                                              {"ArmLowerL", "j_low_arm_l", "left_elbow", 1.0},
                                              {"PelvYR", "j_pelvis_r", "right_hip_yaw", -1.0},
                                              {"PelvYL", "j_pelvis_l", "left_hip_yaw", -1.0},
                                              {"PelvR", "j_thigh1_r", "right_hip_roll", -1.0},
                                              {"PelvL", "j_thigh1_l", "left_hip_roll", -1.0},
                                              {"LegUpperR", "j_thigh2_r", "right_hip_pitch", 1.0},
                                              {"LegUpperL", "j_thigh2_l", "left_hip_pitch", -1.0},
                                              {"LegLowerR", "j_tibia_r", "right_knee", 1.0},
                                              {"LegLowerL", "j_tibia_l", "left_knee", -1.0},
                                              {"AnkleR", "j_ankle1_r", "right_ankle_pitch", -1.0},
                                              {"AnkleL", "j_ankle1_l", "left_ankle_pitch", 1.0},
                                              {"FootR", "j_ankle2_r", "right_ankle_roll", 1.0},
                                              {"FootL", "j_ankle2_l", "left_ankle_roll", 1.0},
                                              {"Neck", "j_pan", "head_pan", 1.0},
                                              {"Head", "j_tilt", "head_tilt", -1.0}}};

std::optional<MappedJoint> of_known_robot(const std::string& name, const sim_board::RobotDescription& robot) {
  for (const KnownJoint& known : kDarwin) {
    if (name != known.webots && name != known.urdf) continue;
    const auto joint = robot.find_joint(std::string(known.role));
    if (joint) return MappedJoint{static_cast<std::size_t>(*joint), known.sign};
  }
  return std::nullopt;
}

// --- Servos by number

std::optional<MappedJoint> by_maker(const ForeignJoint& joint, bool ticks,
                                    const sim_board::RobotDescription& robot) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const auto& maker = robot.joints[i].maker;
    if (!maker || !joint.servo_id || maker->servo_id != *joint.servo_id) continue;
    const double unit_rad = ticks ? kTurn_rad / maker->ticks_per_turn : 1.0;
    return MappedJoint{i, static_cast<double>(maker->sign), ticks ? maker->zero_ticks : 0.0, unit_rad};
  }
  return std::nullopt;
}

// --- Names of the imported file

// Joints of the robot by their names in the file from which it was imported; empty for another robot.
std::vector<std::pair<std::string, std::string>> source_names(const sim_board::RobotDescription& robot) {
  const std::filesystem::path decisions = robot.file.parent_path() / "import.yaml";
  std::error_code missing;
  std::vector<std::pair<std::string, std::string>> names;
  if (!std::filesystem::is_regular_file(decisions, missing)) return names;
  const YamlFile file(decisions);
  if (const auto joints = file.root().optional_child("joints")) {
    for (const auto& [joint, source] : joints->entries()) names.emplace_back(source.text(), joint);
  }
  return names;
}

std::optional<MappedJoint> by_source(const std::string& name,
                                     const std::vector<std::pair<std::string, std::string>>& names,
                                     const sim_board::RobotDescription& robot) {
  for (const auto& [source, own] : names) {
    const auto joint = source == name ? robot.find_joint(own) : std::nullopt;
    if (!joint) continue;
    const auto place = static_cast<std::size_t>(*joint);
    const sim_board::DriveDescription& drive = robot.joints[place].drive;
    return MappedJoint{place, static_cast<double>(drive.sign), drive.zero_rad, 1.0};
  }
  return std::nullopt;
}

// --- Signs that nothing states

// By how much the angles of a joint of the file are beyond the limits, in sum, in rad.
double beyond_limits_rad(const ForeignMotion& motion, std::size_t column, double sign,
                         const sim_board::JointDescription& joint) {
  double sum_rad = 0.0;
  for (const ForeignSection& section : motion.sections) {
    for (const ForeignFrame& frame : section.frames) {
      if (!frame.values[column]) continue;
      const double angle_rad = sign * *frame.values[column];
      sum_rad += std::max({0.0, joint.lower_rad - angle_rad, angle_rad - joint.upper_rad});
    }
  }
  return sum_rad;
}

// A leg whose three joints about y are known, with their columns in the file.
struct PitchColumns {
  std::array<std::size_t, 3> column{};  // hip, knee, ankle
  std::array<double, 3> axis{};         // 1 or -1: the direction of the robot's axis along y
};

std::optional<PitchColumns> pitch_columns(const JointMap& map, const sim_board::RobotDescription& robot,
                                          const std::string& side) {
  constexpr std::array<const char*, 3> kPitch{"_hip_pitch", "_knee", "_ankle_pitch"};
  PitchColumns leg;
  for (std::size_t i = 0; i < kPitch.size(); ++i) {
    const auto joint = robot.find_joint(side + kPitch.at(i));
    if (!joint) return std::nullopt;
    const auto found = std::ranges::find_if(map.joints, [&](const auto& mapped) {
      return mapped && mapped->joint == static_cast<std::size_t>(*joint);
    });
    if (found == map.joints.end()) return std::nullopt;
    leg.column.at(i) = static_cast<std::size_t>(found - map.joints.begin());
    leg.axis.at(i) = robot.joints[static_cast<std::size_t>(*joint)].axis_M.y() < 0.0 ? -1.0 : 1.0;
  }
  return leg;
}

// The mean angle between trunk and sole, in rad, with other signs of hip and ankle.
double mean_sole_pitch_rad(const ForeignMotion& motion, const JointMap& map, const PitchColumns& leg,
                           double hip, double ankle) {
  const std::array<double, 3> turns{hip, 1.0, ankle};
  double sum_rad = 0.0;
  std::size_t count = 0;
  for (const ForeignSection& section : motion.sections) {
    for (const ForeignFrame& frame : section.frames) {
      double pitch_rad = 0.0;
      bool known = true;
      for (std::size_t i = 0; i < turns.size(); ++i) {
        const ForeignValue& value = frame.values[leg.column.at(i)];
        known = known && value;
        if (value) pitch_rad += turns.at(i) * leg.axis.at(i) * map.joints[leg.column.at(i)]->sign * *value;
      }
      if (!known) continue;
      sum_rad += std::abs(pitch_rad);
      ++count;
    }
  }
  return count > 0 ? sum_rad / static_cast<double>(count) : 0.0;
}

// Robots stand with soles that are about parallel to the trunk. Turns guessed hips and ankles round where
// this makes the soles much more level; knees are known by their limits.
void level_soles(const ForeignMotion& motion, const sim_board::RobotDescription& robot,
                 const std::vector<bool>& is_guess, JointMap& map, std::vector<std::string>& reversed) {
  constexpr double kMuchMoreLevel = 0.5;
  for (const char* side : {"left", "right"}) {
    const auto leg = pitch_columns(map, robot, side);
    if (!leg || !is_guess[leg->column[0]] || !is_guess[leg->column[2]]) continue;
    double least_rad = kMuchMoreLevel * mean_sole_pitch_rad(motion, map, *leg, 1.0, 1.0);
    std::array<double, 2> best{1.0, 1.0};
    for (const auto& turns : {std::array{-1.0, -1.0}, std::array{-1.0, 1.0}, std::array{1.0, -1.0}}) {
      const double pitch_rad = mean_sole_pitch_rad(motion, map, *leg, turns[0], turns[1]);
      if (pitch_rad >= least_rad) continue;
      least_rad = pitch_rad;
      best = turns;
    }
    for (const std::size_t end : {0U, 1U}) {
      const std::size_t column = leg->column.at(2 * end);
      if (best.at(end) > 0.0) continue;
      map.joints[column]->sign = -map.joints[column]->sign;
      const std::string& name = motion.joints[column].name;
      const auto found = std::ranges::find(reversed, name);
      if (found == reversed.end()) {
        reversed.push_back(name);
      } else {
        reversed.erase(found);
      }
    }
  }
}

std::string names_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kMost) text += fmt::format(" and {} more", names.size() - kMost);
  return text;
}

}  // namespace

JointMap find_joints(const std::filesystem::path& file, const ForeignMotion& motion,
                     const sim_board::RobotDescription& robot, const std::filesystem::path& map_file) {
  if (map_file.empty()) return find_joints(file, motion, robot);
  const JointMapFile map(map_file, robot);
  return find_joints(file, motion, robot, &map);
}

JointMap find_joints(const std::filesystem::path& file, const ForeignMotion& motion,
                     const sim_board::RobotDescription& robot, const JointMapFile* map_of_user) {
  const bool ticks = motion.unit == ForeignMotion::Unit::kTicks;
  JointMap map;
  std::vector<std::string> unknown;
  std::vector<std::string> guessed;
  std::vector<std::string> taken(robot.joints.size());
  std::vector<std::string> reversed;
  std::vector<std::string> darwin;
  std::vector<bool> is_guess(motion.joints.size());
  const auto sources = ticks ? std::vector<std::pair<std::string, std::string>>() : source_names(robot);
  for (std::size_t column = 0; column < motion.joints.size(); ++column) {
    const ForeignJoint& joint = motion.joints[column];
    std::optional<MappedJoint> mapped;
    const bool stated = map_of_user != nullptr && map_of_user->find(joint, ticks, mapped);
    if (!stated) mapped = by_maker(joint, ticks, robot);
    if (!stated && !mapped) mapped = by_source(joint.name, sources, robot);
    if (!stated && !mapped && !ticks && !robot.find_joint(joint.name)) {
      mapped = of_known_robot(joint.name, robot);
      if (mapped) darwin.push_back(joint.name);
    }
    if (!stated && !mapped && !ticks) {
      if (const auto found = joint_with_name(joint.name, robot)) {
        mapped = MappedJoint{*found};
        const sim_board::JointDescription& own = robot.joints[*found];
        const bool guess = own.name != joint.name && own.role() != joint.name;
        if (guess) guessed.push_back(joint.name + " is " + own.name);
        is_guess[column] = guess;
        if (guess &&
            beyond_limits_rad(motion, column, -1.0, own) < beyond_limits_rad(motion, column, 1.0, own)) {
          mapped->sign = -1.0;
          reversed.push_back(joint.name);
        }
      }
    }
    if (!stated && !mapped) unknown.push_back(joint.name);
    if (mapped && !taken[mapped->joint].empty())
      throw InputError(file, 0,
                       fmt::format("{} and {}, which are both {}", taken[mapped->joint], joint.name,
                                   robot.joints[mapped->joint].name),
                       "one joint of the file for each of the robot: --map FILE");
    if (mapped) taken[mapped->joint] = joint.name;
    map.joints.push_back(mapped);
  }
  const bool nothing =
      std::ranges::none_of(map.joints, [](const auto& mapped) { return mapped.has_value(); });
  if (nothing || (ticks && !unknown.empty()))
    throw InputError(file, 0,
                     names_of(unknown.empty() ? std::vector<std::string>{"only ignored joints"} : unknown),
                     ticks || motion.format == MotionFormat::kPoseSeq
                         ? "servos that the robot names (koboshi:maker, see koboshi model map), or --map FILE"
                         : "joints of " + robot.name + ", or --map FILE");
  level_soles(motion, robot, is_guess, map, reversed);
  if (!guessed.empty())
    map.notes.push_back({"joints", fmt::format("by the meaning of their names: {}; --map FILE says otherwise",
                                               names_of(guessed))});
  if (!guessed.empty())
    map.notes.push_back({"joints", reversed.empty()
                                       ? "all of these turn as in the file, because nothing says otherwise"
                                       : fmt::format("of these, limits or level soles say that {} turn the "
                                                     "other way; the others turn as in the file",
                                                     names_of(reversed))});
  if (!darwin.empty())
    map.notes.push_back(
        {"joints",
         fmt::format("taken for those of a DARwIn-OP, with the signs of its legs; signs and zeros of "
                     "arms and head are assumed: {}; --map FILE says otherwise",
                     names_of(darwin))});
  if (!unknown.empty())
    map.notes.push_back({"joints", fmt::format("dropped, because {} has none of this name: {}", robot.name,
                                               names_of(unknown))});
  return map;
}

std::vector<std::optional<NamedForeignJoint>> foreign_joints(const sim_board::RobotDescription& robot,
                                                             bool numbered, bool ticks,
                                                             const std::filesystem::path& map_file) {
  std::optional<JointMapFile> map;
  if (!map_file.empty()) map.emplace(map_file, robot);
  std::vector<std::optional<NamedForeignJoint>> joints;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    std::optional<NamedForeignJoint> named = map ? map->named(i, numbered, ticks) : std::nullopt;
    const auto& maker = robot.joints[i].maker;
    if (!named && numbered && maker) {
      const ForeignJoint servo{.name = "servo " + std::to_string(maker->servo_id),
                               .servo_id = maker->servo_id};
      if (const auto mapped = by_maker(servo, ticks, robot)) named = NamedForeignJoint{servo, *mapped};
    }
    if (!named && !numbered) named = NamedForeignJoint{{.name = robot.joints[i].name}, MappedJoint{i}};
    joints.push_back(std::move(named));
  }
  return joints;
}

JointMap same_joints(const simulation::NamedModel& robot) {
  JointMap map;
  for (std::size_t i = 0; i < robot.joint_names.size(); ++i) map.joints.emplace_back(MappedJoint{.joint = i});
  return map;
}

}  // namespace koboshi::tools
