#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "base/file/output_file.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/trial_store.h"

namespace koboshi::lab {

// The finished trials of an experiment in a file of JSON lines (trial_store.h), from which an interrupted one
// resumes. Trials of other experiments and inputs stay in the file and are ignored.
class TrialLog {
 public:
  // Reads the file. Removes a last line that was cut off; any other malformed line throws InputError.
  // An empty path is a log that remembers nothing.
  TrialLog(const std::filesystem::path& file, const Experiment& experiment);

  std::optional<Record> find(std::size_t cell, std::uint64_t seed) const;
  // Writes one whole line at once; throws WriteError. From any thread.
  void add(const Trial& trial);

 private:
  const Experiment& experiment_;
  TrialStore known_;  // when the log was opened
  std::mutex mutex_;
  std::optional<OutputFile> out_;
};

}  // namespace koboshi::lab
