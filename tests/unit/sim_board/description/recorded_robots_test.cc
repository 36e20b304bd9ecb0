// The descriptions that libsdformat 12.3 gave on Debian 12 of generated robot files, before the reader of
// this project took its place (docs/decision/0022-robot-files-without-libsdformat.md).

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

#include "base/text/text.h"
#include "sim_board/description/load.h"
#include "tests/unit/sim_board/description/recorded_robots.h"
#include "tests/unit/sim_board/description/robot_text.h"

namespace koboshi::sim_board {
namespace {

struct Digest {
  std::uint64_t hash = 0;   // FNV-1a of robot_text(), which has all values to the last bit
  std::size_t numbers = 0;  // in it
  double sum = 0.0;         // of the numbers below 100 in magnitude, each with a weight of its own
};

// A factor from -1 to 1 for the number at this place. Neighbours differ, as do permutations.
double weight_of(std::size_t place) {
  const std::uint64_t mixed = (static_cast<std::uint64_t>(place) + 1) * 0x9E3779B97F4A7C15U;
  return static_cast<double>(mixed >> 11U) * 0x1p-52 - 1.0;
}

Digest digest_of(const std::string& text) {
  Digest digest{.hash = 0xCBF29CE484222325U};
  for (const char c : text) digest.hash = (digest.hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto number = parse_number(word);
    if (!number) continue;
    const double weight = weight_of(digest.numbers++);
    if (std::abs(*number) < 100.0) digest.sum += weight * *number;
  }
  return digest;
}

std::string line_of(const std::string& name, const Digest& digest) {
  std::ostringstream line;
  line.precision(17);
  line << name << " " << std::hex << digest.hash << std::dec << " " << digest.numbers << " " << digest.sum;
  return line.str();
}

using Digests = std::map<std::string, Digest>;

Digests recorded_digests() {
  std::istringstream lines(read_text_file(KOBOSHI_SOURCE_DIR
                                          "/tests/unit/sim_board/description/recorded/descriptions.txt",
                                          "recorded descriptions"));
  Digests digests;
  for (std::string name; lines >> name;) {
    Digest& digest = digests[name];
    lines >> std::hex >> digest.hash >> std::dec >> digest.numbers >> digest.sum;
  }
  return digests;
}

// The machine whose mathematical library the record has in its last bits.
bool is_debian_12() {
  std::ifstream file("/etc/os-release");  // nothing can be read from one that is not there
  const std::string release(std::istreambuf_iterator<char>(file), {});
  return release.find("\nID=debian\n") != std::string::npos &&
         release.find("\nVERSION_ID=\"12\"\n") != std::string::npos;
}

// Bit for bit on Debian 12. Elsewhere sine and cosine may differ in their last bits: all numbers, as one
// weighted sum, to 1e-12.
TEST(RecordedRobots, LoadAsRecorded) {
  const Digests recorded = recorded_digests();
  const bool has_same_bits = is_debian_12();
  const std::vector<RecordedRobot> robots = recorded_robots();
  ASSERT_EQ(robots.size(), 201u);
  ASSERT_EQ(recorded.size(), robots.size());
  for (const RecordedRobot& robot : robots) {
    ASSERT_TRUE(recorded.contains(robot.name)) << robot.name;
    const Digest& expected = recorded.at(robot.name);
    RobotDescription loaded = load_robot("recorded.sdf", robot.text);
    for (JointDescription& joint : loaded.joints)
      if (joint.drive.node_id >= kNodeShift)
        joint.drive.node_id = static_cast<std::uint8_t>(joint.drive.node_id - kNodeShift);
    const Digest actual = digest_of(robot_text(loaded));
    EXPECT_EQ(actual.numbers, expected.numbers) << robot.name;
    EXPECT_NEAR(actual.sum, expected.sum, 1e-12) << robot.name;
    if (!has_same_bits) continue;
    EXPECT_EQ(line_of(robot.name, actual), line_of(robot.name, expected));
  }
}

// The record would not show an error in what no file has.
TEST(RecordedRobots, HaveAllKindsOfFrames) {
  std::string all;
  for (const RecordedRobot& robot : recorded_robots()) all += robot.text;
  for (const char* part : {"version=\"1.5\"",
                           "version=\"1.6\"",
                           "version=\"1.7\"",
                           "version=\"1.8\"",
                           "version=\"1.9\"",
                           " frame=\"",
                           " relative_to=\"link_",
                           " relative_to=\"joint_",
                           " relative_to=\"frame_",
                           " relative_to=\"__model__",
                           " attached_to=\"link_",
                           " attached_to=\"joint_",
                           " attached_to=\"frame_",
                           " expressed_in=\"",
                           "<use_parent_model_frame>",
                           " canonical_link=\"",
                           " placement_frame=\"",
                           "<parent>frame_",
                           "<child>frame_",
                           "<ixy>"})
    EXPECT_NE(all.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace koboshi::sim_board
