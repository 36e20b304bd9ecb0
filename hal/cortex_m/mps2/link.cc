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
  const auto message = std::span(message_).first(received);
  assert(wire::is_message(message));
  return {wire::kind_of(message), message.subspan(wire::kHeaderBytes)};
}

void Link::answer(wire::Kind kind, std::size_t body_size) {
  const auto message = std::span(message_).first(wire::put_header(message_, kind, body_size));
  if (semihosting::write(answers_, message) != message.size()) semihosting::exit();
}

}  // namespace koboshi::cortex_m
