#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hal/cortex_m/mps2/wire.h"

namespace koboshi::cortex_m {

// The image's end of the protocol with its host (wire.h). One buffer serves both directions: writing the body
// of an answer overwrites the request.
class Link {
 public:
  struct Request {
    wire::Kind kind;
    std::span<const std::byte> body;
  };

  // Opens both pipes. Ends the debugger if one cannot be opened.
  void open();
  // Waits for the next request; the image idles here. Ends the debugger if the host has closed the pipe.
  [[nodiscard]] Request receive();
  // Returns the buffer for the body of an answer.
  [[nodiscard]] std::span<std::byte> body() { return std::span(message_).subspan(wire::kHeaderBytes); }
  // Sends an answer whose body, `body_size` bytes, has been written to body(). Ends the debugger if the host
  // has closed the pipe.
  void answer(wire::Kind kind, std::size_t body_size);

 private:
  int requests_ = -1;
  int answers_ = -1;
  std::array<std::byte, wire::kMaxMessageBytes> message_;
};

}  // namespace koboshi::cortex_m
