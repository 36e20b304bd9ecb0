#include <array>
#include <vector>

#include "firmware/motion/interpreter.h"
#include "firmware/storage/image.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/unit/firmware/motion/motion_builder.h"

// A motion's image, with its header and checksums made right, played for two seconds with a stop after the
// first, on a trunk that swings. A motion that the validator accepts keeps within the limits of the joints,
// and ends after the stop or is still in a step.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const robot::RobotModel model = test::load_test_robot();
  static const std::vector<std::byte> pattern = test::MotionBuilder(model).image();
  const std::size_t header = storage::kImageHeaderSize + 4;  // and the model's id
  const auto bytes = std::as_bytes(std::span(data, size));
  std::vector<std::byte> image(pattern.begin(), pattern.begin() + static_cast<std::ptrdiff_t>(header));
  image.insert(image.end(), bytes.begin(), bytes.end());
  test::seal(image);
  motion::Motion motion;
  if (!motion::Motion::open(image, model, motion).ok()) return 0;

  estimation::RobotState state;
  const std::array<fixed::Angle, 20> pose{};
  const motion::Inputs inputs{.robot = state, .angles = pose};
  motion::Interpreter interpreter(model);
  interpreter.start(motion, pose, inputs);
  for (int tick = 0; tick < 200 && interpreter.running(); ++tick) {
    if (tick == 100) interpreter.stop();
    const std::int32_t swing = (tick % 20 - 10) * (1 << 24);  // up to 14 degrees and 2.5 turns/s
    state.roll = fixed::Angle::from_raw(swing);
    state.pitch = -state.roll;
    state.rates_B = {fixed::AngularRate::from_raw(swing / 4), fixed::AngularRate::from_raw(-swing / 4),
                     fixed::AngularRate::from_raw(swing / 8)};
    interpreter.advance(10'000, inputs);
    std::array<fixed::Angle, 20> targets{};
    std::ranges::copy(interpreter.targets(), targets.begin());
    interpreter.add_corrections(targets, state);
    for (std::size_t i = 0; i < model.joint_count; ++i) {
      if (targets[i] < model.joints[i].lower || targets[i] > model.joints[i].upper) __builtin_trap();
    }
  }
  return 0;
}
