#include "simulation/motion_language/compile/speed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/interpreter.h"
#include "simulation/motion_language/parse/joints.h"
#include "tests/unit/simulation/motion_language/motion_fixture.h"

namespace koboshi::simulation {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct Curve {
  const char* name;
  double peak_ratio;  // peak speed over mean speed, from rest to rest
};

class MoveSpeeds : public testing::TestWithParam<Curve> {
 protected:
  static double knee_limit_deg_per_s() {
    const std::size_t knee = *JointNames(koboshi_model()).find("left_knee");
    return fixed::to_double(koboshi_model().model.joints[knee].max_speed) / kRadPerDeg;
  }
  std::string codes(const std::string& before, const std::string& speed) const {
    return compile_text(version_2(fmt::format("interpolation: {}\nsteps: [{}{{pose: bend, {}}}]\n",
                                              GetParam().name, before, speed)))
        .codes();
  }
  static constexpr const char* kFromZero = "{pose: straight, time_s: 1}, ";
};

TEST_P(MoveSpeeds, AreCheckedByTheirPeak) {
  const double shortest_s = GetParam().peak_ratio * 60.0 / knee_limit_deg_per_s();
  EXPECT_EQ(codes(kFromZero, fmt::format("time_s: {:.6f}", shortest_s * 1.001)), "");
  EXPECT_EQ(codes(kFromZero, fmt::format("time_s: {:.6f}", shortest_s * 0.999)), "M040");
  EXPECT_EQ(codes("", fmt::format("time_s: {:.6f}", shortest_s * 0.5)), "") << "from an unknown angle";
}

TEST_P(MoveSpeeds, GivenAsASpeedAreThePeakWhateverTheCurve) {
  EXPECT_EQ(codes(kFromZero, fmt::format("speed_deg_per_s: {:.3f}", knee_limit_deg_per_s() * 0.999)), "");
  EXPECT_EQ(codes(kFromZero, fmt::format("speed_deg_per_s: {:.3f}", knee_limit_deg_per_s() * 1.001)), "M040");
  EXPECT_EQ(codes("", fmt::format("speed_deg_per_s: {:.3f}", knee_limit_deg_per_s() * 2.0)), "")
      << "from an unknown angle";
}

// Plays moves by speed in the firmware's interpreter, from the pose before and from another one.
TEST_P(MoveSpeeds, AreThoseOfTheFastestJointWhenPlayed) {
  constexpr double kSpeed_deg_per_s = 90.0;
  const Compiled compiled = compile_text(version_2(
      fmt::format("interpolation: {}\nsteps: [{{pose: {{left_knee: 70, left_hip_roll: 10, head_pan: -20}}, "
                  "speed_deg_per_s: {}}}]\n",
                  GetParam().name, kSpeed_deg_per_s)));
  ASSERT_EQ(compiled.messages(), "");
  motion::Motion opened;
  ASSERT_TRUE(motion::Motion::open(compiled.motion.image, koboshi_model().model, opened).ok());
  const std::size_t knee = *JointNames(koboshi_model()).find("left_knee");
  for (const double start_deg : {0.0, 110.0}) {
    std::vector<fixed::Angle> pose(koboshi_model().joint_names.size());
    pose[knee] = fixed::from_double<fixed::Angle>(start_deg * kRadPerDeg);
    motion::Interpreter interpreter(koboshi_model().model);
    const estimation::RobotState state;
    const motion::Inputs inputs{.robot = state};
    interpreter.start(opened, pose, inputs);
    double peak_deg_per_s = 0.0;
    double time_s = 0.0;
    std::vector<double> before(pose.size());
    for (std::size_t i = 0; i < pose.size(); ++i) before[i] = fixed::to_double(interpreter.targets()[i]);
    while (interpreter.running() && time_s < 10.0) {
      interpreter.advance(1'000, inputs);
      time_s += 0.001;
      for (std::size_t i = 0; i < pose.size(); ++i) {
        const double now = fixed::to_double(interpreter.targets()[i]);
        peak_deg_per_s = std::max(peak_deg_per_s, std::abs(now - before[i]) / kRadPerDeg / 0.001);
        before[i] = now;
      }
    }
    EXPECT_NEAR(peak_deg_per_s, kSpeed_deg_per_s, 0.005 * kSpeed_deg_per_s) << "from " << start_deg;
    const double way_deg = std::max(std::abs(70.0 - start_deg), 20.0);
    EXPECT_NEAR(time_s, GetParam().peak_ratio * way_deg / kSpeed_deg_per_s, 0.003) << "from " << start_deg;
  }
}

TEST_P(MoveSpeeds, OfALeastTimeAreNeverTooFast) {
  if (std::string(GetParam().name) == "cubic") {
    EXPECT_EQ(codes(kFromZero, "at_least_s: 0.001"), "M026");
    return;
  }
  EXPECT_EQ(codes(kFromZero, "at_least_s: 0.001"), "");
  EXPECT_EQ(codes(kFromZero, "at_least_s: 0.001, time_s: 1"), "M026");
  EXPECT_EQ(codes(kFromZero, "at_least_s: 0.001, speed_deg_per_s: 1"), "M026");
  EXPECT_EQ(codes(kFromZero, "at_least_s: 61"), "M004");
}

// The image has the oldest version that can say it, so that motions without the new keys keep their bytes.
TEST(ImageVersion, IsTheOldestThatHasTheSteps) {
  const auto version = [](const std::string& step) {
    const Compiled compiled = compile_text(version_2("steps: [{pose: bend, " + step + "}]\n"));
    EXPECT_EQ(compiled.messages(), "");
    return std::to_integer<int>(compiled.motion.image.at(4));
  };
  EXPECT_EQ(version("time_s: 1"), 2);
  EXPECT_EQ(version("time_s: 1, interpolation: cubic"), 2);
  EXPECT_EQ(version("at_least_s: 1"), 3);
  EXPECT_EQ(version("time_s: 1, interpolation: trapezoid"), 3);
}

INSTANTIATE_TEST_SUITE_P(Interpolations, MoveSpeeds,
                         testing::Values(Curve{"linear", 1.0}, Curve{"minimum_jerk", 15.0 / 8.0},
                                         Curve{"cubic", 1.5}, Curve{"trapezoid", 1.5}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace koboshi::simulation
