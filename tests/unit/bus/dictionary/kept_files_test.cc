#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "bus/dictionary/files.h"
#include "sim_board/description/load.h"
#include "simulation/assembly/parameters.h"
#include "simulation/scenario/reader.h"

namespace koboshi::bus {
namespace {

const std::filesystem::path kRoot = KOBOSHI_SOURCE_DIR;

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(DictionaryFiles, InTheRepositoryMatchTheTables) {
  const auto robot = kRoot / "robots/koboshi/robot.sdf";
  const auto files = dictionary_files(
      sim_board::load_robot(robot), simulation::controller_values(simulation::read_robot_parameters(robot)));
  EXPECT_EQ(files.size(), 10u);
  for (const GeneratedFile& file : files) {
    EXPECT_TRUE(contents(kRoot / "docs/reference" / file.name) == file.text)
        << "docs/reference/" << file.name << " is stale: run koboshi dictionary write";
  }
}

}  // namespace
}  // namespace koboshi::bus
