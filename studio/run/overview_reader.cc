#include "studio/run/overview_reader.h"

#include <exception>
#include <utility>

#include "view/recording/recording_index.h"

namespace koboshi::studio {

OverviewReader::OverviewReader(const std::filesystem::path& run) {
  for (std::size_t i = 0; i < kThreads; ++i)
    threads_.emplace_back([this, run](const std::stop_token& stop) { this->run(stop, run); });
}

OverviewReader::~OverviewReader() {
  for (std::jthread& thread : threads_) thread.request_stop();
  for (std::jthread& thread : threads_) thread.join();
}

void OverviewReader::run(const std::stop_token& stop, const std::filesystem::path& run) {
  try {
    read(stop, run);
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    if (error_.empty()) error_ = error.what();
  }
}

void OverviewReader::read(const std::stop_token& stop, const std::filesystem::path& run) {
  view::RecordingIndex index(run);
  std::unique_lock lock(mutex_);
  blocks_ = index.blocks();
  while (error_.empty() && next_read_ < *blocks_) {
    const std::size_t block = next_read_++;
    if (!room_.wait(lock, stop, [&] { return block < next_taken_ + kMaxWaiting; })) return;
    lock.unlock();
    view::Recording overview = index.read_overview(block);
    lock.lock();
    waiting_.emplace(block, std::move(overview));
  }
}

std::vector<view::Recording> OverviewReader::take(std::size_t most) {
  const std::scoped_lock lock(mutex_);
  std::vector<view::Recording> taken;
  for (auto next = waiting_.begin();
       taken.size() < most && next != waiting_.end() && next->first == next_taken_; ++next_taken_) {
    taken.push_back(std::move(next->second));
    next = waiting_.erase(next);
  }
  if (!taken.empty()) room_.notify_all();
  return taken;
}

bool OverviewReader::finished() const {
  const std::scoped_lock lock(mutex_);
  return !error_.empty() || (blocks_ && next_taken_ == *blocks_);
}

std::string OverviewReader::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

}  // namespace koboshi::studio
