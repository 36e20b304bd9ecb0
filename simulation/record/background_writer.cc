#include "simulation/record/background_writer.h"

#include <utility>

namespace koboshi::simulation {

BackgroundWriter::BackgroundWriter(std::size_t ring_words, WhenFull when_full,
                                   std::function<void(const Ring::Record&)> write)
    : ring_(ring_words, when_full), write_(std::move(write)), writer_([this] { write_records(); }) {}

void BackgroundWriter::close() {
  finish();
  if (error_ != nullptr) std::rethrow_exception(std::exchange(error_, nullptr));
}

void BackgroundWriter::finish() {
  if (!writer_.joinable()) return;
  ring_.close();
  writer_.join();
}

// After an error the thread continues to empty the ring; the next `check` or `close` reports the error.
void BackgroundWriter::write_records() {
  Ring::Record record;
  while (ring_.read(record)) {
    try {
      if (error_ == nullptr) write_(record);
    } catch (...) {
      error_ = std::current_exception();
      failed_.store(true, std::memory_order_release);
    }
    ring_.release();
  }
}

}  // namespace koboshi::simulation
