#include "view/live/send_queue.h"

#include <utility>

namespace koboshi::view {

void SendQueue::push(std::shared_ptr<const Batch> batch) {
  batches_.push_back(std::move(batch));
  if (batches_.size() <= max_batches_) return;
  const Batch& oldest = *batches_.front();
  kept_ += oldest.marks;
  lost_samples_ += oldest.samples;
  lost_frames_ += oldest.frames;
  batches_.pop_front();
}

std::string SendQueue::take() {
  std::string message = std::exchange(kept_, {});
  if (lost_samples_ + lost_frames_ > 0)
    message += lost_batch(std::exchange(lost_samples_, 0), std::exchange(lost_frames_, 0));
  for (const auto& batch : batches_) message += batch->bytes;
  batches_.clear();
  return message;
}

}  // namespace koboshi::view
