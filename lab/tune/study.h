#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "lab/trial/getting_up.h"
#include "lab/tune/search.h"

namespace koboshi::lab {

// A run of the scenario by which a set of parameters is scored.
struct StudiedTrial {
  // The quantity to maximise: the speed made good along an axis of the heading at the start, to the left, or
  // the turn rate; 1 for a robot that is on its feet at the end; how soon a robot that lay stands; or what a
  // motion achieves (lab/trial/motion_measure.h).
  enum class Reward { kForward, kBackward, kLeft, kTurn, kSurvival, kStandUp, kOneLeg, kBallSpeed, kPushUps };

  std::string name;
  std::vector<Override> set{};
  Reward reward = Reward::kSurvival;
  double wanted = 1.0;  // the value with score 1, which is the highest; of kStandUp the time, in s
  double weight = 1.0;
};

// A trial of a study that was played.
struct StudyTrial : GettingUpTrial {
  std::optional<double> achieved{};  // with the reward of a motion
};

// docs/reference/study-format.md.
struct Study {
  std::filesystem::path file;
  std::filesystem::path scenario;
  std::string world = "mild";  // in which the trials are played
  std::vector<SearchedNumber> numbers;
  std::vector<StudiedTrial> trials;
};

// Throws InputError.
[[nodiscard]] Study read_study(const std::filesystem::path& file);

// The score of a trial: -1 to 0 after a fall, more the longer the robot stayed up; otherwise the share of the
// wanted reward, less for straying from the path. A robot that does not stand up gets -1 to 0, too, more the
// further it came. A robot that does push-ups lies, which is no fall.
[[nodiscard]] double score(const StudiedTrial& trial, const StudyTrial& played, double duration_s);

}  // namespace koboshi::lab
