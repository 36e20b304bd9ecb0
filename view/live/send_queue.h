#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "view/live/batch.h"

namespace koboshi::view {

// The messages that wait to be sent to one page. A page that reads more slowly than the run goes loses its
// oldest samples and frames, never events and pushes, and is told how many.
class SendQueue {
 public:
  explicit SendQueue(std::size_t max_batches) : max_batches_(max_batches) {}

  void push(std::shared_ptr<const Batch> batch);
  bool empty() const { return batches_.empty() && kept_.empty(); }
  // Returns everything as one message, and empties the queue.
  [[nodiscard]] std::string take();

 private:
  const std::size_t max_batches_;
  std::deque<std::shared_ptr<const Batch>> batches_;
  std::string kept_;  // events and pushes of batches that were dropped
  std::uint64_t lost_samples_ = 0;
  std::uint64_t lost_frames_ = 0;
};

}  // namespace koboshi::view
