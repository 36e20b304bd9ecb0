#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/app/item_store.h"
#include "firmware/canopen/node.h"

namespace koboshi::app {

// The controller's parameters in storage: every object of the owner's table that an SDO client may write and
// a PDO may not. An item of records of index u16, sub-index u8, size u8 and value u32, so that another
// firmware finds what it knows and leaves what it does not.
class ParameterStore {
 public:
  enum class Wanted : std::uint8_t { kPresent, kFactory };

  // All must outlive the store.
  ParameterStore(ItemStore& items, canopen::Node& node) : items_(items), node_(node) {}

  // Makes storage hold the parameters as they are, or none, which is to say those of the factory. kBusy until
  // it does; then kNone, or why it failed. Nothing is written that is there already, and nothing begun when
  // storage may not be written now: kDeviceState.
  canopen::AbortCode store(Wanted wanted, bool may_begin);
  // Gives the node what storage holds of its parameters up to the index `last`, each checked as an SDO
  // client's would be. The controller is not asked: it makes what follows from all of them when they are
  // there.
  void load(std::uint16_t last = 0xFFFF);
  // Once a millisecond.
  void process() {
    if (busy_) go_on();
  }

 private:
  void go_on();
  struct Record;

  bool find(std::size_t number, Record& record) const;
  bool is_stored(Wanted wanted) const;
  canopen::AbortCode advance();

  ItemStore& items_;
  canopen::Node& node_;
  bool busy_ = false;
  bool begun_ = false;
  Wanted wanted_ = Wanted::kPresent;
  std::size_t next_ = 0;  // parameter to be written
  canopen::AbortCode failure_ = canopen::AbortCode::kNone;
};

}  // namespace koboshi::app
