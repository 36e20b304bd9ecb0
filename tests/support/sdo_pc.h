#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/sdo/protocol.h"
#include "tests/support/controller_bench.h"

namespace koboshi::test {

// A PC that reads and writes the controller's objects by SDO, and waits for each answer in the bench's time.
class SdoPc {
 public:
  explicit SdoPc(ControllerBench& bench) : bench_(bench) {}

  // Expedited, 1..4 bytes.
  canopen::AbortCode write(canopen::ObjectAddress address, std::int32_t value, std::size_t size);
  std::uint32_t read(canopen::ObjectAddress address);
  // By segments.
  canopen::AbortCode download(canopen::ObjectAddress address, std::span<const std::byte> bytes);
  // By blocks, with their CRC; what the server does not take is sent again.
  canopen::AbortCode download_blocks(canopen::ObjectAddress address, std::span<const std::byte> bytes);
  // Empty when it is refused, with the reason in `refusal`.
  std::vector<std::byte> upload(canopen::ObjectAddress address);

  canopen::AbortCode save() { return write({0x1010, 1}, 0x65766173, 4); }
  canopen::AbortCode restore() { return write({0x1011, 1}, 0x64616F6C, 4); }

  canopen::AbortCode refusal = canopen::AbortCode::kNone;  // of the last transfer
  int answer_ms = 0;                                       // how long its slowest answer took

 private:
  using Data = canopen::sdo::Data;

  void begin();
  void send(const Data& data);
  // False when the answer is an abort, or does not come.
  bool ask(const Data& data, Data& answer);
  bool await(Data& answer);
  bool send_block(std::span<const std::byte> bytes, std::size_t& done);

  ControllerBench& bench_;
};

}  // namespace koboshi::test
