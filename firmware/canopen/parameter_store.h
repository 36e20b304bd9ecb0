#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/application.h"
#include "firmware/canopen/item_store.h"
#include "firmware/canopen/node.h"

namespace koboshi::canopen {

// A node's parameters in storage, behind 0x1010 and 0x1011: an item of records of index u16, sub-index u8,
// size u8 and value u32, little-endian, in the order of Node::parameter. Another firmware finds what it knows
// and leaves what it does not. All groups lie in one item, so that a power failure leaves the old or the new
// of all.
class ParameterStore {
 public:
  // All must outlive the store. `kind` is that of the item; its number is 0.
  ParameterStore(ItemStore& items, std::uint16_t kind, Node& node)
      : items_(items), kind_(kind), node_(node) {}

  // Makes storage hold the group's parameters as they are, or (`restore`) none of them, which is to say those
  // of the factory; the other groups stay as they are stored. kBusy until it does; then kNone, or why it
  // failed. Nothing is written that is there already, and nothing begun when storage may not be written now:
  // kDeviceState.
  AbortCode store(ParameterGroup group, bool may_begin = true) { return change({group, true}, may_begin); }
  AbortCode restore(ParameterGroup group, bool may_begin = true) { return change({group, false}, may_begin); }
  // Gives the node what storage holds of its parameters, each checked as an SDO client's would be; from
  // within NodeApplication::on_reset. The owner is not asked: it makes what follows from all of them when
  // they are there. `kCommunication`: those alone, as NmtCommand::kResetCommunication wants it. A change that
  // the reset interrupts is abandoned, as by a power failure: it would mix values from before and after.
  void load(ParameterGroup group = ParameterGroup::kAll);
  // Once a millisecond.
  void process() {
    if (busy_) go_on();
  }

 private:
  struct Record;
  struct Change {
    ParameterGroup group = ParameterGroup::kAll;
    bool keeps = true;  // the present values, instead of none
  };
  // How far a walk through the records of the wanted item has come.
  struct Cursor {
    std::size_t stored = 0;   // bytes of the item in storage
    std::size_t present = 0;  // parameters of the node
  };

  AbortCode change(Change wanted, bool may_begin);
  bool next(Change wanted, Cursor& cursor, ParameterValue& parameter) const;
  bool is_stored(Change wanted) const;
  void go_on();
  void abandon();
  AbortCode advance();

  ItemStore& items_;
  const std::uint16_t kind_;
  Node& node_;
  bool busy_ = false;
  bool begun_ = false;
  Change wanted_;
  Cursor cursor_;
  AbortCode failure_ = AbortCode::kNone;
};

}  // namespace koboshi::canopen
