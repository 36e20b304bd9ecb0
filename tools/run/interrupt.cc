#include "tools/run/interrupt.h"

#include <poll.h>
#include <sys/signalfd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

namespace koboshi::tools {
namespace {

using std::chrono::nanoseconds;

timespec time_of(nanoseconds time) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  return {.tv_sec = seconds.count(), .tv_nsec = (time - seconds).count()};
}

}  // namespace

Interrupt::Interrupt() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  arrived_ =
      hal::FileDescriptor(hal::checked(signalfd(-1, &signals_, SFD_CLOEXEC), "a descriptor of signals"));
}

std::optional<int> Interrupt::requested() {
  const timespec at_once{};
  const int signal = sigtimedwait(&signals_, nullptr, &at_once);
  if (signal > 0) return signal;
  return std::nullopt;
}

void Interrupt::sleep_until(std::chrono::steady_clock::time_point due) {
  const auto left = std::max<nanoseconds>(due - std::chrono::steady_clock::now(), nanoseconds(0));
  pollfd signal{.fd = arrived_.number(), .events = POLLIN, .revents = 0};
  const timespec timeout = time_of(left);
  ppoll(&signal, 1, &timeout, nullptr);
}

bool Interrupt::wait_for_input(int descriptor, std::uint64_t timeout_us) {
  std::array<pollfd, 2> files{{{.fd = arrived_.number(), .events = POLLIN, .revents = 0},
                               {.fd = descriptor, .events = POLLIN, .revents = 0}}};
  const timespec timeout = time_of(std::chrono::microseconds(timeout_us));
  ppoll(files.data(), files.size(), &timeout, nullptr);
  return files[0].revents == 0;
}

void Interrupt::release() {
  if (std::exchange(blocks_, false)) pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace koboshi::tools
