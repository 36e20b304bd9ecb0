#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/node/node.h"
#include "firmware/storage/parameter_store.h"

namespace koboshi::canopen {

// The SDO abort code that tells a client how storage answered (CiA 301, table 22).
constexpr AbortCode abort_code_of(storage::Status status) {
  switch (status) {
    case storage::Status::kOk:
      return AbortCode::kNone;
    case storage::Status::kBusy:
      return AbortCode::kBusy;
    case storage::Status::kInUse:
    case storage::Status::kNotAllowed:
      return AbortCode::kDeviceState;
    case storage::Status::kFull:
      return AbortCode::kOutOfMemory;
    case storage::Status::kTooLong:
      return AbortCode::kLengthTooHigh;
    case storage::Status::kFailed:
      return AbortCode::kHardwareError;
  }
  return AbortCode::kGeneralError;
}

// Objects 0x1010, store parameters, and 0x1011, restore default parameters (CiA 301, 7.5.2.13 and 7.5.2.14):
// a node's parameters, in the order of Node::next_parameter, in a store.
class StoredParameters final : private storage::ParameterOwner {
 public:
  // Both must outlive this object.
  StoredParameters(storage::ItemStore& items, Node& node) : node_(node), store_(items, *this) {}

  // The answers to NodeApplication::on_store and on_restore: kBusy until it is done; then kNone, or why it
  // failed. With `may_write` false, kDeviceState if flash would have to be written.
  AbortCode store(ParameterGroup group, bool may_write = true) {
    return abort_code_of(store_.store(indices_of(group), may_write));
  }
  AbortCode restore(ParameterGroup group, bool may_write = true) {
    return abort_code_of(store_.clear(indices_of(group), may_write));
  }
  // Gives the node the stored parameters of a group, each checked as a client's write would be; to be called
  // from within NodeApplication::on_reset. The owner's on_write is not called: it applies all of them
  // afterwards.
  void load(ParameterGroup group = ParameterGroup::kAll) { store_.load(indices_of(group)); }
  // To be called once a millisecond.
  void process() { store_.process(); }

 private:
  static constexpr storage::IndexRange indices_of(ParameterGroup group) {
    switch (group) {
      case ParameterGroup::kAll:
        break;
      case ParameterGroup::kCommunication:
        return {0, 0x1FFF};
      case ParameterGroup::kApplication:
        return {0x6000, 0xFFFF};
      case ParameterGroup::kManufacturer:
        return {0x2000, 0x5FFF};
    }
    return {};
  }

  bool next_parameter(std::size_t& place, storage::ParameterRecord& record) const override {
    ParameterValue parameter;
    if (!node_.next_parameter(place, parameter)) return false;
    record = {parameter.address.index, parameter.address.subindex, parameter.size_bytes, parameter.value};
    return true;
  }
  void restore(const storage::ParameterRecord& record) override {
    node_.restore({{record.index, record.subindex}, record.size_bytes, record.value});
  }

  Node& node_;
  storage::ParameterStore store_;
};

}  // namespace koboshi::canopen
