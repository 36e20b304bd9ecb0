#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/sdo/protocol.h"
#include "tests/support/controller_bench.h"

namespace koboshi::test {

// A PC that reads and writes the controller's objects by SDO. Each call waits for its answers in the bench's
// time.
class SdoPc {
 public:
  explicit SdoPc(ControllerBench& bench) : bench_(bench) {}

  // Expedited download of 1 to 4 bytes.
  canopen::AbortCode write(canopen::ObjectAddress address, std::int32_t value, std::size_t size);
  std::uint32_t read(canopen::ObjectAddress address);
  // Segmented download.
  canopen::AbortCode download(canopen::ObjectAddress address, std::span<const std::byte> bytes);
  // Block download with CRC. Resends segments that the server did not accept.
  canopen::AbortCode download_blocks(canopen::ObjectAddress address, std::span<const std::byte> bytes);
  // Returns the object's data. If the server aborts, returns an empty vector and sets `refusal`.
  std::vector<std::byte> upload(canopen::ObjectAddress address);

  canopen::AbortCode save() { return write({0x1010, 1}, 0x65766173, 4); }
  canopen::AbortCode restore() { return write({0x1011, 1}, 0x64616F6C, 4); }

  canopen::AbortCode refusal = canopen::AbortCode::kNone;  // abort code of the last transfer
  int answer_ms = 0;                                       // time to its slowest answer

 private:
  using Data = canopen::sdo::Data;

  void begin();
  void send(const Data& data);
  // Sends a request. Returns false if the answer is an abort or does not arrive.
  bool ask(const Data& data, Data& answer);
  bool await(Data& answer);
  bool send_block(std::span<const std::byte> bytes, std::size_t& done);

  ControllerBench& bench_;
};

}  // namespace koboshi::test
