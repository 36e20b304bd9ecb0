#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/lss_slave.h"
#include "firmware/canopen/nmt.h"
#include "firmware/canopen/node_services.h"
#include "firmware/canopen/pdo.h"
#include "firmware/canopen/time_stamp.h"

namespace koboshi::canopen {

// What the owner of a device is told by its services.
class DeviceOwner {
 public:
  // Keep the node id that LSS has given over a power cycle (CiA 305). kCannotTransfer: there is no storage
  // for it. While it says kBusy the master waits, and the owner is asked again.
  virtual AbortCode on_store_node_id(std::uint8_t /*node_id*/) { return AbortCode::kCannotTransfer; }
  // The node id that the node has from now on, before anything is made of it.
  virtual void on_node_id(std::uint8_t /*node_id*/) {}
  // The time of day of a TIME message.
  virtual void on_time(const TimeOfDay&) {}

 protected:
  ~DeviceOwner() = default;
};

// The services of a field device, a drive or a sensor: LSS slave (CiA 305), TIME consumer with 0x1012, and
// 0x1020 verify configuration, which goes to 0 as soon as a parameter of the node changes.
class DeviceServices final : public NodeServices {
 public:
  // The owner must outlive the services.
  DeviceServices(const LssSlave::Address& address, DeviceOwner& owner) : owner_(owner), lss_(address) {}

  // Power-on, before the node's start: the node id that was stored.
  void start(Node& node, std::uint8_t node_id);
  // Each frame, before the node gets it. True when it was for these services.
  bool on_frame(Node& node, const hal::CanFrame& frame, std::uint64_t now_us);
  // Once a millisecond.
  void process(Node& node) {
    if (node_id_to_store_) store_node_id(node);
  }
  // What NodeApplication::on_state tells.
  void on_state(Node& node, NmtState state);
  // By the last TIME message; nothing before the first.
  std::optional<TimeOfDay> time_of_day(std::uint64_t now_us) const { return time_.at(now_us); }

 private:
  AbortCode read(ObjectAddress address, ObjectValue& value) const override;
  AbortCode write(Node& node, ObjectAddress address, std::uint32_t value, std::size_t size) override;
  AbortCode write_own(ObjectAddress address, std::uint32_t value, std::size_t size);
  bool parameter(Node& node, std::size_t number, ParameterValue& parameter) const override;
  void restore(Node& node, const ParameterValue& parameter) override;

  void reset(Node& node);
  void on_lss(Node& node, const hal::CanFrame& frame, std::uint64_t now_us);
  void store_node_id(Node& node);
  // device_parameters.cc
  class ParameterList;
  static bool list_pdo(ParameterList& list, Node& node, PdoDirection direction, std::uint16_t number);
  static bool is_as_after_reset(Node& node, PdoDirection direction, std::uint16_t number);

  DeviceOwner& owner_;
  LssSlave lss_;
  TimeStamp time_;
  std::array<std::uint32_t, 2> verification_{};  // 0x1020: date and time of the configuration
  bool node_id_to_store_ = false;                // the LSS master waits for it
};

}  // namespace koboshi::canopen
