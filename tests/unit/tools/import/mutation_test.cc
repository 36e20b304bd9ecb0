// Files of strangers: whatever a byte, a line or an attribute becomes, the import reads the file or names
// what is wrong with it.

#include <gtest/gtest.h>

#include <ctime>
#include <fstream>
#include <random>

#include "base/text/error.h"
#include "base/text/text.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/mesh/merge.h"
#include "tools/import/mesh/mesh_reader.h"
#include "tools/import/mesh/primitives.h"
#include "tools/import/pipeline/import_robot.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

class Mutator {
 public:
  explicit Mutator(std::uint32_t seed) : random_(seed) {}

  std::string mutate(std::string text) {
    static const std::vector<std::string> kTokens{
        "0",    "-1",    "1e300",     "nan",        "inf",  "1e-300", "",        "<",  "\"",
        "/>",   "fixed", "prismatic", "continuous", "body", "base",   "../../x", "l3", "package://x/y.stl",
        "-0.0", "1e5",   "\xff"};
    const std::size_t count = 1 + pick(2);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = pick(text.size());
      switch (pick(12)) {
        case 0:
          text[at] = static_cast<char>(pick(256));
          break;
        case 1:
          text.erase(at, 1 + pick(40));
          break;
        case 2:
          text.insert(at, text.substr(pick(text.size()), pick(200)));
          break;
        case 3:
        case 4:
        case 5:
        case 6: {  // a digit
          const std::size_t digit = text.find_first_of("0123456789", at);
          if (digit != std::string::npos) text[digit] = static_cast<char>('0' + pick(10));
          break;
        }
        default: {  // the value of an attribute
          const std::size_t begin = text.find('"', at);
          const std::size_t end = begin == std::string::npos ? begin : text.find('"', begin + 1);
          if (end != std::string::npos)
            text.replace(begin + 1, end - begin - 1, kTokens[pick(kTokens.size())]);
        }
      }
    }
    return text;
  }

 private:
  std::size_t pick(std::size_t count) { return count == 0 ? 0 : random_() % count; }

  std::mt19937 random_;
};

class ImportMutation : public testing::Test {
 protected:
  // Imports mutants. Returns how many were read.
  int import_mutants(const std::string& name, const std::string& text, int count) const {
    Mutator mutator(20261126);
    int read = 0;
    for (int i = 0; i < count; ++i) {
      const std::string mutant = mutator.mutate(text);
      std::ofstream(folder_ / name, std::ios::binary) << mutant;
      const std::clock_t start = std::clock();
      try {
        const ImportResult result =
            import_robot({.file = folder_ / name,
                          .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                          .output = folder_ / "out"});
        for (const auto& [file, content] : result.files)
          EXPECT_EQ(file.find(".."), std::string::npos) << file;
        ++read;
      } catch (const InputError& error) {
        EXPECT_EQ(error.file(), folder_ / name) << error.what();
      }
      // Processor time, far above what an import takes: the load of the machine is none of the import's.
      EXPECT_LT(std::clock() - start, 5 * CLOCKS_PER_SEC) << "mutant " << i;
    }
    return read;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path;
};

// The fuzzer of foreign robots (tests/fuzz) makes many more; these also go through what follows the reader.
TEST_F(ImportMutation, OfUrdfIsReadOrRefused) {
  const int read = import_mutants("kit.urdf", KitRobot{}.text(), 40);
  EXPECT_GT(read, 4);
  EXPECT_LT(read, 38);
}

TEST_F(ImportMutation, OfSdfIsReadOrRefused) {
  const std::string text =
      read_text_file(fs::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf", "a robot");
  const int read = import_mutants("robot.sdf", text, 12);
  EXPECT_GT(read, 2);
  EXPECT_LT(read, 12);
}

TEST_F(ImportMutation, OfMeshesIsReadOrRefused) {
  const std::string stl = stl_bytes(*primitive_surface(ShapeKind::kBox, {0.1, 0.2, 0.3}));
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 4 2\n";
  for (const auto& [name, text] : {std::pair{"a.stl", stl}, std::pair{"a.obj", obj}}) {
    Mutator mutator(7);
    for (int i = 0; i < 60; ++i) {
      std::ofstream(folder_ / name, std::ios::binary) << mutator.mutate(text);
      const MeshFile mesh = read_mesh_file(folder_ / name);
      EXPECT_NE(mesh.mesh.has_value(), !mesh.fault.empty());
    }
  }
}

}  // namespace
}  // namespace koboshi::tools
