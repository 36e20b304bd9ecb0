#include "sim_board/can/transport/log_transport.h"

#include <array>
#include <cerrno>
#include <system_error>

#include "sim_board/can/candump_log.h"

namespace koboshi::sim {

LogTransport::LogTransport(const std::filesystem::path& file) : file_(file), stream_(file) {
  if (!stream_) throw std::system_error(errno, std::generic_category(), file.string());
}

bool LogTransport::send(const hal::CanFrame& frame, std::uint64_t time_us) {
  std::array<char, kMaxLogLineBytes> line{};
  const std::size_t length = format_log_line(line, frame, time_us);
  return static_cast<bool>(stream_.write(line.data(), static_cast<std::streamsize>(length)));
}

}  // namespace koboshi::sim
