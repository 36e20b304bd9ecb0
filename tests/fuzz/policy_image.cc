#include <array>
#include <memory>
#include <vector>

#include "firmware/policy/residual.h"
#include "firmware/storage/image.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/unit/firmware/policy/policy_builder.h"

// A policy's image, with its header and checksums made right, run for 40 cycles on a trunk that swings. A
// policy that the validator accepts keeps its offsets within their bounds.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace koboshi;
  static const robot::RobotModel model = test::make_test_robot();
  const std::size_t header = storage::kImageHeaderSize + 4;  // and the model's id
  std::vector<std::byte> image;
  test::put(image, policy::kPolicyMagic, 4);
  test::put(image, policy::kPolicyVersion, 4);
  image.resize(storage::kImageHeaderSize);
  test::put(image, model.id, 4);
  image.resize(header + size);
  std::ranges::copy(std::as_bytes(std::span(data, size)),
                    image.begin() + static_cast<std::ptrdiff_t>(header));
  test::seal(image);
  const std::unique_ptr<std::byte[]> block(new std::byte[image.size()]);  // not a byte more
  std::ranges::copy(image, block.get());
  policy::Policy policy;
  if (!policy::Policy::open({block.get(), image.size()}, model, policy).ok()) return 0;
  if (policy.work() > policy::kMaxWork) __builtin_trap();

  estimation::RobotState state;
  std::array<fixed::Angle, 20> angles{};
  policy::Residual residual;
  for (int tick = 0; tick < 40; ++tick) {
    const std::int32_t swing = (tick % 20 - 10) * (1 << 24);  // up to 14 degrees and 2.5 turns/s
    state.roll = fixed::Angle::from_raw(swing);
    state.pitch = -state.roll;
    state.rates_B = {fixed::AngularRate::from_raw(swing / 4), fixed::AngularRate::from_raw(-swing / 4),
                     fixed::AngularRate::from_raw(swing / 8)};
    for (std::size_t i = 0; i < angles.size(); ++i)
      angles[i] = fixed::Angle::from_raw(swing * static_cast<std::int32_t>(i % 3));
    residual.advance(policy, {.robot = state, .angles = angles, .targets = angles});
    for (std::size_t i = 0; i < policy.output_count(); ++i) {
      if (fixed::abs(residual.offset(i)) > policy.output(i).bound) __builtin_trap();
    }
    std::array<fixed::Angle, 20> targets = angles;
    residual.add_to(targets);
  }
  return 0;
}
