#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/file/output_file.h"
#include "lab/experiment/experiment.h"

namespace koboshi::tools {

// The finished trials of an experiment in a file of JSON lines, from which an interrupted one resumes:
//   {"experiment":"gyro-feedback","cell":"8-on","seed":3,"inputs":"9f..","values":{"speed_m_per_s":0.2}}
// and "error" beside the values of a trial that ended by one. Trials of other experiments and inputs stay in
// the file and are ignored.
class TrialLog {
 public:
  // Reads the file. Removes a last line that was cut off; any other malformed line throws InputError.
  // An empty path is a log that remembers nothing.
  TrialLog(const std::filesystem::path& file, const Experiment& experiment);

  std::optional<Record> find(std::size_t cell, std::uint64_t seed) const;
  // Writes one whole line at once; throws WriteError. From any thread.
  void add(const Trial& trial);

 private:
  void read(const std::filesystem::path& file);
  void read_line(const std::string& line);

  const Experiment& experiment_;
  std::map<std::pair<std::string, std::uint64_t>, Record> known_;  // by cell and seed
  std::mutex mutex_;
  std::optional<OutputFile> out_;
};

}  // namespace koboshi::tools
