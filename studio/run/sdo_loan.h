#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace koboshi::studio {

// The SDO channels of a bus, which BusMonitor lends to another client of this program as long as the loan
// exists. Two clients on one channel of a node disturb each other: neither knows whose answer comes.
class SdoLoan {
 public:
  // Returns once the access of the monitor has ended, or after the longest time that one to a silent node
  // takes, with a margin.
  void wait() {
    std::unique_lock lock(mutex_);
    granted_now_.wait_for(lock, std::chrono::seconds(2), [this] { return granted_; });
  }
  void grant() {
    const std::scoped_lock lock(mutex_);
    granted_ = true;
    granted_now_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable granted_now_;
  bool granted_ = false;
};

}  // namespace koboshi::studio
