#include "tests/unit/sim_board/description/small_robot.h"

#include <gtest/gtest.h>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "tests/unit/base/scratch_file.h"

namespace koboshi::sim_board {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

std::string with(const std::string& from, const std::string& to) { return replaced(kSmallRobot, from, to); }

std::string complaint(const std::string& text) {
  const ScratchFile scratch("sdf", text);
  try {
    load_robot(scratch.path());
  } catch (const InputError& error) {
    std::string message = error.what();
    if (message.starts_with(scratch.path().string()))
      message.replace(0, scratch.path().string().size(), "FILE");
    return message;
  }
  return "nothing";
}

}  // namespace koboshi::sim_board
