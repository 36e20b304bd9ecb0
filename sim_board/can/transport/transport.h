#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "hal/port/can.h"

namespace koboshi::sim {

// A way for frames out of this process and into it: to whatever else takes part in the simulated bus. Nothing
// blocks.
class Transport {
 public:
  virtual ~Transport() = default;

  // Hands over a frame that was on the bus at this simulated time. False when there is no room for it: it is
  // lost for those who listen here, and for nobody else.
  [[nodiscard]] virtual bool send(const hal::CanFrame& frame, std::uint64_t time_us) = 0;
  // Lets go of frames that were gathered. To be called once a millisecond, and after the last one.
  virtual void flush() {}
  // The oldest frame that came in.
  [[nodiscard]] virtual std::optional<hal::CanFrame> receive() = 0;
  // Frames that the system has lost on the way in, because they came faster than they were fetched. As far as
  // it tells.
  virtual std::uint64_t dropped() const { return 0; }
  // For the person who opened it, where to find it; such as the name of a pseudo-terminal.
  virtual std::string place() const = 0;
  // What poll() may wait for; -1 for none.
  virtual int descriptor() const { return -1; }
  // Whether there is somebody who lives by the clock on the wall, so that a simulation should, too.
  virtual bool is_live() const { return true; }
  // Whether its calls take so long that a thread of their own pays.
  virtual bool is_slow() const { return false; }
};

// Opens a transport by its name:
//   socketcan:vcan0             an interface of Linux; refused unless it is vcan or vxcan, or `real_bus`
//   udp:239.74.163.2:43113      python-can's udp_multicast
//   slcan                       Lawicel's ASCII protocol on a pseudo-terminal
//   log:FILE                    a log as of candump -L, written
// Null for "none". Throws std::invalid_argument for any other name and for a bus that is refused,
// std::system_error for what the system refuses.
std::unique_ptr<Transport> open_transport(const std::string& name, bool real_bus = false);

}  // namespace koboshi::sim
