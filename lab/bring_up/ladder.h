#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace koboshi::tools {

// A rung of the ladder from a model to a robot that walks.
struct Rung {
  enum class Result { kReached, kFailed, kNotTried };

  std::string name;  // "stands"
  Result result = Result::kNotTried;
  std::string figure;  // what was measured: "leans by 1.2 deg, 5 of 5 robots"
  std::string cause;   // of a failure
};

struct BringUpOptions {
  std::filesystem::path robot;      // the robot's file; results go to its folder
  std::filesystem::path reference;  // the file of a robot that walks, with parameters.yaml beside it
  std::string stepper = "lumped";
  std::string world = "mild";
  std::uint64_t first_seed = 1;
  std::size_t seeds = 5;    // robots that each rung has to carry
  double budget_s = 600.0;  // of wall time, for searches
  std::size_t jobs = 1;
  std::string until{};  // name of the last rung to be tried; empty: all
};

struct BringUpResult {
  std::vector<Rung> rungs;
  std::vector<std::filesystem::path> files;  // that were written
  std::size_t searched = 0;                  // candidates of the search
};

// Climbs the ladder: loads, hangs, stands, squats, steps on the spot, walks forward, sideways and in turns.
// It writes parameters.yaml, motions/stand.yaml, motions/squat.yaml, go.yaml and bring-up.md beside the
// robot's file. Where the scaled start values do not carry the robot, it searches factors of CoM height, step
// time, compliance and lean, with seeds of its own. `progress` receives a line for each step. The rungs above
// a failed one are not tried. Throws InputError for files that cannot be read, and for files of the same
// names that it has not written itself.
[[nodiscard]] BringUpResult bring_up(const BringUpOptions& options,
                                     const std::function<void(const std::string&)>& progress);

// The names of the rungs that bring_up() tries, in order.
[[nodiscard]] std::vector<std::string> rung_names();

// The result as a table of text.
[[nodiscard]] std::string ladder_text(const BringUpResult& result);

}  // namespace koboshi::tools
