// Skips the tests of a program if the Cortex-M4 image is not built or QEMU is missing.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace koboshi {
namespace {

class NeedsImage : public testing::Environment {
 public:
  void SetUp() override {
    const char* const missing = !std::filesystem::exists(KOBOSHI_IMAGE) ? KOBOSHI_IMAGE
                                : std::system("command -v qemu-system-arm >/dev/null") != 0
                                    ? "qemu-system-arm"
                                    : nullptr;
    if (missing == nullptr) return;
    std::printf("[  SKIPPED ] ");  // the pattern that CTest looks for; GoogleTest prints only the reason here
    std::fflush(stdout);
    GTEST_SKIP() << "there is no " << missing << "; ./run target makes it";
  }
};

[[maybe_unused]] testing::Environment* const needs_image = testing::AddGlobalTestEnvironment(new NeedsImage);

}  // namespace
}  // namespace koboshi
