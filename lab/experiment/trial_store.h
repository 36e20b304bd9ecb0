#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"

namespace koboshi::lab {

// A finished trial as a line of JSON, with its line feed:
//   {"experiment":"gyro-feedback","cell":"8-on","seed":3,"inputs":"9f..","values":{"speed_m_per_s":0.2}}
// and "error" beside the values of a trial that ended by one.
[[nodiscard]] std::string trial_line(const Experiment& experiment, const Trial& trial);

// The finished trials in files of such lines. Trials of another experiment are ignored; those of other inputs
// are kept, because each candidate of a search has inputs of its own. Not for several threads at a time.
class TrialStore {
 public:
  TrialStore(std::string experiment, std::vector<Metric> metrics)
      : experiment_(std::move(experiment)), metrics_(std::move(metrics)) {}

  // Reads the complete lines of a file from `offset`, in bytes, on. Returns the offset behind the last of
  // them: a line without a line feed is one that is being written, or was when its program was stopped. A
  // missing file is empty. Throws InputError for any other malformed line.
  std::uintmax_t read(const std::filesystem::path& file, std::uintmax_t offset = 0);
  void add(const Experiment& experiment, const Trial& trial);

  // The record of a trial of this cell and seed, and of the experiment's inputs; null if there is none.
  [[nodiscard]] const Record* find(const Experiment& experiment, std::size_t cell, std::uint64_t seed) const;
  // The number of trials of the experiment with other inputs than these.
  [[nodiscard]] std::size_t count_of_others(const std::string& inputs) const;

 private:
  struct Key {
    std::string inputs{};
    std::string cell{};
    std::uint64_t seed = 0;

    auto operator<=>(const Key&) const = default;
  };

  void read_line(const std::string& line);

  std::string experiment_;
  std::vector<Metric> metrics_;
  std::map<Key, Record> known_;
};

}  // namespace koboshi::lab
