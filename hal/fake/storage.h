#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "hal/port/storage.h"

namespace koboshi::hal {

// Flash memory in RAM. An erasure or a write stays busy for a scripted number of `state` calls, or until
// `finish`. Until then its range reads as scrambled bytes, so that a test notices a reader that does not
// wait.
class FakeStorage final : public StoragePort {
 public:
  explicit FakeStorage(std::size_t sector_count = 4, std::size_t sector_size_bytes = 1024);

  // --- what a test scripts ---

  // Operations begun from now on return kBusy to this many calls of `state` and are done at the next.
  // Default: 0.
  void complete_after(int polls) { polls_ = polls; }
  // Operations begun from now on stay busy until `finish`.
  void complete_by_finish() { polls_.reset(); }
  // Ends the running operation. No effect when there is none.
  void finish();
  // The next operation to be begun ends in kFailed, its range scrambled.
  void fail_next() { fail_next_ = true; }
  // Power fails and returns: a running operation is cancelled, with its range scrambled; the state is idle.
  void lose_power();
  // Puts bytes in place at once, as programmed in the factory. The range must lie in the memory.
  void load(std::size_t offset, std::span<const std::byte> bytes);

  // --- StoragePort ---

  [[nodiscard]] std::span<const std::byte> contents() const override { return bytes_; }
  [[nodiscard]] std::size_t sector_size_bytes() const override { return sector_size_bytes_; }
  [[nodiscard]] bool begin_erase(std::size_t offset) override;
  [[nodiscard]] bool begin_write(std::size_t offset, std::span<const std::byte> bytes) override;
  [[nodiscard]] StorageState state() const override;

 private:
  struct Operation {
    std::size_t offset;
    std::vector<std::byte> result;  // what the range holds once the operation is done
    std::optional<int> polls_left;  // without: until `finish`
    bool fails;
  };

  void begin(std::size_t offset, std::vector<std::byte> result);
  void complete() const;

  std::size_t sector_size_bytes_;
  std::optional<int> polls_ = 0;
  bool fail_next_ = false;
  // Time passes for the memory where `state`, a const verb, is polled.
  mutable std::vector<std::byte> bytes_;
  mutable std::optional<Operation> operation_;
  mutable bool failed_ = false;
};

}  // namespace koboshi::hal
