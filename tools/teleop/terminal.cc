#include "tools/teleop/terminal.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "tools/teleop/status.h"

namespace koboshi::tools {
namespace {

// Control sequences of xterm: alternate screen, no wrapping at the right edge, no cursor; and their reverse.
constexpr std::string_view kBegin = "\x1B[?1049h\x1B[?7l\x1B[?25l\x1B[2J";
constexpr std::string_view kEnd = "\x1B[?25h\x1B[?7h\x1B[?1049l";

constexpr std::size_t kRows = 24;  // if the terminal does not report its size

// Ignores errors: they must not end the run.
void write_out(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::size_t rows() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row : kRows;
}

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

}  // namespace

bool Terminal::is_there() { return isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0; }

Terminal::Terminal() {
  if (tcgetattr(STDIN_FILENO, &before_) != 0) fail("terminal");
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_iflag &= ~static_cast<tcflag_t>(IXON);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;
  raw.c_cc[VQUIT] = _POSIX_VDISABLE;
  if (tcsetattr(STDIN_FILENO, TCSAFLUSH, &raw) != 0) fail("terminal");
  write_out(kBegin);
}

Terminal::~Terminal() {
  write_out(kEnd);
  tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
}

std::string Terminal::read() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (closed_ || poll(&input, 1, 0) <= 0) return {};
  std::array<char, 256> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count > 0) return {bytes.data(), static_cast<std::size_t>(count)};
  closed_ = count == 0 || errno != EINTR;
  return {};
}

void Terminal::show(const std::vector<std::string>& lines) { write_out(screen_of(lines, rows())); }

}  // namespace koboshi::tools
