#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "hal/port/storage.h"

namespace koboshi::hal {

// Flash memory in RAM. An erase or write operation is busy for a scripted number of `state` calls, or until
// `finish`. Until then its range reads as scrambled bytes, so that tests detect code that does not wait.
class FakeStorage final : public StoragePort {
 public:
  explicit FakeStorage(std::size_t sector_count = 4, std::size_t sector_size_bytes = 1024);

  // --- Functions for tests ---

  // Sets the number of kBusy results of `state` for each operation begun from now on; the next call then
  // reports its completion. Default: 0.
  void complete_after(int polls) { polls_ = polls; }
  // Keeps operations begun from now on busy until `finish`.
  void complete_by_finish() { polls_.reset(); }
  // Completes the operation in progress. No effect if there is none.
  void finish();
  // Makes the next operation end in kFailed with its range scrambled.
  void fail_next() { fail_next_ = true; }
  // Lets the next operation complete with its last bit wrong, without a word about it: a cell that does not
  // keep its charge.
  void corrupt_next() { corrupt_next_ = true; }
  // Simulates a power failure: an operation in progress is aborted with its range scrambled, and the state is
  // idle.
  void lose_power();
  // Writes bytes at once, as in the factory. The range must be within the memory.
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
    std::vector<std::byte> result;  // contents of the range after completion
    std::optional<int> polls_left;  // empty: until `finish`
    bool fails;
  };

  void begin(std::size_t offset, std::vector<std::byte> result);
  void complete() const;

  std::size_t sector_size_bytes_;
  std::optional<int> polls_ = 0;
  bool fail_next_ = false;
  bool corrupt_next_ = false;
  // Mutable, because polling the const function `state` advances the operation.
  mutable std::vector<std::byte> bytes_;
  mutable std::optional<Operation> operation_;
  mutable bool failed_ = false;
};

}  // namespace koboshi::hal
