#include <vector>

#include "firmware/robot/model.h"
#include "firmware/storage/image.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/unit/firmware/robot/test_robot.h"

// A robot model's image, with its header and checksum made right.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const std::vector<std::byte> pattern = test::encode(test::make_test_robot());
  const auto bytes = std::as_bytes(std::span(data, size));
  std::vector<std::byte> image(pattern.begin(), pattern.begin() + storage::kImageHeaderSize);
  image.insert(image.end(), bytes.begin(), bytes.end());
  test::seal(image);
  robot::RobotModel model;
  if (load_model(image, model) != robot::ModelStatus::kOk) return 0;
  if (model.joint_count > model.joints.size()) __builtin_trap();
  for (std::size_t i = 0; i < model.joint_count; ++i) {
    if (model.joints[i].lower > model.joints[i].upper) __builtin_trap();
  }
  return 0;
}
