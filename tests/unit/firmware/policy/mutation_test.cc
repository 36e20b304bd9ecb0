#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "firmware/policy/residual.h"
#include "tests/unit/firmware/policy/policy_builder.h"

// Runs every mutated image that the validator accepts. A policy must not read outside the image (each is a
// heap block of its own, for the address sanitizer), no sum may overflow (for the sanitizer of undefined
// behaviour), its work must be within the limit, and every offset within its bound.
namespace koboshi::policy {
namespace {

using test::PolicyBuilder;
using Random = std::mt19937;

constexpr std::uint32_t kSeed = 20261128;

// The number of images; the environment variable KOBOSHI_MUTATIONS sets another one, for runs by hand.
int image_count() {
  const char* const given = std::getenv("KOBOSHI_MUTATIONS");
  return given == nullptr ? 10'000 : std::max(1'000, std::atoi(given));
}

PolicyBuilder random_image(Random& random, const robot::RobotModel& model) {
  const auto function = static_cast<Activation>(random() % 5);
  std::vector<std::uint8_t> hidden;
  for (auto i = random() % 3; i > 0; --i) hidden.push_back(static_cast<std::uint8_t>(8 + 8 * (random() % 5)));
  PolicyBuilder builder =
      test::random_policy(random, model, 1 + random() % 20, hidden, 1 + random() % 10, function);
  for (auto& layer : builder.layers) layer.fraction_bits = static_cast<std::uint8_t>(8 + random() % 5);
  return builder;
}

void mutate(Random& random, std::vector<std::byte>& image) {
  // The weights are most of the image, and every byte of them is valid: the rest is hit as often.
  const std::size_t end = random() % 2 == 0 ? image.size() : std::min<std::size_t>(image.size(), 400);
  for (auto i = 1 + random() % 3; i > 0; --i) {
    // An earlier mutation may have cut the image off.
    const std::size_t at = std::min<std::size_t>(16 + random() % (end - 16), image.size() - 1);
    switch (random() % 4) {
      case 0:
        image[at] = static_cast<std::byte>(random());
        break;
      case 1:
        image[at] ^= static_cast<std::byte>(1u << random() % 8);
        break;
      case 2:
        image[at] = random() % 2 == 0 ? std::byte{0xFF} : std::byte{0};
        break;
      default:
        if (random() % 16 == 0) image.resize(16 + random() % image.size());
        break;
    }
    if (image.size() <= at) return;
  }
}

estimation::RobotState random_state(Random& random) {
  const auto raw = [&] { return static_cast<std::int32_t>(random()) >> random() % 24; };
  estimation::RobotState state;
  state.roll = fixed::Angle::from_raw(raw());
  state.pitch = fixed::Angle::from_raw(raw());
  state.rates_B = {fixed::AngularRate::from_raw(raw()), fixed::AngularRate::from_raw(raw()),
                   fixed::AngularRate::from_raw(raw())};
  state.accelerations_B.x = fixed::Acceleration::from_raw(raw());
  state.feet[0].load = fixed::Force::from_raw(raw());
  state.feet[1].x = fixed::Length::from_raw(raw());
  return state;
}

void run(const Policy& policy, Random& random) {
  Residual residual;
  ASSERT_LE(policy.work(), kMaxWork);
  std::array<fixed::Angle, 20> angles{};
  std::array<fixed::Angle, kMaxOutputs> last{};
  for (int cycle = 0; cycle < 12; ++cycle) {
    for (fixed::Angle& angle : angles) angle = fixed::Angle::from_raw(static_cast<std::int32_t>(random()));
    const estimation::RobotState state = random_state(random);
    residual.advance(policy, {.robot = state, .angles = angles, .targets = angles});
    for (std::size_t i = 0; i < policy.output_count(); ++i) {
      const Output output = policy.output(i);
      ASSERT_LE(fixed::abs(residual.offset(i)), output.bound);
      ASSERT_LE(fixed::abs(residual.offset(i) - last[i]), output.rate);
      ASSERT_LT(output.joint, 20);
      last[i] = residual.offset(i);
    }
    std::array<fixed::Angle, 20> targets = angles;
    residual.add_to(targets);
  }
}

TEST(Mutation, IsRefusedOrRunsWithinItsBounds) {
  Random random(kSeed);
  robot::RobotModel model = test::make_test_robot();
  model.id = 0xABCD'EF01;
  int accepted = 0;
  int unsealed = 0;
  std::array<int, 15> refused{};
  for (int i = 0; i < image_count(); ++i) {
    std::vector<std::byte> bytes = random_image(random, model).image();
    mutate(random, bytes);
    const bool sealed = random() % 8 != 0;
    if (sealed && bytes.size() >= 16) test::seal(bytes);
    // Exactly as many bytes as the image has, at an aligned address.
    const std::unique_ptr<std::byte[]> block(new std::byte[bytes.size()]);
    std::ranges::copy(bytes, block.get());
    Policy policy;
    const PolicyVerdict verdict = Policy::open({block.get(), bytes.size()}, model, policy);
    ++refused[static_cast<std::size_t>(verdict.status)];
    if (!verdict.ok()) continue;
    ++accepted;
    unsealed += sealed ? 0 : 1;
    ASSERT_NO_FATAL_FAILURE(run(policy, random)) << "image " << i << " of seed " << kSeed;
  }
  // Both kinds must occur, and most reasons of a refusal.
  EXPECT_GT(accepted, image_count() / 10);
  EXPECT_LT(accepted, image_count() * 9 / 10);
  for (const PolicyStatus status :
       {PolicyStatus::kBadSize, PolicyStatus::kBadCrc, PolicyStatus::kOtherRobot, PolicyStatus::kBadCount,
        PolicyStatus::kBadName, PolicyStatus::kBadInput, PolicyStatus::kBadOutput, PolicyStatus::kBadLayer,
        PolicyStatus::kBadBias})
    EXPECT_GT(refused[static_cast<std::size_t>(status)], 0) << static_cast<int>(status);
}

}  // namespace
}  // namespace koboshi::policy
