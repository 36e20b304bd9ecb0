#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

inline constexpr std::uint16_t kLssRequestCobId = 0x7E5;  // master to slaves
inline constexpr std::uint16_t kLssResponseCobId = 0x7E4;

// Command specifiers of CiA 305, 6.2.
enum class LssCommand : std::uint8_t {
  kSwitchGlobal = 0x04,
  kConfigureNodeId = 0x11,
  kConfigureBitTiming = 0x13,
  kActivateBitTiming = 0x15,
  kStore = 0x17,
  kSwitchVendor = 0x40,  // and the next three: product, revision, serial number
  kSwitchSerial = 0x43,
  kSwitched = 0x44,
  kIdentifyVendor = 0x46,  // product, lowest and highest revision, lowest and highest serial number follow
  kIdentifySerialHigh = 0x4B,
  kIdentifyUnconfigured = 0x4C,
  kIdentified = 0x4F,
  kIdentifiedUnconfigured = 0x50,
  kFastscan = 0x51,
  kInquireVendor = 0x5A,  // product, revision, serial number and node id follow
  kInquireNodeId = 0x5E,
};

// An LSS slave (CiA 305): the master finds it by its 128-bit LSS address, the four numbers of 0x1018, and
// assigns its node id over the bus. The new node id takes effect with the next reset communication; reset
// node returns to the stored one. The only bit timing is 1 Mbit/s.
//
// Requests are served in every NMT state; fastscan only by slaves without node id. A request that the present
// LSS state does not permit is not answered.
class LssSlave {
 public:
  enum class State : std::uint8_t { kWaiting, kConfiguration };
  // The owner's task after a request.
  enum class Event : std::uint8_t {
    kNone,
    kLeft,   // none; the slave went from configuration to waiting
    kStore,  // store `node_id` over a power cycle, then call `stored`
  };

  // Vendor id, product code, revision number, serial number.
  using Address = std::array<std::uint32_t, 4>;

  explicit LssSlave(const Address& address) : address_(address) {}

  // Power-on and reset node: LSS state waiting, and the stored node id, 1 to 127 or kUnconfiguredNodeId.
  void restart(std::uint8_t node_id);
  // The node id that takes effect with the next reset communication.
  std::uint8_t node_id() const { return node_id_; }
  State state() const { return state_; }

  static bool takes(const hal::CanFrame& frame) {
    return frame.identifier == kLssRequestCobId && frame.size == 8 && !frame.remote;
  }
  // Takes a request and sends the answer to `sink`. `active_node_id`: that of the node now.
  [[nodiscard]] Event on_request(const hal::CanFrame& frame, std::uint8_t active_node_id, FrameSink& sink);
  // Answers the request to store: kNone, kCannotTransfer (no storage), or another code (failed).
  static void stored(AbortCode result, FrameSink& sink);

 private:
  Event switch_globally(std::uint8_t mode);
  void switch_selectively(std::size_t part, std::uint32_t value, FrameSink& sink);
  void identify(std::size_t part, std::uint32_t value, FrameSink& sink);
  void fastscan(const hal::CanFrame& frame, FrameSink& sink);
  Event configure(const hal::CanFrame& frame, std::uint8_t active_node_id, FrameSink& sink);

  const Address address_;
  State state_ = State::kWaiting;
  std::uint8_t node_id_ = kUnconfiguredNodeId;
  std::size_t selected_ = 0;    // parts of the address that have matched in a row
  std::size_t identified_ = 0;  // of the six numbers of identify, those that have matched in a row
  std::size_t scanned_ = 0;     // the part that fastscan continues with
};

}  // namespace koboshi::canopen
