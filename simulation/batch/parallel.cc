#include "simulation/batch/parallel.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace koboshi::simulation {
namespace {

class Tasks {
 public:
  Tasks(std::size_t count, const std::function<void(std::size_t)>& task, const std::function<bool()>& go_on)
      : count_(count), task_(task), go_on_(go_on) {}

  void work() {
    std::size_t number = 0;
    while (take(number)) {
      try {
        task_(number);
      } catch (...) {
        remember(number);
      }
    }
  }

  std::size_t finish() const {
    if (error_) std::rethrow_exception(error_);
    return next_;
  }

 private:
  bool take(std::size_t& number) {
    const std::lock_guard lock(mutex_);
    stopped_ = stopped_ || error_ || next_ == count_ || !go_on_();
    if (stopped_) return false;
    number = next_++;
    return true;
  }

  void remember(std::size_t number) {
    const std::lock_guard lock(mutex_);
    if (error_ && number > failed_) return;
    error_ = std::current_exception();
    failed_ = number;
  }

  const std::size_t count_;
  const std::function<void(std::size_t)>& task_;
  const std::function<bool()>& go_on_;
  std::mutex mutex_;
  std::size_t next_ = 0;
  bool stopped_ = false;
  std::exception_ptr error_;
  std::size_t failed_ = 0;
};

}  // namespace

std::size_t core_count() { return std::max(1u, std::thread::hardware_concurrency()); }

std::size_t for_each_parallel(std::size_t count, std::size_t jobs,
                              const std::function<void(std::size_t)>& task,
                              const std::function<bool()>& go_on) {
  Tasks tasks(count, task, go_on);
  {
    std::vector<std::jthread> threads;
    try {
      for (std::size_t i = 0; i < std::min(jobs, count); ++i) threads.emplace_back([&] { tasks.work(); });
    } catch (const std::system_error&) {
      if (threads.empty()) throw;  // the system starts no more threads: those that run do all of it
    }
  }
  return tasks.finish();
}

}  // namespace koboshi::simulation
