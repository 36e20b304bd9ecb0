#pragma once

#include <cstddef>
#include <vector>

#include "hal/port/can.h"

namespace koboshi::sim_board::test {

// A classic CAN frame written out bit by bit as the standard's text says it, without tables or shortcuts.
struct EncodedFrame {
  std::vector<bool> unstuffed;  // SOF to CRC sequence
  std::vector<bool> wire;       // SOF to EOF, stuffed
  unsigned crc = 0;

  int stuff_bits() const { return static_cast<int>(wire.size()) - static_cast<int>(unstuffed.size()) - 10; }
};

inline void append(std::vector<bool>& bits, unsigned value, int count) {
  for (int i = count - 1; i >= 0; --i) bits.push_back((value >> i & 1u) != 0);
}

inline unsigned reference_crc(const std::vector<bool>& bits) {
  unsigned crc = 0;
  for (const bool bit : bits) {
    const bool next = bit != ((crc & 0x4000u) != 0);
    crc = crc << 1 & 0x7FFFu;
    if (next) crc ^= 0x4599u;
  }
  return crc;
}

inline std::vector<bool> reference_stuffing(const std::vector<bool>& bits) {
  std::vector<bool> out;
  int run = 0;
  for (const bool bit : bits) {
    run = !out.empty() && out.back() == bit ? run + 1 : 1;
    out.push_back(bit);
    if (run == 5) {
      out.push_back(!bit);
      run = 1;
    }
  }
  return out;
}

inline EncodedFrame encode(const hal::CanFrame& frame) {
  EncodedFrame encoded;
  append(encoded.unstuffed, 0, 1);  // SOF
  append(encoded.unstuffed, frame.identifier, 11);
  append(encoded.unstuffed, frame.remote ? 1 : 0, 1);  // RTR
  append(encoded.unstuffed, 0, 2);                     // IDE, r0
  append(encoded.unstuffed, frame.size, 4);
  for (std::size_t i = 0; i < frame.size && !frame.remote; ++i) append(encoded.unstuffed, frame.data[i], 8);
  encoded.crc = reference_crc(encoded.unstuffed);
  append(encoded.unstuffed, encoded.crc, 15);
  encoded.wire = reference_stuffing(encoded.unstuffed);
  append(encoded.wire, 0b101, 3);  // CRC delimiter, ACK slot (acknowledged), ACK delimiter
  append(encoded.wire, 0x7F, 7);   // EOF
  return encoded;
}

}  // namespace koboshi::sim_board::test
