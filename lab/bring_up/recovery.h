#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lab/bring_up/recovery_check.h"
#include "lab/bring_up/recovery_motion.h"
#include "lab/bring_up/rungs.h"
#include "lab/bring_up/value_search.h"

namespace koboshi::lab {

// How robots lie that shall get up.
enum class Lying { kProne, kSupine };

// Standing robots are pushed over to the front, the back and both sides, with the motions `fall_*` of their
// files and without. Reached if each fall is predicted before anything but the feet touches the ground, no
// robot ends in a fault, and trunk and head meet the ground no faster, in the mean, than without the motions.
// Throws InputError, Stopped.
[[nodiscard]] Rung protect_falls(const TriedRobot& robot, const PlayOptions& options);

// Robots that lie flat on chest or back get up on command, with the attempts that their parameters permit.
// Reached if all stand. Throws InputError, Stopped.
[[nodiscard]] Rung get_up(const TriedRobot& robot, const PlayOptions& options, Lying lying);

// A search for a motion by which a robot gets up, by CMA-ES over RecoveryMotion::variables().
struct RiseSearch {
  // Makes a robot with this motion's file instead of its own.
  std::function<TriedRobot(const RecoveryMotion&)> make;
  // Asked about a motion with which enough robots of the search stand; true ends the search.
  std::function<bool(const TriedRobot&)> is_enough;
  Lying lying = Lying::kProne;
  PlayOptions play;  // of the robots of the search, which have seeds of their own; the stepper is not used
  RecoveryCheck& check;
  const std::function<void(const std::string&)>& progress;
};

struct SearchedMotion {
  std::optional<RecoveryMotion> motion;  // nothing: none is better than the first start
  std::size_t candidates = 0;
  std::string log;  // a row of CSV for each candidate: its score in each engine and its values
};

// Maximises the score of the engine that likes the robot least: how soon it stands at the first attempt, else
// how far it came. Where all robots of the search stand, the share of further robots that stand counts, too.
// Every candidate is mended by the check first, and what errors remain lower its score. The search begins
// with the best of `starts`, and ends once all ten further robots stand in all engines at the first attempt,
// the check finds no errors, and that is enough. The same arguments give the same result if the end is a
// number of candidates. Throws Stopped, and std::runtime_error without an optimiser.
[[nodiscard]] SearchedMotion search_rise(const RiseSearch& search, const std::vector<RecoveryMotion>& starts,
                                         std::optional<std::size_t> candidates, const SearchEnd& end);

}  // namespace koboshi::lab
