#include "lab/bring_up/recovery_check.h"

#include "sim_board/world/foot.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::lab {

std::vector<tools::Finding> RecoveryCheck::findings(const RecoveryMotion& motion) {
  const tools::CompiledMotion compiled =
      checker_.compile(simulation::read_motion_text(motion.name() + ".yaml", motion.text("A trial")));
  tools::MotionReport report = checker_.check(compiled);
  places_ = std::move(report.places);
  std::vector<tools::Finding> errors;
  for (tools::PathReport& path : report.paths)
    for (tools::Finding& finding : path.findings)
      if (finding.severity == simulation::Severity::kError) errors.push_back(std::move(finding));
  return errors;
}

std::vector<std::string> RecoveryCheck::errors(const RecoveryMotion& motion) {
  std::vector<std::string> texts;
  for (const tools::Finding& finding : findings(motion)) texts.push_back(finding.code + ", " + finding.found);
  return texts;
}

RecoveryMotion RecoveryCheck::mended(const RecoveryMotion& motion) {
  constexpr int kMostChanges = 40;
  RecoveryMotion mended = motion;
  for (int change = 0; change < kMostChanges; ++change) {
    const std::vector<tools::Finding> found = findings(mended);
    if (found.empty()) break;
    const std::string before = mended.text("A trial");
    for (const tools::Finding& finding : found) mended = changed(mended, finding);
    if (mended.text("A trial") == before) break;
  }
  return mended;
}

RecoveryMotion RecoveryCheck::changed(const RecoveryMotion& motion, const tools::Finding& finding) const {
  if (finding.code == "C001" || finding.code == "C002" || finding.code == "C003") {
    constexpr double kSlower = 1.1;
    const int line = finding.step < places_.size() ? places_[finding.step].line : 0;
    const auto step = motion.step_of_line(line);
    return step ? motion.with_step_slower_by(*step, kSlower) : motion;
  }
  if (finding.code != "C005" || finding.links.size() != 2) return motion;
  const int side = side_of_leg(finding.links[0]);
  const int other_side = side_of_leg(finding.links[1]);
  constexpr double kLessRoll = 0.75;
  constexpr double kLessFlexion_deg = 2.0;
  if (side >= 0 && other_side >= 0 && side != other_side) return motion.with_rolls(kLessRoll);
  if ((side >= 0) != (other_side >= 0) && (finding.links[0] == 0 || finding.links[1] == 0))
    return motion.with_less_flexion(kLessFlexion_deg);
  return motion;
}

int RecoveryCheck::side_of_leg(std::size_t link) const {
  const sim_board::RobotDescription& robot = checker_.robot();
  const auto feet = sim_board::feet_of(robot);
  for (std::size_t side = 0; side < feet.size(); ++side) {
    if (!feet[side]) continue;
    for (int at = feet[side]->link; at > 0;) {
      if (at == static_cast<int>(link)) return static_cast<int>(side);
      int parent = -1;
      for (const sim_board::JointDescription& joint : robot.joints)
        if (joint.child == at) parent = joint.parent;
      at = parent;
    }
  }
  return -1;
}

}  // namespace koboshi::lab
