#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lab/bring_up/journal.h"
#include "lab/bring_up/play.h"

namespace koboshi::lab {

struct BringUpOptions {
  std::filesystem::path robot;      // the robot's file; results go to its folder
  std::filesystem::path reference;  // the file of a robot that walks, with parameters.yaml beside it
  std::string stepper = "lumped";
  std::string world = "mild";
  std::uint64_t first_seed = 1;
  std::size_t seeds = 5;                    // robots that each rung has to carry
  double budget_s = 600.0;                  // of wall time, for all searches
  std::optional<std::size_t> candidates{};  // of each search, instead of the time: results repeat
  std::size_t jobs = 1;
  std::string until{};               // name of the last rung to be tried; empty: all
  bool restart = false;              // begins anew, whatever an earlier call has reached
  GoOn go_on = [] { return true; };  // false: ends with Stopped
};

struct BringUpResult {
  std::vector<Rung> rungs;
  std::vector<std::filesystem::path> files;  // that bring-up has written, in this call or an earlier one
  std::size_t searched = 0;                  // candidates of the searches
};

// Climbs the ladder (rung_names()) from a model to a robot that walks and gets up. It writes parameters.yaml,
// motions/, go.yaml, bring-up.md and bring-up.json beside the robot's file.
//
// A rung is tried in a folder for temporary files, and the robot's folder changes only at the end of the
// rung, each file by a rename: whoever ends the program leaves the folder as it was before the rung. Rungs
// that an earlier call has reached are not played again unless something has changed on which they depend.
//
// Where the scaled start values do not carry the robot, a search changes CoM height, step time, the gains of
// the feedback and the lean of the trunk. It has seeds of its own, and scores a candidate by the worse of the
// engines `lumped` and `mujoco`. A candidate is taken only if its score is higher and it reaches all lower
// rungs that were passed; their figures are then measured again.
//
// `progress` receives a line for each step. A rung that fails ends the ladder only for the rungs that need
// it: all need a robot that stands, which needs one that hangs, which needs one that loads. Throws InputError
// for files that cannot be read, for files of the same names that it has not written or that have been
// changed since; Stopped; std::system_error.
[[nodiscard]] BringUpResult bring_up(const BringUpOptions& options,
                                     const std::function<void(const std::string&)>& progress);

// The names of the rungs that bring_up() tries, in order.
[[nodiscard]] std::vector<std::string> rung_names();

// The result as a table of text.
[[nodiscard]] std::string ladder_text(const BringUpResult& result);

}  // namespace koboshi::lab
