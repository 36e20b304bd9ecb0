#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/lss_slave.h"
#include "firmware/canopen/node/node.h"

// Services of a field device that a controller's node lacks: TIME (CiA 301, 7.2.6), LSS (CiA 305), and
// object 0x1020, verify configuration.
namespace koboshi::canopen {

// TIME_OF_DAY (CiA 301, 7.1.6.5).
struct TimeOfDay {
  std::uint32_t ms = 0;    // after midnight, 28 bits
  std::uint16_t days = 0;  // since 1 January 1984

  friend bool operator==(const TimeOfDay&, const TimeOfDay&) = default;
};

inline constexpr std::uint32_t kMillisecondsPerDay = 86'400'000;
inline constexpr std::uint16_t kTimeCobId = 0x100;
inline constexpr std::uint32_t kTimeConsumer = 1u << 31;  // of 0x1012
inline constexpr std::uint32_t kTimeProducer = 1u << 30;  // of 0x1012; this stack refuses it

// Consumer of the TIME object (CiA 301, 7.2.6), with 0x1012, COB-ID time stamp object. Between two messages
// the time advances by the node's own clock.
class TimeStamp {
 public:
  // Resets 0x1012 to its default. Keeps the time of day.
  void load_defaults() { cob_id_ = kTimeConsumer | kTimeCobId; }
  std::uint32_t cob_id() const { return cob_id_; }
  // Writes 0x1012. kInvalidValue for a restricted identifier, for kTimeProducer, and for another identifier
  // while bit 31 is set.
  AbortCode write_cob_id(std::uint32_t value);

  bool consumes() const { return (cob_id_ & kTimeConsumer) != 0; }
  std::uint16_t identifier() const { return static_cast<std::uint16_t>(cob_id_ & kCobIdMask); }
  // Whether this is a TIME message. A remote frame is none: it has no data.
  bool identifies(const hal::CanFrame& frame) const {
    return consumes() && !frame.remote && frame.identifier == identifier();
  }
  // Takes the time of a TIME message. False if it is invalid: not six bytes, or beyond 24 hours.
  bool accept(const hal::CanFrame& frame, std::uint64_t now_us);
  // The time of day; nullopt before the first message.
  std::optional<TimeOfDay> at(std::uint64_t now_us) const {
    return last_ ? std::optional(advanced(now_us)) : std::nullopt;
  }

 private:
  TimeOfDay advanced(std::uint64_t now_us) const;

  std::uint32_t cob_id_ = kTimeConsumer | kTimeCobId;
  std::optional<TimeOfDay> last_;
  std::uint64_t last_us_ = 0;
};

// Callbacks of the services to the owner of a device.
class DeviceOwner {
 public:
  // Stores the node id that LSS has assigned, over a power cycle (CiA 305). kCannotTransfer: there is no
  // storage for it. While the owner returns kBusy it is called again, and the LSS master waits.
  virtual AbortCode on_store_node_id(std::uint8_t /*node_id*/) { return AbortCode::kCannotTransfer; }
  // The node has this node id from now on; called before any use of it.
  virtual void on_node_id(std::uint8_t /*node_id*/) {}
  // A TIME message has arrived.
  virtual void on_time(const TimeOfDay&) {}

 protected:
  ~DeviceOwner() = default;
};

// The services of a field device, a drive or a sensor: LSS slave (CiA 305), TIME consumer with 0x1012, and
// 0x1020, verify configuration, which becomes 0 as soon as a parameter of the node changes.
class DeviceServices final : public NodeServices {
 public:
  // The owner must outlive the services.
  DeviceServices(const LssSlave::Address& address, DeviceOwner& owner) : owner_(owner), lss_(address) {}

  // Power-on, before Node::start: takes the stored node id, or the factory's.
  void start(std::uint8_t node_id) { stored_node_id_ = node_id; }
  // Calls visit(identifier) for each frame that the services act on, as Node::for_each_identifier.
  template <typename Visit>
  void for_each_identifier(Visit visit) const {
    visit(kLssRequestCobId);
    if (time_.consumes()) visit(time_.identifier());
  }
  // Takes each frame before the node. True when it is for these services.
  bool on_frame(Node& node, const hal::CanFrame& frame, std::uint64_t now_us);
  // To be called once a millisecond.
  void process(Node& node) {
    if (node_id_to_store_) store_node_id(node);
  }
  // The time of day by the last TIME message; nullopt before the first.
  std::optional<TimeOfDay> time_of_day(std::uint64_t now_us) const { return time_.at(now_us); }

 private:
  void on_reset(Node& node, NmtCommand reset) override;
  AbortCode read(ObjectAddress address, ObjectValue& value) const override;
  AbortCode write(Node& node, ObjectAddress address, std::uint32_t value, std::size_t size) override;
  AbortCode write_own(ObjectAddress address, std::uint32_t value, std::size_t size);

  void on_lss(Node& node, const hal::CanFrame& frame, std::uint64_t now_us);
  void store_node_id(Node& node);

  DeviceOwner& owner_;
  LssSlave lss_;
  TimeStamp time_;
  std::array<std::uint32_t, 2> verification_{};  // 0x1020: date and time of the configuration
  std::uint8_t stored_node_id_ = kUnconfiguredNodeId;
  std::optional<std::uint8_t> node_id_to_store_;  // the LSS master waits for it
};

}  // namespace koboshi::canopen
