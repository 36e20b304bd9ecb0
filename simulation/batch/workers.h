#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace koboshi::simulation {

// Threads that wait for work, for many short rounds of tasks: a round costs a few microseconds more than its
// tasks. The caller is one of the threads.
class Workers {
 public:
  // `threads` >= 1, the caller included; fewer if the system starts no more.
  explicit Workers(std::size_t threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  // Calls task(0) to task(count - 1) once each, in any order, and returns when all have ended. If tasks
  // throw, the others are still called, and the exception of the first failed task, in order, is rethrown.
  // One round at a time.
  void run(std::size_t count, const std::function<void(std::size_t)>& task);

 private:
  void wait_for_rounds();
  void work(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable begins_;
  std::condition_variable ends_;
  const std::function<void(std::size_t)>* task_ = nullptr;
  std::size_t count_ = 0;
  std::size_t next_ = 0;   // the first task that nobody has begun
  std::size_t ended_ = 0;  // how many have ended
  std::size_t failed_ = 0;
  std::exception_ptr error_;  // of task `failed_`
  bool stops_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace koboshi::simulation
