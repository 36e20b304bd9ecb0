#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "firmware/canopen/lss_slave.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::bus {

// Vendor id, product code, revision number, serial number.
using LssAddress = canopen::LssSlave::Address;

// VENDOR:PRODUCT:REVISION:SERIAL in hexadecimal, 8 digits each. The second throws std::invalid_argument.
std::string lss_address_text(const LssAddress& address);
LssAddress parse_lss_address(const std::string& text);

// A blocking LSS master (CiA 305). Without an answer, and when a slave refuses, its functions throw
// std::runtime_error; those that return optional or bool return nothing or false without an answer.
class LssMaster {
 public:
  // `timeout_us`: for an answer. A tenth of it is the wait for the answers of further slaves, and at each bit
  // of fastscan that is one.
  explicit LssMaster(sim_board::Transport& transport, std::uint64_t timeout_us = 500'000)
      : transport_(transport), timeout_us_(timeout_us) {}

  // All slaves go to waiting or configuration. Not answered.
  void switch_globally(canopen::LssSlave::State state);
  // The slave with this address goes to configuration.
  [[nodiscard]] bool switch_selectively(const LssAddress& address);
  // Finds a slave in waiting that has no node id, and puts it into configuration.
  std::optional<LssAddress> fastscan();

  // Return the identity of the slave in configuration. Throw if several answer.
  LssAddress inquire_address();
  std::uint8_t inquire_node_id();
  void configure_node_id(std::uint8_t node_id);
  // `selector`: of the table of CiA 305, 0 for 1000 kbit/s.
  void configure_bit_timing(std::uint8_t selector);
  // All slaves in configuration switch to the configured bit timing after this delay, twice. Not answered.
  void activate_bit_timing(std::uint16_t delay_ms);
  void store();

 private:
  using Data = std::array<std::uint8_t, 8>;

  void send(const Data& data);
  // The answers that begin with this command: the first one within the time, or all.
  std::optional<Data> answer(canopen::LssCommand command, std::uint64_t timeout_us);
  std::uint32_t inquire(canopen::LssCommand command);
  // Sends a command and throws unless its error code is 0. `refusals`: meanings of the codes from 1 on.
  void configure(const Data& data, const char* what, std::span<const char* const> refusals);
  bool scan(std::uint32_t value, unsigned bit, unsigned part, unsigned next, std::uint64_t timeout_us);
  std::optional<LssAddress> scan_all(std::uint64_t timeout_us);

  sim_board::Transport& transport_;
  std::uint64_t timeout_us_;
};

}  // namespace koboshi::bus
