#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hal/cortex_m/mps2/wire.h"

namespace koboshi::cortex_m {

// The image's end of the talk with its host (wire.h). One buffer serves both ways: a request is gone once
// the body of its answer is written.
class Link {
 public:
  struct Request {
    wire::Kind kind;
    std::span<const std::byte> body;
  };

  void open();
  // Waits for the next request; this is where the image idles. Ends the debugger when the host is gone.
  [[nodiscard]] Request receive();
  // Where the body of an answer goes, before it is sent.
  [[nodiscard]] std::span<std::byte> body() { return std::span(message_).subspan(wire::kHeaderBytes); }
  void answer(wire::Kind kind, std::size_t body_size);

 private:
  int requests_ = -1;
  int answers_ = -1;
  std::array<std::byte, wire::kMaxMessageBytes> message_;
};

}  // namespace koboshi::cortex_m
