// docs/reference/worlds.md shows the ranges of the code.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "simulation/disturbance/world_text.h"

namespace koboshi::simulation {
namespace {

TEST(WorldsPage, ShowsTheRangesOfTheCode) {
  std::ifstream file(KOBOSHI_SOURCE_DIR "/docs/reference/worlds.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, testing::HasSubstr(world_table(TableStyle::kMarkdown)));
}

}  // namespace
}  // namespace koboshi::simulation
