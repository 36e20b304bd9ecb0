#pragma once

#include <filesystem>

namespace koboshi::lab {

// Recordings (docs/reference/recording.md) of the scenarios that a trial plays. While an object of this class
// exists, the scenarios that its thread plays (lab/trial/scenario_trial.h) are recorded: STEM.mcap,
// STEM-2.mcap and so on. Its end removes them unless they are kept.
class TrialRecordings {
 public:
  // Creates the folder of the stem.
  explicit TrialRecordings(std::filesystem::path stem);
  ~TrialRecordings();
  TrialRecordings(const TrialRecordings&) = delete;
  TrialRecordings& operator=(const TrialRecordings&) = delete;

  // The object of this thread, or null.
  static TrialRecordings* of_this_thread();

  // The file for the next scenario.
  std::filesystem::path next_file();
  void keep() { kept_ = true; }

 private:
  std::filesystem::path file(int number) const;

  const std::filesystem::path stem_;
  int files_ = 0;
  bool kept_ = false;
};

}  // namespace koboshi::lab
