#pragma once

#include <atomic>
#include <stdexcept>

namespace koboshi::simulation {

// Lock that rejects concurrent use: a step runs without the GIL, and other threads get an exception
// meanwhile.
class Exclusive {
 public:
  explicit Exclusive(std::atomic_flag& flag) : flag_(flag) {
    if (flag_.test_and_set()) throw std::runtime_error("this simulation is being used in another thread");
  }
  ~Exclusive() { flag_.clear(); }
  Exclusive(const Exclusive&) = delete;
  Exclusive& operator=(const Exclusive&) = delete;

 private:
  std::atomic_flag& flag_;
};

}  // namespace koboshi::simulation
