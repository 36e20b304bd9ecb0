#pragma once

#include "firmware/app/item_transfer.h"
#include "firmware/policy/policy_slot.h"
#include "firmware/robot/model.h"

namespace koboshi::app {

// Transfers the image of the policy between an SDO client and storage: the DOMAIN behind object 0x2420.
class PolicyTransfer final : public ItemTransfer {
 public:
  // Puts each stored policy into the slot. All must outlive the transfer.
  PolicyTransfer(storage::ItemStore& items, const robot::RobotModel& model, policy::PolicySlot& slot)
      : ItemTransfer(items, storage::ItemKind::kPolicy), model_(model), slot_(slot) {}

  // Prepares the next transfer; `may_store`: whether a client may replace the policy. Does nothing while a
  // transfer is under way.
  void select(bool may_store) {
    if (!is_under_way()) select_item(0, slot_.image(), may_store);
  }

  // kInvalidValue unless the bytes are exactly one policy image that this robot can run.
  canopen::AbortCode commit() override;

 private:
  const robot::RobotModel& model_;
  policy::PolicySlot& slot_;
  policy::Policy policy_;  // the download, once it is checked
};

}  // namespace koboshi::app
