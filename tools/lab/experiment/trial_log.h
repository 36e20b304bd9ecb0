#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>

#include "sim_board/record/output_file.h"
#include "tools/lab/experiment/experiment.h"

namespace koboshi::tools {

// The finished trials of an experiment in a file of JSON lines, so that one that was interrupted goes on:
//   {"experiment":"gyro-feedback","cell":"8-on","seed":3,"inputs":"9f..","values":{"speed_m_per_s":0.2}}
// and "error" beside the values of a trial that ended by one.
// A trial is found again by all of these but its values; trials of other inputs stay and do no harm.
class TrialLog {
 public:
  // Reads what is there. A last line that was cut off is cut away; any other malformed line throws
  // sim::InputError. An empty path is a log that remembers nothing.
  TrialLog(const std::filesystem::path& file, const Experiment& experiment);

  std::optional<Values> find(std::size_t cell, std::uint64_t seed) const;
  // Writes one whole line at once; throws sim::WriteError. From any thread.
  void add(const Trial& trial);

 private:
  using Key = std::tuple<std::string, std::string, std::uint64_t, std::string>;

  void read();
  Key key(std::size_t cell, std::uint64_t seed) const;

  std::filesystem::path file_;
  const Experiment& experiment_;
  std::map<Key, Values> known_;
  std::mutex mutex_;
  std::optional<sim::OutputFile> out_;
};

}  // namespace koboshi::tools
