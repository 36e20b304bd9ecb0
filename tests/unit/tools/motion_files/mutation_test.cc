#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"
#include "tools/motion_files/format/readers.h"

namespace koboshi::tools {
namespace {

// Changes, removes, repeats or cuts off a few bytes.
std::string mutated(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  for (std::size_t left = 1 + below(4); left > 0 && !text.empty(); --left) {
    const std::size_t at = below(text.size());
    const std::size_t length = 1 + below(8);
    switch (below(5)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, text.substr(at, length));
        break;
      case 2:
        text.resize(at);
        break;
      default:
        text[at] = static_cast<char>(below(256));
    }
  }
  return text;
}

void expect_consistent(const ForeignMotion& motion) {
  for (const ForeignSection& section : motion.sections) {
    ASSERT_GE(section.repeat, 1);
    for (const ForeignFrame& frame : section.frames) {
      ASSERT_EQ(frame.values.size(), motion.joints.size());
      ASSERT_GE(frame.move_us, 0);
      ASSERT_GE(frame.pause_us, 0);
      for (const std::size_t joint : frame.without_torque) ASSERT_LT(joint, motion.joints.size());
    }
  }
}

// Whether the file can be read; otherwise it must be refused by one line.
bool is_read(const std::string& bytes) {
  try {
    for (const ForeignMotion& motion : read_foreign_motions("mutated", bytes)) expect_consistent(motion);
    return true;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
}

// The fuzzer's corpus has a file of each format.
TEST(MutatedMotions, AreReadOrRefused) {
  constexpr std::size_t kFiles = 400;
  std::size_t formats = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/tests/fuzz/corpus/foreign_motion")) {
    const std::string original = test::read_file(entry.path());
    ASSERT_TRUE(is_read(original)) << entry.path();
    ++formats;
    std::mt19937 random(49);  // NOLINT: the same files in each run
    std::size_t read = 0;
    for (std::size_t i = 0; i < kFiles; ++i) read += is_read(mutated(original, random)) ? 1u : 0u;
    EXPECT_GT(read, kFiles / 20) << entry.path();  // else the mutations would not reach the readers
    EXPECT_LT(read, kFiles) << entry.path();
  }
  EXPECT_GE(formats, 9u);
}

}  // namespace
}  // namespace koboshi::tools
