#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::studio {

// Reads the values, events and pushes of a whole recording in threads of its own, for plots and lists. Poses,
// contacts and frames are left out.
class OverviewReader {
 public:
  explicit OverviewReader(const std::filesystem::path& run);
  ~OverviewReader();
  OverviewReader(const OverviewReader&) = delete;
  OverviewReader& operator=(const OverviewReader&) = delete;

  // Returns the blocks that have been read since the last call, at most `most`, in the order of time, without
  // gaps.
  [[nodiscard]] std::vector<view::Recording> take(std::size_t most);
  // Whether take() has returned everything.
  [[nodiscard]] bool finished() const;
  // The error that ended the reading, one line; empty: none.
  [[nodiscard]] std::string error() const;

 private:
  // Blocks that wait to be taken: 0.1 MB each for 250 signals at 100 Hz.
  static constexpr std::size_t kMaxWaiting = 384;
  static constexpr std::size_t kThreads = 2;

  void run(const std::stop_token& stop, const std::filesystem::path& run);
  void read(const std::stop_token& stop, const std::filesystem::path& run);

  mutable std::mutex mutex_;
  std::condition_variable_any room_;
  std::map<std::size_t, view::Recording> waiting_;  // by block
  std::optional<std::size_t> blocks_;               // of the recording, once a thread has opened it
  std::size_t next_read_ = 0;
  std::size_t next_taken_ = 0;
  std::string error_;

  std::vector<std::jthread> threads_;  // last member: they use the others
};

}  // namespace koboshi::studio
