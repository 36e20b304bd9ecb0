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

class KnownNames {
 public:
  KnownNames(const std::filesystem::path& source, std::vector<std::string> names, std::string whose)
      : source_(source), names_(std::move(names)), whose_(std::move(whose)) {}

  void require(const std::string& name, const std::string& key) const {
    if (std::ranges::find(names_, name) != names_.end()) return;
    const auto nearest = nearest_name(name, names_);
    throw InputError(source_, 0, one_line(name) + " in " + key,
                     whose_ + (nearest ? "; did you mean " + one_line(*nearest) + "?" : std::string()));
  }

 private:
  const std::filesystem::path& source_;
  std::vector<std::string> names_;
  std::string whose_;
};

}  // namespace

std::set<std::string> names_in(const ImportedRobot& robot) {
  std::set<std::string> names;
  for (const ImportedLink& link : robot.links) names.insert(link.name);
  for (const ImportedJoint& joint : robot.joints) names.insert(joint.name);
  return names;
}

void require_known(const ImportDecisions& given, const ImportDecisions& taken,
                   const std::set<std::string>& source_names, const ImportedRobot& robot,
                   const std::filesystem::path& source) {
  const KnownNames questions(source, kQuestions, "the name of a question");
  for (const auto& [name, answer] : given.answers) questions.require(name, "answers");

  std::vector<std::string> joints;
  for (const ImportedJoint& joint : robot.joints) joints.push_back(joint.name);
  const KnownNames own(source, joints, "a joint of robot.sdf");
  std::map<std::string, std::string> roles;  // by joint of the source
  for (const auto& [role, joint] : taken.joints) roles[joint] = role;
  const auto require_own = [&](const std::string& name, const std::string& key) {
    const auto role = roles.find(name);
    if (role != roles.end() && std::ranges::find(joints, name) == joints.end())
      throw InputError(source, 0, one_line(name) + " in " + key,
                       "a joint of robot.sdf, where it is " + role->second);
    own.require(name, key);
  };
  for (const auto& [name, servo] : given.servos) require_own(name, "servos");
  for (const auto& [name, angle_deg] : given.zero_deg) require_own(name, "zero_deg");

  const KnownNames joints_of_source(source, {source_names.begin(), source_names.end()},
                                    "a joint of the source");
  for (const auto& [name, angle_deg] : given.locked_deg) joints_of_source.require(name, "locked_deg");
  std::set<std::string> all = names_in(robot);
  all.insert(source_names.begin(), source_names.end());
  const KnownNames parts(source, {all.begin(), all.end()}, "a link or joint");
  for (const auto& [key, choice] : given.repairs)
    if (!taken.repairs.contains(key)) parts.require(key.substr(0, key.rfind('.')), "repairs");

  std::map<std::string, std::string> users;
  for (const auto& [name, joint] : given.joints) {
    const auto& known = role_names();
    const auto nearest = nearest_name(name, known);
    if (std::ranges::find(known, name) == known.end() && !source_names.contains(name) && nearest)
      throw InputError(source, 0, one_line(name) + " in joints",
                       "the name of a role; did you mean " + *nearest + "?");
    if (const auto [user, is_new] = users.emplace(joint, name); !is_new)
      throw InputError(source, 0, one_line(joint) + " in joints for " + user->second + " and " + name,
                       "one of them");
  }
}

}  // namespace koboshi::tools
