#include "tools/run/interrupt.h"

#include <ctime>

namespace koboshi::tools {

Interrupt::Interrupt() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

Interrupt::~Interrupt() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

std::optional<int> Interrupt::requested() {
  const timespec at_once{};
  const int signal = sigtimedwait(&signals_, nullptr, &at_once);
  if (signal > 0) return signal;
  return std::nullopt;
}

}  // namespace koboshi::tools
