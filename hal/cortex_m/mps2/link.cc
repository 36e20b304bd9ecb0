#include "hal/cortex_m/mps2/link.h"

#include <cassert>

#include "hal/cortex_m/mps2/semihosting.h"

namespace koboshi::cortex_m {

void Link::open() {
  requests_ = semihosting::open(wire::kRequestPath, semihosting::Mode::kRead);
  answers_ = semihosting::open(wire::kAnswerPath, semihosting::Mode::kWrite);
  if (requests_ < 0 || answers_ < 0) semihosting::exit();
}

Link::Request Link::receive() {
  const std::size_t received = semihosting::read(requests_, message_);
  if (received == 0) semihosting::exit();
  const std::size_t length =
      std::to_integer<std::size_t>(message_[0]) | std::to_integer<std::size_t>(message_[1]) << 8;
  assert(received >= wire::kHeaderBytes && received == wire::kLengthBytes + length);
  return {static_cast<wire::Kind>(message_[2]),
          std::span(message_).first(received).subspan(wire::kHeaderBytes)};
}

void Link::answer(wire::Kind kind, std::size_t body_size) {
  const std::size_t length = 1 + body_size;
  message_[0] = static_cast<std::byte>(length & 0xFF);
  message_[1] = static_cast<std::byte>(length >> 8);
  message_[2] = static_cast<std::byte>(kind);
  const auto message = std::span(message_).first(wire::kLengthBytes + length);
  if (semihosting::write(answers_, message) != message.size()) semihosting::exit();
}

}  // namespace koboshi::cortex_m
