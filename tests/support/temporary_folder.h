#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace koboshi::test {

// A new folder in the system's temporary folder (TMPDIR), removed with its contents by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() : path(make()) {}
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path path;

 private:
  // The folder's name contains the test's name, to identify what a crashed test leaves behind.
  static std::filesystem::path make() {
    std::string name = "koboshi_";
    if (const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info()) {
      name += std::string(test->test_suite_name()) + "_" + test->name() + "_";
    }
    std::ranges::replace(name, '/', '_');
    std::string path = std::filesystem::temp_directory_path() / (name + "XXXXXX");
    if (mkdtemp(path.data()) == nullptr) throw std::system_error(errno, std::generic_category(), path);
    return path;
  }
};

inline std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

}  // namespace koboshi::test
