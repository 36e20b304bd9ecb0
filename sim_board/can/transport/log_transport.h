#pragma once

#include <filesystem>

#include "base/file/output_file.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {

// Writes the bus traffic in simulated time to a log in the format of candump -L. Receives nothing.
class LogTransport final : public Transport {
 public:
  // Throws WriteError, as send and flush do.
  explicit LogTransport(const std::filesystem::path& file);

  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  void flush() override { log_.flush(); }
  std::optional<hal::CanFrame> receive() override { return std::nullopt; }
  std::string place() const override { return file_.string(); }
  bool is_live() const override { return false; }

 private:
  std::filesystem::path file_;
  OutputFile log_;
};

}  // namespace koboshi::sim_board
