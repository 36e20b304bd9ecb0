#include "sim_board/can/transport/log_transport.h"

#include <array>

#include "sim_board/can/candump_log.h"

namespace koboshi::sim_board {

LogTransport::LogTransport(const std::filesystem::path& file) : file_(file), log_(file) {}

bool LogTransport::send(const hal::CanFrame& frame, std::uint64_t time_us) {
  std::array<char, kMaxLogLineBytes> line{};
  log_.write({line.data(), format_log_line(line, frame, time_us)});
  return true;
}

}  // namespace koboshi::sim_board
