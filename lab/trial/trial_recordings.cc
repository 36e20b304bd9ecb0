#include "lab/trial/trial_recordings.h"

#include <string>
#include <system_error>
#include <utility>

namespace koboshi::lab {
namespace {

thread_local TrialRecordings* present_recordings = nullptr;

}  // namespace

TrialRecordings::TrialRecordings(std::filesystem::path stem) : stem_(std::move(stem)) {
  std::filesystem::create_directories(stem_.parent_path());
  present_recordings = this;
}

TrialRecordings::~TrialRecordings() {
  present_recordings = nullptr;
  if (kept_) return;
  std::error_code ignored;
  for (int number = 1; number <= files_; ++number) std::filesystem::remove(file(number), ignored);
}

TrialRecordings* TrialRecordings::of_this_thread() { return present_recordings; }

std::filesystem::path TrialRecordings::next_file() { return file(++files_); }

std::filesystem::path TrialRecordings::file(int number) const {
  return stem_.string() + (number > 1 ? "-" + std::to_string(number) : std::string()) + ".mcap";
}

}  // namespace koboshi::lab
