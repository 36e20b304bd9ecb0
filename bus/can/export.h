#pragma once

#include <map>
#include <set>
#include <string>

#include "bus/can/source.h"

namespace koboshi::bus {

// Frames of a log in the formats of other programs, a line for each.

// The table's head and a row: seconds, interface, direction (R or T), identifier in hexadecimal, format
// (standard, extended, fd, xl, error), remote (0 or 1), size in bytes, data in hexadecimal, description.
std::string csv_head();
std::string csv_row(const TimedFrame& timed, const std::string& description);

// Vector's ASCII format (ASC), as log2asc writes it and asc2log reads it. The times are those of the log;
// there is no `date`, which asc2log would add to them.
class AscWriter {
 public:
  static std::string head();
  // Empty for a frame of CAN XL.
  std::string line(const TimedFrame& timed);

 private:
  int channel_of(const std::string& interface);

  std::map<std::string, int> channels_;
  std::set<int> taken_;
};

}  // namespace koboshi::bus
