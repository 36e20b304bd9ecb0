#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"

// Emergency object: error register 0x1001, error history 0x1003, and the producer with its objects 0x1014 and
// 0x1015 (CiA 301, 7.2.7 and 7.5.2.2 to 7.5.2.18).
namespace koboshi::canopen {

// Bits of the error register 0x1001 (CiA 301, table 48). kGeneric is set whenever any error is.
namespace error_register {
inline constexpr std::uint8_t kGeneric = 1 << 0;
inline constexpr std::uint8_t kCurrent = 1 << 1;
inline constexpr std::uint8_t kVoltage = 1 << 2;
inline constexpr std::uint8_t kTemperature = 1 << 3;
inline constexpr std::uint8_t kCommunication = 1 << 4;
inline constexpr std::uint8_t kProfile = 1 << 5;
inline constexpr std::uint8_t kManufacturer = 1 << 7;
}  // namespace error_register

// Emergency error codes (CiA 301, table 26) that the stack raises or its users need.
namespace error_code {
inline constexpr std::uint16_t kNoError = 0x0000;
inline constexpr std::uint16_t kDataSet = 0x6300;  // a PDO of the NodeDescription cannot be
// CiA 402-2: parameter error. CiA 301 has no code of its own for a value in an RPDO that must not be stored.
inline constexpr std::uint16_t kParameter = 0x6320;
inline constexpr std::uint16_t kCanOverrun = 0x8110;
inline constexpr std::uint16_t kCanErrorPassive = 0x8120;
inline constexpr std::uint16_t kHeartbeat = 0x8130;
inline constexpr std::uint16_t kBusOffRecovered = 0x8140;
inline constexpr std::uint16_t kPdoTooShort = 0x8210;
inline constexpr std::uint16_t kPdoTooLong = 0x8220;
inline constexpr std::uint16_t kSyncLength = 0x8240;
inline constexpr std::uint16_t kRpdoTimeout = 0x8250;
}  // namespace error_code

// Who reports an error: the stack itself or the node's owner. Both may report the same one, such as a lost
// heartbeat; it has ended when neither does.
enum class ErrorReporter : std::uint8_t { kOwner = 1, kStack = 2 };

// The present errors of a node, its error register 0x1001 and its error history 0x1003. An error causes one
// message when it begins and one when it ends, however often it is reported.
class ErrorLog {
 public:
  static constexpr std::size_t kHistory = 8;  // set by hand (2026-11-21)
  // All errors of a drive at once: ten of the stack (error_code), six more of its own (cia402.h).
  static constexpr std::size_t kMaxActive = 16;

  // Reports an error. True when it is new, so that an emergency message is due. `register_bits` are those of
  // 0x1001 besides kGeneric, while the error is present; `additional` goes into bits 16..31 of the history.
  // Both are ignored if the error is present already. Beyond kMaxActive errors at once, further ones count as
  // new each time and leave the error register as it is.
  bool raise(std::uint16_t code, std::uint8_t register_bits, std::uint16_t additional,
             ErrorReporter reporter = ErrorReporter::kOwner);
  // Adds an entry to the history: a message about an error that is present already. 0x1003 holds all errors
  // that emergency messages have signalled (CiA 301, 7.5.2.4).
  void record(std::uint16_t code, std::uint16_t additional);
  // True when the error has ended by this.
  bool clear(std::uint16_t code, ErrorReporter reporter = ErrorReporter::kOwner) {
    return active_size_ > 0 && withdraw(code, reporter);
  }

  std::uint8_t error_register() const { return register_; }
  bool active(std::uint16_t code) const;

  // Object 0x1003: sub-index 0 is the number of entries, 1 the newest. Writing 0 to sub-index 0 erases all.
  // Both return kSubindexDoesNotExist beyond kHistory. Reading an entry that is not used: kNoData. Writing
  // any other sub-index: kWriteOfReadOnly; another value: kInvalidValue.
  AbortCode read_history(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write_history(std::uint8_t subindex, std::uint32_t value);

 private:
  bool withdraw(std::uint16_t code, ErrorReporter reporter);

  struct Active {
    std::uint16_t code = 0;
    std::uint8_t register_bits = 0;
    std::uint8_t reporters = 0;
  };
  void update_register();

  // Newest first: code in bits 0..15, additional information above.
  std::array<std::uint32_t, kHistory> history_{};
  std::array<Active, kMaxActive> active_{};
  std::uint8_t history_size_ = 0;
  std::uint8_t active_size_ = 0;
  std::uint8_t register_ = 0;
};

// Sends emergency messages (CiA 301, 7.2.7) under the COB-ID of 0x1014, at least the inhibit time 0x1015
// apart; up to kPending wait in order, further ones are dropped. The history shows the last kHistory errors
// that were raised, but not that they ended.
class EmergencyProducer {
 public:
  // Set by hand (2026-11-22): as many as the history holds.
  static constexpr std::size_t kPending = 8;

  explicit EmergencyProducer(FrameSink& sink) : sink_(sink) {}

  // Resets 0x1014 and 0x1015 to their defaults.
  void load_defaults(std::uint8_t node_id);
  std::uint32_t cob_id() const { return cob_id_; }
  // Writes 0x1014. kInvalidValue as of check_cob_id.
  AbortCode write_cob_id(std::uint32_t value);
  std::uint16_t inhibit_time_100us() const { return inhibit_time_100us_; }
  // A new time counts from the last message that was sent under the old one.
  void set_inhibit_time(std::uint16_t time_100us) { inhibit_time_100us_ = time_100us; }

  // Sends a message: at once without an inhibit time, else in `process`.
  void send(const Emergency& emergency);
  void process(std::uint64_t now_us) {
    if (size_ > 0) send_pending(now_us);
  }
  // Drops the messages that wait, when the node's state forbids them.
  void clear() { size_ = 0; }

 private:
  void send_pending(std::uint64_t now_us);
  void transmit(const Emergency& emergency);

  FrameSink& sink_;
  std::uint32_t cob_id_ = kCobIdInvalid;
  std::uint16_t inhibit_time_100us_ = 0;
  std::array<Emergency, kPending> pending_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::optional<std::uint64_t> sent_us_;  // the last message that was sent in `process`
};

}  // namespace koboshi::canopen
