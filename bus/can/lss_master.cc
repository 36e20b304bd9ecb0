#include "bus/can/lss_master.h"

#include <fmt/core.h>

#include <chrono>
#include <stdexcept>

#include "bus/can/frame_text.h"
#include "bus/can/source.h"
#include "firmware/canopen/frame.h"

namespace koboshi::bus {
namespace {

using canopen::LssCommand;
using Clock = std::chrono::steady_clock;

constexpr std::uint8_t kConfirm = 0x80;  // BitCheck of fastscan: whether there are any slaves
constexpr std::uint64_t kMorePatience = 10;
constexpr std::uint64_t kSettling = 5;
constexpr int kScanAttempts = 3;                       // with twice the patience each time
constexpr std::uint64_t kStoreTimeout_us = 1'000'000;  // a flash is erased

constexpr std::uint8_t number(LssCommand command, std::size_t offset = 0) {
  return static_cast<std::uint8_t>(static_cast<std::size_t>(command) + offset);
}

std::array<std::uint8_t, 8> message(std::uint8_t command, std::uint32_t value = 0) {
  std::array<std::uint8_t, 8> data{command};
  canopen::store_u32(&data[1], value);
  return data;
}

constexpr const char* kNodeIdRefusals[] = {"the node id is out of its range"};
constexpr const char* kBitTimingRefusals[] = {"it does not support this bit rate"};
constexpr const char* kStoreRefusals[] = {"it has no storage", "its storage fails"};

}  // namespace

std::string lss_address_text(const LssAddress& address) {
  return fmt::format("{:08X}:{:08X}:{:08X}:{:08X}", address[0], address[1], address[2], address[3]);
}

LssAddress parse_lss_address(const std::string& text) {
  constexpr const char* kNames[] = {"the vendor id", "the product code", "the revision number",
                                    "the serial number"};
  LssAddress address{};
  std::string rest = text + ":";
  for (std::size_t i = 0; i < address.size(); ++i) {
    const std::size_t end = rest.find(':');
    if (end == std::string::npos)
      throw std::invalid_argument(fmt::format(
          "found the LSS address '{}', expected VENDOR:PRODUCT:REVISION:SERIAL in hexadecimal", text));
    const std::string part = rest.substr(0, end);
    address[i] = static_cast<std::uint32_t>(parse_hexadecimal(part, kNames[i], 0xFFFF'FFFF, part.size()));
    rest.erase(0, end + 1);
  }
  if (!rest.empty())
    throw std::invalid_argument(fmt::format("found the LSS address '{}', expected four numbers", text));
  return address;
}

void LssMaster::send(const Data& data) {
  send_surely(transport_, {.identifier = canopen::kLssRequestCobId, .size = 8, .data = data});
}

std::optional<LssMaster::Data> LssMaster::answer(LssCommand command, std::uint64_t timeout_us) {
  const Clock::time_point end = Clock::now() + std::chrono::microseconds(timeout_us);
  for (;;) {
    while (const auto frame = transport_.receive()) {
      if (frame->identifier == canopen::kLssResponseCobId && frame->size == 8 && !frame->remote &&
          frame->data[0] == number(command)) {
        return frame->data;
      }
    }
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(end - Clock::now()).count();
    if (left <= 0) return std::nullopt;
    wait_for_frames(transport_, static_cast<std::uint64_t>(left));
  }
}

void LssMaster::switch_globally(canopen::LssSlave::State state) {
  send({number(LssCommand::kSwitchGlobal),
        static_cast<std::uint8_t>(state == canopen::LssSlave::State::kConfiguration ? 1 : 0)});
}

bool LssMaster::switch_selectively(const LssAddress& address) {
  for (std::size_t i = 0; i < address.size(); ++i)
    send(message(number(LssCommand::kSwitchVendor, i), address[i]));
  return answer(LssCommand::kSwitched, timeout_us_).has_value();
}

std::uint32_t LssMaster::inquire(LssCommand command) {
  send(message(number(command)));
  const auto first = answer(command, timeout_us_);
  if (!first) throw std::runtime_error("no LSS slave in configuration answers");
  if (answer(command, timeout_us_ / kMorePatience))
    throw std::runtime_error(
        "several LSS slaves are in configuration, expected one: --node or --address selects it");
  return canopen::load_u32(&(*first)[1]);
}

LssAddress LssMaster::inquire_address() {
  LssAddress address{};
  for (std::size_t i = 0; i < address.size(); ++i)
    address[i] = inquire(static_cast<LssCommand>(number(LssCommand::kInquireVendor, i)));
  return address;
}

std::uint8_t LssMaster::inquire_node_id() {
  return static_cast<std::uint8_t>(inquire(LssCommand::kInquireNodeId) & 0xFF);
}

void LssMaster::configure(const Data& data, const char* what, std::span<const char* const> refusals) {
  send(data);
  const auto command = static_cast<LssCommand>(data[0]);
  const auto result = answer(command, command == LssCommand::kStore ? kStoreTimeout_us : timeout_us_);
  if (!result) throw std::runtime_error(fmt::format("no LSS slave in configuration answers to {}", what));
  const std::uint8_t code = (*result)[1];
  if (code == 0) return;
  throw std::runtime_error(fmt::format(
      "the LSS slave refuses {}: {}", what,
      code <= refusals.size() ? refusals[code - 1u] : fmt::format("error {}, {}", code, (*result)[2])));
}

void LssMaster::configure_node_id(std::uint8_t node_id) {
  configure({number(LssCommand::kConfigureNodeId), node_id}, "the node id", kNodeIdRefusals);
}

void LssMaster::configure_bit_timing(std::uint8_t selector) {
  configure({number(LssCommand::kConfigureBitTiming), 0, selector}, "the bit timing", kBitTimingRefusals);
}

void LssMaster::activate_bit_timing(std::uint16_t delay_ms) {
  Data data{number(LssCommand::kActivateBitTiming)};
  canopen::store_u16(&data[1], delay_ms);
  send(data);
}

void LssMaster::store() { configure({number(LssCommand::kStore)}, "to store", kStoreRefusals); }

// --- Fastscan (CiA 305, 6.2.5)

bool LssMaster::scan(std::uint32_t value, unsigned bit, unsigned part, unsigned next,
                     std::uint64_t timeout_us) {
  Data data = message(number(LssCommand::kFastscan), value);
  data[5] = static_cast<std::uint8_t>(bit);
  data[6] = static_cast<std::uint8_t>(part);
  data[7] = static_cast<std::uint8_t>(next);
  send(data);
  if (!answer(LssCommand::kIdentified, timeout_us)) return false;
  // Further slaves answer as well. Their answers must not count for the next bit.
  while (answer(LssCommand::kIdentified, timeout_us / kSettling)) {
  }
  return true;
}

// Finds the address bit by bit from the highest: an answer means that a slave has all bits so far, with a
// zero here. Returns nothing if the address found is no slave's: an answer came too late.
std::optional<LssAddress> LssMaster::scan_all(std::uint64_t timeout_us) {
  LssAddress address{};
  if (!scan(0, kConfirm, 0, 0, timeout_us)) return std::nullopt;
  for (unsigned part = 0; part < address.size(); ++part) {
    for (unsigned bit = 32; bit-- > 0;) {
      if (!scan(address[part], bit, part, part, timeout_us)) address[part] |= std::uint32_t{1} << bit;
    }
    if (!scan(address[part], 0, part, (part + 1) % 4, timeout_us)) return std::nullopt;
  }
  return address;
}

std::optional<LssAddress> LssMaster::fastscan() {
  std::uint64_t timeout_us = timeout_us_ / kMorePatience;
  for (int attempt = 0; attempt < kScanAttempts; ++attempt, timeout_us *= 2) {
    if (const auto address = scan_all(timeout_us)) return address;
    if (!scan(0, kConfirm, 0, 0, timeout_us)) return std::nullopt;
  }
  throw std::runtime_error(
      "fastscan found slaves without a node id, but their answers are too late: a longer --timeout");
}

}  // namespace koboshi::bus
