#include "lab/tune/checked_motions.h"

#include <algorithm>
#include <string>

#include "base/text/error.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::lab {

void CheckedMotions::check(const simulation::Scenario& scenario) {
  for (const simulation::MotionChoice& motion : scenario.motions) {
    if (motion.overrides.empty()) continue;
    std::unique_ptr<tools::MotionChecker>& checker = checkers_[scenario.robot];
    if (!checker) checker = std::make_unique<tools::MotionChecker>(scenario.robot);
    const tools::MotionReport report =
        checker->check(checker->compile(simulation::read_motion_file(motion.file, motion.overrides)));
    for (const tools::PathReport& path : report.paths) {
      const auto error =
          std::ranges::find(path.findings, simulation::Severity::kError, &tools::Finding::severity);
      if (error == path.findings.end()) continue;
      throw InputError(motion.file, 0, error->found, error->expected,
                       "the check of " + motion.name() + " (" + error->code + ")");
    }
  }
}

}  // namespace koboshi::lab
