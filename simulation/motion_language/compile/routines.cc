#include "simulation/motion_language/compile/routines.h"

#include <algorithm>

#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {
namespace {

// The calls between a file's routines. The caller with the number `count` is the main program.
class CallGraph {
 public:
  explicit CallGraph(const MotionSource& motion) : motion_(motion), callees_(motion.routines.size() + 1) {
    for (std::size_t i = 0; i < count(); ++i) find_calls(motion.routines[i].steps, callees_[i]);
    find_calls(motion.steps, callees_[count()]);
  }

  // Returns which routines the main program can reach.
  std::vector<bool> reached() const {
    std::vector<bool> is_reached(count(), false);
    std::vector<std::size_t> open{count()};
    while (!open.empty()) {
      const std::size_t caller = open.back();
      open.pop_back();
      for (const std::size_t callee : callees_[caller]) {
        if (is_reached[callee]) continue;
        is_reached[callee] = true;
        open.push_back(callee);
      }
    }
    return is_reached;
  }

  // Returns the routines among `is_used` in a topological order; those on a cycle are missing.
  std::vector<std::size_t> order(const std::vector<bool>& is_used) const {
    std::vector<std::size_t> callers(count(), 0);  // that are not yet in the order
    for (std::size_t i = 0; i < count(); ++i) {
      if (!is_used[i]) continue;
      for (const std::size_t callee : callees_[i]) ++callers[callee];
    }
    std::vector<std::size_t> order;
    std::vector<bool> is_done(count(), false);
    for (bool progress = true; progress;) {
      progress = false;
      for (std::size_t i = 0; i < count() && !progress; ++i) {
        if (!is_used[i] || is_done[i] || callers[i] > 0) continue;
        is_done[i] = progress = true;
        order.push_back(i);
        for (const std::size_t callee : callees_[i]) --callers[callee];
      }
    }
    return order;
  }

 private:
  std::size_t count() const { return motion_.routines.size(); }

  void find_calls(const std::vector<StepSource>& steps, std::vector<std::size_t>& callees) const {
    for (const StepSource& step : steps) {
      if (step.kind == StepSource::Kind::kCall) callees.push_back(routine_index(motion_, step.label));
      find_calls(step.body, callees);
      find_calls(step.otherwise, callees);
    }
  }

  const MotionSource& motion_;
  std::vector<std::vector<std::size_t>> callees_;  // by caller, once for each call
};

}  // namespace

std::size_t routine_index(const MotionSource& motion, const std::string& name) {
  const auto found = std::find_if(motion.routines.begin(), motion.routines.end(),
                                  [&](const RoutineSource& routine) { return routine.name == name; });
  return static_cast<std::size_t>(found - motion.routines.begin());
}

std::vector<std::size_t> order_of_routines(const MotionSource& motion, Diagnostics& diagnostics) {
  const CallGraph calls(motion);
  const std::vector<bool> is_used = calls.reached();
  std::vector<std::size_t> order = calls.order(is_used);
  for (std::size_t i = 0; i < motion.routines.size(); ++i) {
    const RoutineSource& routine = motion.routines[i];
    if (!is_used[i]) {
      diagnostics.add({.code = code::kUnused,
                       .severity = Severity::kWarning,
                       .place = routine.place,
                       .found = "the routine '" + routine.name + "', which nothing calls",
                       .expected = "a call of it"});
    } else if (std::find(order.begin(), order.end(), i) == order.end()) {
      diagnostics.add({.code = code::kRecursion,
                       .place = routine.place,
                       .found = "the routine '" + routine.name + "' on a cycle of calls",
                       .expected = "routines that do not call themselves, directly or through others"});
    }
  }
  return order;
}

}  // namespace koboshi::simulation
