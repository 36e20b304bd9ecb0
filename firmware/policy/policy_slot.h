#pragma once

#include <cstddef>
#include <span>

#include "firmware/policy/policy.h"
#include "firmware/robot/model.h"
#include "firmware/storage/catalogue.h"
#include "firmware/storage/item_store.h"

namespace koboshi::policy {

// The policy in storage: the one that was uploaded, or that of the factory's catalogue where none was.
class PolicySlot {
 public:
  // All must outlive the slot.
  PolicySlot(const storage::Catalogue& factory, storage::ItemStore& stored, const robot::RobotModel& model)
      : factory_(factory), stored_(stored), model_(model) {}

  // Validates the policy in storage: some 10^5 instructions of the Cortex-M4.
  void load();
  // Takes a policy that is new in storage, and that `policy` has opened.
  void add(const Policy& policy);
  // Erases the stored policy; that of the factory takes its place, if there is one. To be repeated while it
  // returns kBusy.
  storage::Status erase();

  // The bytes in storage, valid or not; empty: none.
  [[nodiscard]] std::span<const std::byte> image() const;
  // Returns the policy at its present address; null if there is none that this robot can run. It stays there
  // for the present millisecond.
  [[nodiscard]] const Policy* open();
  // The result of the validation; kTruncated if storage has no policy.
  [[nodiscard]] PolicyStatus status() const { return status_; }
  // Number of policies that were taken so far, with those of load() and erase(); wraps.
  [[nodiscard]] std::uint8_t changes() const { return changes_; }

 private:
  const storage::Catalogue& factory_;
  storage::ItemStore& stored_;
  const robot::RobotModel& model_;
  Policy policy_;
  PolicyStatus status_ = PolicyStatus::kTruncated;
  std::uint8_t changes_ = 0;
};

}  // namespace koboshi::policy
