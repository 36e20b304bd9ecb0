#pragma once

#include <cstdint>

#include "firmware/app/item_transfer.h"
#include "firmware/motion/motion_library.h"
#include "firmware/robot/model.h"

namespace koboshi::app {

// Transfers motion images between an SDO client and storage: the DOMAIN behind object 0x2400.
class MotionTransfer final : public ItemTransfer {
 public:
  // Adds each stored motion to `motions`. All must outlive the transfer.
  MotionTransfer(storage::ItemStore& items, const robot::RobotModel& model, motion::MotionLibrary& motions)
      : ItemTransfer(items, storage::ItemKind::kMotion), model_(model), motions_(motions) {}

  // Selects the motion of the next transfer, 0..kMaxMotions - 1, and whether a client may replace it. Does
  // nothing while a transfer is under way.
  void select(std::uint16_t number, bool may_store) {
    if (!is_under_way()) select_item(number, motions_.image(number), may_store);
  }

  // kInvalidValue unless the bytes are exactly one motion image that this robot can play.
  canopen::AbortCode commit() override;

 private:
  const robot::RobotModel& model_;
  motion::MotionLibrary& motions_;
  motion::Motion motion_;  // the download, once it is checked
};

}  // namespace koboshi::app
