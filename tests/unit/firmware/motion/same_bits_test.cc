// Motions that must have the same bits everywhere (tests/unit/firmware/fixed/digest.h).

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/firmware/fixed/digest.h"
#include "tests/unit/firmware/motion/interpreter_fixture.h"

namespace koboshi::motion {
namespace {

class MotionBits : public InterpreterTest {
 protected:
  std::int32_t uniform(std::int32_t low, std::int32_t high) {
    const auto span = static_cast<std::uint64_t>(std::int64_t{high} - low) + 1;
    return static_cast<std::int32_t>(low + static_cast<std::int64_t>(random_() % span));
  }
  std::int32_t about_zero(std::int32_t most) { return uniform(-most, most); }

  // Draws what the program measures.
  void measure() {
    state_.roll = fixed::Angle::from_raw(about_zero(1 << 29));
    state_.pitch = fixed::Angle::from_raw(about_zero(1 << 29));
    state_.rates_B = {fixed::AngularRate::from_raw(about_zero(1 << 24)),
                      fixed::AngularRate::from_raw(about_zero(1 << 24)),
                      fixed::AngularRate::from_raw(about_zero(1 << 24))};
    state_.up_B.z = fixed::Ratio::from_raw(uniform(1 << 28, 1 << 30));
    for (const std::size_t side : {0u, 1u}) {
      state_.feet[side].valid = uniform(0, 1) == 1;
      state_.feet[side].load = fixed::Force::from_raw(uniform(0, 1 << 24));
    }
    state_.zmp.valid = uniform(0, 1) == 1;
    state_.zmp.x = fixed::Length::from_raw(about_zero(1 << 20));
    state_.zmp.y = fixed::Length::from_raw(about_zero(1 << 20));
    for (fixed::Angle& angle : measured_) angle = fixed::Angle::from_raw(about_zero(1 << 28));
    for (std::int16_t& torque : torques_) torque = static_cast<std::int16_t>(about_zero(1'000));
    for (std::int16_t& value : values_) value = static_cast<std::int16_t>(about_zero(32'767));
    inputs_.supply_mV = static_cast<std::uint32_t>(uniform(5'000, 8'400));
    inputs_.walking = uniform(0, 1) == 1;
  }
  void add_state() {
    digest_.add(interpreter_.running());
    digest_.add(interpreter_.failed());
    digest_.add(interpreter_.step_index());
    digest_.add(interpreter_.lean().roll.raw());
    digest_.add(interpreter_.lean().pitch.raw());
    digest_.add(interpreter_.softened());
    for (const std::int32_t variable : interpreter_.variables()) digest_.add(variable);
    std::array<fixed::Angle, 20> targets{};
    std::ranges::copy(interpreter_.targets(), targets.begin());
    for (const fixed::Angle target : targets) digest_.add(target.raw());
    interpreter_.add_corrections(targets, state_);
    for (std::size_t joint = 0; joint < targets.size(); ++joint) {
      digest_.add(targets[joint].raw());
      digest_.add(interpreter_.stiffness_percent(joint));
    }
  }
  // Plays for at most two minutes, in ticks of all lengths.
  void play(const test::MotionBuilder& builder, int stop_after = 1 << 30) {
    start(builder);
    for (int tick = 0; tick < 12'000 && (interpreter_.running() || interpreter_.fading()); ++tick) {
      if (tick == stop_after) interpreter_.stop();
      measure();
      interpreter_.advance(static_cast<std::uint32_t>(uniform(1'000, 30'000)), inputs_);
      add_state();
    }
    EXPECT_FALSE(interpreter_.running());
    EXPECT_FALSE(interpreter_.failed());
  }

  std::mt19937 random_{431};
  test::Digest digest_;
};

TEST_F(MotionBits, OfMovesOfEachKind) {
  for (int motion = 0; motion < 12; ++motion) {
    test::MotionBuilder builder(model_);
    for (std::uint16_t pose = 0; pose < 8; ++pose) {
      std::vector<std::int32_t> numbers;
      for (std::size_t joint = 0; joint < model_.joint_count; ++joint)
        numbers.push_back(uniform(pose_number(model_.joints[joint].lower) / 2,
                                  pose_number(model_.joints[joint].upper) / 2));
      builder.packed_pose((1u << model_.joint_count) - 1, numbers);
      Move move{.interpolation = static_cast<Interpolation>(motion < 4 ? motion : uniform(0, 3)),
                .pose = pose,
                .value = static_cast<std::uint32_t>(uniform(10'000, 700'000))};
      move.by_speed = uniform(0, 3) == 0;
      if (move.by_speed) move.value = static_cast<std::uint32_t>(uniform(1 << 20, 1 << 24));
      move.at_least = !move.by_speed && move.interpolation != Interpolation::kCubic && uniform(0, 1) == 0;
      // A cubic goes through a pose only if the next move follows at once.
      const bool declares_lean = motion % 2 == 1;
      if (declares_lean)
        builder.step(LeanDeclaration{static_cast<std::int16_t>(about_zero(4'000)),
                                     static_cast<std::int16_t>(about_zero(4'000))}
                         .step());
      builder.step(move.step());
    }
    play(builder.step(Opcode::kEnd));
  }
  EXPECT_EQ(digest_.value(), 0x096A'4967'5A57'DC19u);
}

// Reads every source into variables, calculates with them, compares, and corrects joints by all deviations.
TEST_F(MotionBits, OfProgramsThatMeasure) {
  using enum Opcode;
  for (int motion = 0; motion < 12; ++motion) {
    test::MotionBuilder builder = knee_poses();
    builder.variable_count = 4;
    const auto assign = [&](Arithmetic operation, std::int32_t right, bool from_source) {
      builder.step(Assignment{.variable = static_cast<std::uint16_t>(uniform(0, 3)),
                              .operation = operation,
                              .from_source = from_source,
                              .right = right}
                       .step());
    };
    for (const MixSource source : {MixSource::kRollRate, MixSource::kPitchRate, MixSource::kYawRate,
                                   MixSource::kRoll, MixSource::kPitch})
      builder.step(Mix{.source = source,
                       .joint = static_cast<std::uint8_t>(uniform(0, 19)),
                       .gain = static_cast<std::int16_t>(about_zero(1'500)),
                       .limit = static_cast<std::uint16_t>(uniform(Mix::kMinLimit, Mix::kMaxLimit))}
                       .step());
    builder.step(Stiffness{.percent = static_cast<std::uint8_t>(uniform(0, 99)),
                           .joints = static_cast<std::uint32_t>(uniform(1, (1 << 20) - 1))}
                     .step());
    for (std::uint32_t source = 0; source <= static_cast<std::uint32_t>(kLastSource); ++source) {
      const bool indexed = source == 0 || (source >= 13 && source <= 15) || source == 17;
      const auto index = static_cast<std::uint8_t>(indexed ? uniform(0, 3) : 0);
      const SourceRef reference{static_cast<Source>(source), index};
      const auto operation = static_cast<Arithmetic>(uniform(0, 7));
      const bool divides = operation == Arithmetic::kDivide || operation == Arithmetic::kRemainder;
      assign(divides ? Arithmetic::kAssign : operation, reference.packed(), true);
      assign(operation, divides ? uniform(1, 999) : about_zero(50'000), false);
      if (source % 4 == 3) {
        const auto here = static_cast<std::uint16_t>(builder.steps.size());
        builder.step(Condition{.count = 1, .any = false, .negated = uniform(0, 1) == 1}.branch(
            static_cast<std::uint16_t>(here + 3)));
        builder.step(motion::Test{.left = {Source::kVariable, index},
                                  .comparison = static_cast<Comparison>(uniform(0, 5)),
                                  .with_variable = true,
                                  .right = uniform(0, 3)}
                         .step());
        builder.step(kWait, 0, static_cast<std::uint32_t>(uniform(1'000, 40'000)));
      }
      builder.step(Move{.interpolation = Interpolation::kMinimumJerk,
                        .pose = static_cast<std::uint16_t>(uniform(0, 2)),
                        .value = static_cast<std::uint32_t>(uniform(5'000, 90'000))}
                       .step());
    }
    builder.step(kMixClear);
    builder.step(kWait, 0, 300'000);
    play(builder.step(kEnd), motion % 3 == 0 ? 20 : 1 << 30);
  }
  EXPECT_EQ(digest_.value(), 0xC11E'0CD1'CC02'E1DBu);
}

}  // namespace
}  // namespace koboshi::motion
