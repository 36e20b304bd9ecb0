#include "studio/widgets/termination.h"

#include <QSocketNotifier>

#include <fcntl.h>
#include <unistd.h>
#include <array>
#include <csignal>
#include <utility>

namespace koboshi::studio {
namespace {

constexpr std::array kSignals{SIGTERM, SIGINT, SIGHUP};

// Ends of the pipe between the handler, which may call few functions (signal-safety(7)), and the event loop.
int read_end = -1;
int write_end = -1;

void handle(int signal) {
  const auto byte = static_cast<unsigned char>(signal);
  static_cast<void>(!::write(write_end, &byte, 1));
}

}  // namespace

Termination::Termination(std::function<void(int)> end) : end_(std::move(end)) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
  read_end = ends[0];
  write_end = ends[1];
  auto* notifier = new QSocketNotifier(read_end, QSocketNotifier::Read, this);
  connect(notifier, &QSocketNotifier::activated, this, [this] { read_signal(); });
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  for (const int signal : kSignals) ::sigaction(signal, &action, nullptr);
}

Termination::~Termination() {
  for (const int signal : kSignals) std::signal(signal, SIG_DFL);
  for (const int end : {std::exchange(write_end, -1), std::exchange(read_end, -1)})
    if (end >= 0) ::close(end);
}

void Termination::read_signal() {
  unsigned char byte = 0;
  if (::read(read_end, &byte, 1) == 1) end_(byte);
}

}  // namespace koboshi::studio
