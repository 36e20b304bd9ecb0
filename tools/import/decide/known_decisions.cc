#include "tools/import/decide/known_decisions.h"

#include <algorithm>
#include <map>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

// Of all questions that an import may ask (docs/reference/import-file.md).
const std::vector<std::string> kQuestions{"battery_V",
                                          "continuous_range_deg",
                                          "exported",
                                          "forward",
                                          "friction",
                                          "imu",
                                          "linkage",
                                          "lock_other_joints",
                                          "max_miss_mm",
                                          "name",
                                          "one_motor",
                                          "servo",
                                          "straighten",
                                          "symmetric",
                                          "transmission",
                                          "triangles",
                                          "up"};

// Names the nearest of the names: "; did you mean left_knee?". Empty if none is near.
std::string suggestion(const std::string& name, const std::set<std::string>& names) {
  const auto nearest = nearest_name(name, std::vector<std::string>(names.begin(), names.end()));
  return nearest ? "; did you mean " + one_line(*nearest) + "?" : std::string();
}

// Checks the names of one key of import.yaml.
class KnownNames {
 public:
  KnownNames(const ImportDecisions& given, const std::filesystem::path& source, std::string key,
             std::set<std::string> names, std::string whose)
      : given_(given),
        source_(source),
        key_(std::move(key)),
        names_(std::move(names)),
        whose_(std::move(whose)) {}

  void require(const std::string& name) const {
    if (!names_.contains(name)) refuse(name, whose_ + suggestion(name, names_));
  }
  [[noreturn]] void refuse(const std::string& name, const std::string& expected) const {
    throw decision_error(given_, key_, name, source_, one_line(name) + " in " + key_, expected);
  }

 private:
  const ImportDecisions& given_;
  const std::filesystem::path& source_;
  std::string key_;
  std::set<std::string> names_;
  std::string whose_;
};

std::set<std::string> joint_names(const ImportedRobot& robot) {
  std::set<std::string> names;
  for (const ImportedJoint& joint : robot.joints) names.insert(joint.name);
  return names;
}

// The names that joints of robot.sdf may have.
std::set<std::string> possible_joints(const ImportDecisions& given, const ImportedRobot& source) {
  std::set<std::string> names(role_names().begin(), role_names().end());
  for (const auto& [name, joint] : given.joints) names.insert(name);
  for (const ImportedJoint& joint : source.joints) names.insert(utf8_line(joint.name));
  return names;
}

// The names that its links may have.
std::set<std::string> possible_links(const std::set<std::string>& joints) {
  std::set<std::string> names{"trunk"};
  for (const std::string& joint : joints) {
    names.insert(link_name_of(joint));
    names.insert(joint + "_link");
  }
  for (const char* const side : {"left_", "right_"})
    for (const char* const part : {"thigh", "foot", "ankle_link"}) names.insert(std::string(side) + part);
  return names;
}

// A name that several parts want gets a number: "finger_2".
std::string without_number(const std::string& name) {
  const std::size_t end = name.find_last_not_of("0123456789");
  const bool has_number = end != std::string::npos && end + 1 < name.size() && name[end] == '_';
  return has_number ? name.substr(0, end) : name;
}

// A repair is PART.WHAT.
void require_repairs(const ImportDecisions& given, const ImportedRobot& robot,
                     const std::set<std::string>& joints, const std::filesystem::path& source) {
  const std::set<std::string> of_links{"com", "inertia", "mass"};
  const std::set<std::string> of_joints{"limits", "lower", "speed", "upper"};
  std::set<std::string> links = possible_links(joints);
  for (const ImportedLink& link : robot.links) links.insert(link.name);
  std::set<std::string> parts = joints;
  parts.insert(links.begin(), links.end());
  const auto refuse = [&](const std::string& key, const std::string& found, const std::string& expected) {
    throw decision_error(given, "repairs", key, source, one_line(found) + " in repairs", expected);
  };
  for (const auto& [key, choice] : given.repairs) {
    const std::size_t dot = key.rfind('.');
    if (dot == std::string::npos) refuse(key, key, "PART.WHAT, such as trunk.mass");
    const std::string part = key.substr(0, dot);
    const bool is_link = links.contains(part) || links.contains(without_number(part));
    const bool is_joint = joints.contains(part) || joints.contains(without_number(part));
    if (!is_link && !is_joint) refuse(key, part, "a link or joint" + suggestion(part, parts));
    std::set<std::string> whats;
    if (is_link) whats.insert(of_links.begin(), of_links.end());
    if (is_joint) whats.insert(of_joints.begin(), of_joints.end());
    const std::string what = key.substr(dot + 1);
    if (!whats.contains(what))
      refuse(key, key,
             join_alternatives(std::vector<std::string>(whats.begin(), whats.end())) + " behind the dot" +
                 suggestion(what, whats));
  }
}

void require_joints(const ImportDecisions& given, const std::set<std::string>& source_names,
                    const std::filesystem::path& source) {
  std::map<std::string, std::string> users;
  for (const auto& [name, joint] : given.joints) {
    const auto& known = role_names();
    const auto nearest = nearest_name(name, known);
    if (std::ranges::find(known, name) == known.end() && !source_names.contains(name) && nearest)
      throw decision_error(given, "joints", name, source, one_line(name) + " in joints",
                           "the name of a role; did you mean " + *nearest + "?");
    if (const auto [user, is_new] = users.emplace(joint, name); !is_new)
      throw decision_error(given, "joints", name, source,
                           one_line(joint) + " in joints for " + user->second + " and " + name,
                           "one of them");
  }
}

}  // namespace

std::set<std::string> names_in(const ImportedRobot& robot) {
  std::set<std::string> names;
  for (const ImportedLink& link : robot.links) names.insert(link.name);
  for (const ImportedJoint& joint : robot.joints) names.insert(joint.name);
  return names;
}

void require_known_names(const ImportDecisions& given, const ImportedRobot& robot,
                         const std::filesystem::path& source) {
  const KnownNames questions(given, source, "answers", {kQuestions.begin(), kQuestions.end()},
                             "the name of a question");
  for (const auto& [name, answer] : given.answers) questions.require(name);
  require_joints(given, names_in(robot), source);
  const std::set<std::string> of_source = joint_names(robot);
  for (const auto& [name, joint] : given.joints)
    if (!of_source.contains(joint))
      throw decision_error(given, "joints", name, source, "no joint " + one_line(joint) + " for " + name,
                           "a joint of the source, or no such entry in joints");
  const KnownNames locked(given, source, "locked_deg", of_source, "a joint of the source");
  for (const auto& [name, angle_deg] : given.locked_deg) locked.require(name);

  const std::set<std::string> joints = possible_joints(given, robot);
  const auto require_own = [&](const std::string& key, const std::string& name) {
    if (joints.contains(without_number(name)) || name.starts_with("part")) return;
    KnownNames(given, source, key, joints, "a joint of robot.sdf").require(name);
  };
  for (const auto& [name, servo] : given.servos) require_own("servos", name);
  for (const auto& [name, angle_deg] : given.zero_deg) require_own("zero_deg", name);
  for (const auto& [name, limits_deg] : given.limits_deg) require_own("limits_deg", name);
  require_repairs(given, robot, joints, source);
}

void require_known(const ImportDecisions& given, const ImportDecisions& taken,
                   const std::set<std::string>& source_names, const ImportedRobot& robot,
                   const std::filesystem::path& source) {
  const std::set<std::string> joints = joint_names(robot);
  std::map<std::string, std::string> roles;  // by joint of the source
  for (const auto& [role, joint] : taken.joints) roles[joint] = role;
  const auto require_own = [&](const std::string& key, const std::string& name) {
    const KnownNames own(given, source, key, joints, "a joint of robot.sdf");
    const auto role = roles.find(name);
    if (role != roles.end() && !joints.contains(name))
      own.refuse(name, "a joint of robot.sdf, where it is " + role->second);
    own.require(name);
  };
  for (const auto& [name, servo] : given.servos) require_own("servos", name);
  for (const auto& [name, angle_deg] : given.zero_deg) require_own("zero_deg", name);
  std::set<std::string> all = names_in(robot);
  all.insert(source_names.begin(), source_names.end());
  for (const auto& [key, choice] : given.repairs) {
    const std::string part = key.substr(0, key.rfind('.'));
    if (!taken.repairs.contains(key) && !all.contains(part))
      throw decision_error(given, "repairs", key, source, one_line(part) + " in repairs",
                           "a link or joint" + suggestion(part, all));
  }
}

}  // namespace koboshi::tools
