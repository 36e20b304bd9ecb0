#include "simulation/batch/workers.h"

#include <system_error>
#include <utility>

namespace koboshi::simulation {

Workers::Workers(std::size_t threads) {
  try {
    for (std::size_t i = 1; i < threads; ++i) threads_.emplace_back([this] { wait_for_rounds(); });
  } catch (const std::system_error&) {
    // The system starts no more threads: those that wait, and the caller, do the work.
  }
}

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  begins_.notify_all();
}

void Workers::run(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::unique_lock lock(mutex_);
  task_ = &task;
  count_ = count;
  next_ = 0;
  ended_ = 0;
  if (count > 1) begins_.notify_all();
  work(lock);
  ends_.wait(lock, [this] { return ended_ == count_; });
  count_ = 0;
  next_ = 0;
  if (const std::exception_ptr error = std::exchange(error_, nullptr)) std::rethrow_exception(error);
}

void Workers::wait_for_rounds() {
  std::unique_lock lock(mutex_);
  while (true) {
    begins_.wait(lock, [this] { return stops_ || next_ < count_; });
    if (stops_) return;
    work(lock);
  }
}

// Does tasks until nobody has to begin one any more.
void Workers::work(std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const std::size_t number = next_++;
    const auto& task = *task_;
    lock.unlock();
    std::exception_ptr error;
    try {
      task(number);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (error && (!error_ || number < failed_)) {
      error_ = error;
      failed_ = number;
    }
    if (++ended_ == count_) ends_.notify_all();
  }
}

}  // namespace koboshi::simulation
