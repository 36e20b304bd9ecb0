#pragma once

#include <filesystem>
#include <fstream>

#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// A log of the bus in simulated time, as of candump -L. Nothing comes from it.
class LogTransport final : public Transport {
 public:
  // Throws std::system_error when the file cannot be written.
  explicit LogTransport(const std::filesystem::path& file);

  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  std::optional<hal::CanFrame> receive() override { return std::nullopt; }
  std::string place() const override { return file_.string(); }
  bool is_live() const override { return false; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
};

}  // namespace koboshi::sim
