#include "tools/motion_check/check.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "sim_board/description/load.h"
#include "tests/support/seed.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr const char* kRobot = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";

// The head of a motion; its poses are `stand`, `nod`, and `crossed`, in which a forearm is in the trunk.
constexpr const char* kHead =
    "version: 2\nrobot: koboshi\nname: test\n{}poses:\n"
    "  stand: {{others: zero, hip_pitch: -15.9, knee: 43.72, ankle_pitch: -27.82, shoulder_roll: 8, elbow: "
    "-20}}\n"
    "  nod: {{from: stand, head_tilt: 20}}\n"
    "  crossed: {{from: stand, elbow: 0, shoulder_roll: -15}}\n";

class MotionCheckerTest : public testing::Test {
 protected:
  static MotionChecker& checker() {
    static MotionChecker checker(kRobot);
    return checker;
  }
  // `extra`: further keys before the poses.
  CompiledMotion compiled(const std::string& steps, const std::string& extra = "") const {
    const std::filesystem::path file = folder_.path / "test.yaml";
    std::ofstream(file) << fmt::format(fmt::runtime(kHead), extra) << steps;
    return checker().compile(file);
  }
  MotionReport check(const std::string& steps, const std::string& extra = "") const {
    return checker().check(compiled(steps, extra));
  }
  // The codes of the findings but those of unused poses.
  static std::vector<std::string> codes(const MotionReport& report) {
    std::vector<std::string> result;
    for (const simulation::Diagnostic& diagnostic : report.diagnostics)
      if (diagnostic.code != "C017") result.push_back(diagnostic.code);
    return result;
  }
  static const simulation::Diagnostic& find(const MotionReport& report, std::string_view code) {
    for (const simulation::Diagnostic& diagnostic : report.diagnostics)
      if (diagnostic.code == code) return diagnostic;
    throw std::runtime_error("no " + std::string(code));
  }

  static double head_tilt_limit_deg() {
    const sim_board::RobotDescription robot = sim_board::load_robot(kRobot);
    const auto joint = std::ranges::find(robot.joints, "head_tilt", &sim_board::JointDescription::name);
    return joint->upper_rad * 180.0 / std::numbers::pi;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(MotionCheckerTest, FollowsBothOutcomesOfABranch) {
  const std::string branch =
      "steps:\n  - {{pose: stand, time_s: 1}}\n  - {{if: input(1) == 1, then: [{{pose: {}, time_s: 1}}], "
      "else: [{{pose: {}, time_s: 1}}]}}\n  - {{pose: stand, time_s: 1}}\n";
  EXPECT_THAT(codes(check(fmt::format(fmt::runtime(branch), "nod", "stand"))), IsEmpty());
  const MotionReport then = check(fmt::format(fmt::runtime(branch), "crossed", "nod"));
  EXPECT_EQ(then.paths.size(), 2U);
  EXPECT_THAT(find(then, "C005").found, HasSubstr("other outcome of the condition of line 10"));
  const MotionReport otherwise = check(fmt::format(fmt::runtime(branch), "nod", "crossed"));
  EXPECT_THAT(find(otherwise, "C005").found, Not(HasSubstr("other outcome")));
}

// An attitude about upright says that the robot stands, however wide it is; one of a robot that sits ends the
// judgement, and the report says for how long.
TEST_F(MotionCheckerTest, JudgesOnAfterAnExpectedAttitudeAboutUpright) {
  const auto report = [&](double pitch_deg, double within_deg) {
    return check(
        fmt::format("  lean: {{from: stand, ankle_pitch: 15}}\nsteps:\n  - {{pose: stand, time_s: 1}}\n"
                    "  - {{expect: {{pitch_deg: {}, within_deg: {}}}}}\n  - {{pose: lean, time_s: 1}}\n"
                    "  - {{pose: stand, time_s: 1}}\n",
                    pitch_deg, within_deg));
  };
  for (const double within_deg : {5.0, 25.0, 30.0, 90.0}) {
    EXPECT_EQ(report(0, within_deg).balance, Balance::kUnstable) << within_deg;
    EXPECT_THAT(codes(report(0, within_deg)), testing::Contains("C006")) << within_deg;
    EXPECT_THAT(codes(report(0, within_deg)), testing::Not(testing::Contains("C022"))) << within_deg;
  }
  const MotionReport sits = report(40, 30);
  EXPECT_EQ(sits.balance, Balance::kStable);
  EXPECT_THAT(find(sits, "C022").found, HasSubstr("a balance that is not judged for 2.5"));
}

TEST_F(MotionCheckerTest, DoesNotProposeAnInterpolationThatIsUsed) {
  const auto hint = [&](const std::string& interpolation) {
    const MotionReport report = check(
        "  lean: {from: stand, ankle_pitch: -21}\nsteps:\n  - {pose: stand, time_s: 1}\n"
        "  - {pose: lean, time_s: 0.04}\n  - {pose: stand, time_s: 1}\n",
        "interpolation: " + interpolation + "\n");
    for (const simulation::Diagnostic& diagnostic : report.diagnostics)
      if (diagnostic.hint.find("times its time") != std::string::npos) return diagnostic.hint;
    return simulation::print(report.diagnostics);
  };
  EXPECT_THAT(hint("linear"), HasSubstr("times its time, or use minimum_jerk"));
  EXPECT_THAT(hint("minimum_jerk"), testing::EndsWith("times its time."));
}

TEST_F(MotionCheckerTest, CountsTimeOutsInTheDuration) {
  const MotionReport report = check(
      "steps:\n  - {pose: stand, time_s: 1}\n"
      "  - {wait: {until: input(1) == 0, timeout_s: 7, else: continue}}\n"
      "  - {wait: {until: input(2) == 0, timeout_s: 4}}\n  - {pose: stand, time_s: 1}\n");
  EXPECT_NEAR(report.paths.front().duration_s, 2.5, 0.02) << "without time-outs";
  // The first time-out and then the second, at which the motion fails; its pose is held for 0.5 s.
  EXPECT_NEAR(report.duration_s, 1.0 + 7.0 + 4.0 + 0.5, 0.02);
  EXPECT_THAT(codes(report), IsEmpty());
}

TEST_F(MotionCheckerTest, LeavesALoopThatASensorEnds) {
  const MotionReport report = check(
      "steps:\n  - {pose: stand, time_s: 1}\n"
      "  - loop: {while: input(1) == 0, steps: [{pose: nod, time_s: 0.5}, {pose: stand, time_s: 0.5}]}\n"
      "  - {pose: crossed, time_s: 1}\n  - {pose: stand, time_s: 1}\n");
  EXPECT_THAT(find(report, "C005").place.line, 11);
  const MotionReport body = check(
      "steps:\n  - {pose: stand, time_s: 1}\n"
      "  - loop: {while: input(1) == 1, steps: [{pose: crossed, time_s: 0.5}, {pose: stand, time_s: 0.5}]}\n"
      "  - {pose: stand, time_s: 1}\n");
  EXPECT_THAT(find(body, "C005").place.line, 10);
}

TEST_F(MotionCheckerTest, MeetsExpectationsInRoutinesAndBehindJumps) {
  const MotionReport report = check(
      "routines:\n  lie:\n    - {expect: {pitch_deg: 80, roll_deg: 0, within_deg: 20}}\n"
      "    - {pose: nod, time_s: 0.5}\n"
      "steps:\n  - {expect: {pitch_deg: 0, roll_deg: 0, within_deg: 20}}\n  - {jump: down}\n"
      "  - {label: up}\n  - {expect: {pitch_deg: 0, roll_deg: 0, within_deg: 20}}\n"
      "  - {pose: stand, time_s: 1}\n  - end\n"
      "  - {label: down}\n  - {call: lie}\n  - {jump: up}\n");
  EXPECT_FALSE(report.paths.front().steps.empty());
  EXPECT_NEAR(report.paths.front().duration_s, 2.0, 0.03);
  EXPECT_TRUE(std::isinf(report.paths.front().steps.front().least_margin_m)) << "lying";
  EXPECT_TRUE(std::isfinite(report.paths.front().steps.back().least_margin_m)) << "upright again";
}

TEST_F(MotionCheckerTest, NamesMoreStepsThanACycleHolds) {
  const auto steps = [](int count) {
    std::string text = "steps:\n  - {pose: stand, time_s: 1}\n";
    for (int i = 0; i < count; ++i) text += "  - {set: {a: \"+= 1\"}}\n";
    return text + "  - {pose: nod, time_s: 1}\n  - {if: a > 1, then: [{pose: stand, time_s: 1}]}\n";
  };
  EXPECT_THAT(codes(check(steps(10), "variables: {a: 0}\n")), testing::Not(testing::Contains("C016")));
  EXPECT_THAT(codes(check(steps(20), "variables: {a: 0}\n")), testing::Contains("C016"));
}

TEST_F(MotionCheckerTest, WarnsOfWhatIsNotReachedOrRead) {
  const MotionReport report = check(
      "steps:\n  - {pose: stand, time_s: 1}\n  - {set: {written: 3}}\n  - end\n"
      "  - {pose: nod, time_s: 1}\n  - {pose: crossed, time_s: 1}\n",
      "variables: {written: 0}\n");
  EXPECT_THAT(codes(report), UnorderedElementsAre("C014", "C015"));
  EXPECT_EQ(find(report, "C014").place.line, 13);
  EXPECT_THAT(find(report, "C015").found, HasSubstr("'written'"));
}

TEST_F(MotionCheckerTest, SaysThatThereAreMorePathsThanItFollows) {
  std::string steps = "steps:\n  - {pose: stand, time_s: 0.1}\n";
  for (int i = 0; i < 40; ++i)
    steps += fmt::format(
        "  - {{if: input(1) == {}, then: [{{pose: {{from: stand, head_pan: {}}}, time_s: 0.1}}]}}\n", i, i);
  const MotionReport report = check(steps);
  EXPECT_TRUE(report.cut);
  EXPECT_EQ(find(report, "C018").severity, simulation::Severity::kNote);
}

// The pose at the cut is not the motion's end, and the cut is no stop of the robot.
TEST_F(MotionCheckerTest, SaysThatItCutALongMotion) {
  const auto report = [&](int waits) {
    std::string steps = "  aside: {from: stand, shoulder_roll: 40}\nsteps:\n  - {pose: aside, time_s: 1}\n";
    for (int i = 0; i < waits; ++i) steps += "  - {wait_s: 60}\n";
    return check(steps + "  - {pose: stand, time_s: 1}\n");
  };
  const MotionReport whole = report(19);
  EXPECT_FALSE(whole.duration_cut);
  EXPECT_NEAR(whole.duration_s, 1 + 19 * 60 + 1 + 0.5, 0.02);
  EXPECT_THAT(codes(whole), UnorderedElementsAre("C019")) << "stopped";
  const MotionReport cut = report(21);
  EXPECT_TRUE(cut.duration_cut);
  EXPECT_THAT(codes(cut), UnorderedElementsAre("C019", "C019"));
  EXPECT_THAT(cut.diagnostics.back().found, HasSubstr("the check cut after 1200 s at 1200.00 s"));
  EXPECT_NE(cut.balance, Balance::kNotJudged);
}

TEST_F(MotionCheckerTest, ACancelledCheckReturnsNothing) {
  const CompiledMotion motion = compiled("steps:\n  - {pose: stand, time_s: 1}\n");
  std::stop_source cancel;
  EXPECT_TRUE(checker().check(motion, cancel.get_token()).has_value());
  cancel.request_stop();
  EXPECT_FALSE(checker().check(motion, cancel.get_token()).has_value());
  EXPECT_TRUE(checker().check(motion, std::stop_token()).has_value());
}

// Cancelled at whatever place, a check leaves nothing behind that changes a later one.
// The pose is 4 degrees below the upper limit of the joint: one bound of 3 degrees is within it, two are not.
TEST_F(MotionCheckerTest, WarnsOfAMixThatMayBeClamped) {
  const double near_deg = head_tilt_limit_deg() - 4.0;
  const auto report = [&](double limit_deg, const std::string& more) {
    return check(fmt::format("  near: {{from: stand, head_tilt: {}}}\n", near_deg) +
                 "steps:\n  - {pose: stand, time_s: 1}\n" +
                 fmt::format("  - {{mix: {{head_tilt: {{pitch_rate: 0.05, limit_deg: {}}}}}}}\n", limit_deg) +
                 more + "  - {pose: near, time_s: 1}\n  - {pose: stand, time_s: 1}\n");
  };
  EXPECT_THAT(codes(report(3, "")), IsEmpty());
  EXPECT_THAT(codes(report(5, "  - {mix: none}\n")), IsEmpty());
  EXPECT_THAT(codes(report(5, "")), UnorderedElementsAre("C012"));
  const MotionReport two = report(3, "  - {mix: {head_tilt: {pitch: 0.5, limit_deg: 3}}}\n");
  EXPECT_THAT(find(two, "C012").found, HasSubstr("up to 2.0 deg beyond the limit of head_tilt"));
  EXPECT_EQ(find(two, "C012").place.line, 13) << "the move";
}

// Planted examples of mixes at their bounds; `mix` is the map of a step.
class MixesOfACheck : public MotionCheckerTest {
 protected:
  MotionReport check_mix(const std::string& mix, const std::string& poses = "",
                         const std::string& pose = "stand") const {
    return check(poses + "steps:\n  - {pose: stand, time_s: 1}\n  - {mix: {" + mix +
                 "}}\n  - {pose: " + pose + ", time_s: 1}\n  - {mix: none}\n  - {pose: stand, time_s: 1}\n");
  }
};

TEST_F(MixesOfACheck, AreFineWithinSmallBounds) {
  const MotionReport report = check_mix("ankle_pitch: {pitch_rate: 0.05, limit_deg: 2}");
  EXPECT_THAT(codes(report), IsEmpty());
  EXPECT_EQ(report.balance, Balance::kStable);
}

// Ankles and hips that lean the trunk to the same side carry the centre of mass over the edge of the soles;
// with the opposite gain the hips balance the ankles.
TEST_F(MixesOfACheck, WarnOfTheCentreOfMassAndMakeTheVerdictClose) {
  const std::string mix =
      "ankle_pitch: {{pitch_rate: 0.05, limit_deg: 15}}, hip_pitch: {{pitch_rate: {}, limit_deg: 15}}";
  const MotionReport report = check_mix(fmt::format(fmt::runtime(mix), "0.05"));
  const simulation::Diagnostic& finding = find(report, "C021");
  EXPECT_EQ(finding.severity, simulation::Severity::kWarning);
  EXPECT_THAT(finding.found, HasSubstr("outside the support polygon to the "));
  EXPECT_THAT(finding.found, HasSubstr("if the mixes of pitch_rate ("));
  EXPECT_EQ(finding.place.line, 11) << "the move after the mix";
  EXPECT_FALSE(report.has_errors()) << "a bound is a possibility";
  EXPECT_EQ(report.balance, Balance::kClose);
  EXPECT_GT(report.least_margin_m, 0.005) << "the margin is that without corrections";
  const MotionReport balanced = check_mix(fmt::format(fmt::runtime(mix), "-0.05"));
  EXPECT_THAT(codes(balanced), IsEmpty());
  EXPECT_EQ(balanced.balance, Balance::kStable);
}

TEST_F(MixesOfACheck, WarnOfLinksThatOverlapOnlyAtTheBounds) {
  const std::string poses = "  near: {from: stand, elbow: 0, shoulder_roll: 2}\n";
  EXPECT_THAT(codes(check_mix("head_pan: {roll: 0.5, limit_deg: 5}", poses, "near")), IsEmpty());
  const MotionReport report = check_mix("left_shoulder_roll: {roll: 0.5, limit_deg: 15}", poses, "near");
  const simulation::Diagnostic& finding = find(report, "C020");
  EXPECT_EQ(finding.severity, simulation::Severity::kWarning);
  EXPECT_THAT(finding.found, HasSubstr("if the mixes of roll ("));
  EXPECT_THAT(codes(report), testing::Not(testing::Contains("C005")));
}

// Joints that share a source move together: legs that follow one source in parallel never meet, whatever
// their bounds, while legs that approach each other do.
TEST_F(MixesOfACheck, MoveTheJointsOfASourceTogether) {
  const std::string mix =
      "left_hip_roll: {{roll: 0.5, limit_deg: 12}}, right_hip_roll: {{roll: {}, limit_deg: 12}}";
  const auto overlaps = [&](const char* gain) {
    return codes(check_mix(fmt::format(fmt::runtime(mix), gain)));
  };
  EXPECT_THAT(overlaps("0.5"), testing::Not(testing::Contains("C020")));
  EXPECT_THAT(overlaps("-0.5"), testing::Contains("C020"));
  const MotionReport two_sources =
      check_mix("left_hip_roll: {roll: 0.5, limit_deg: 12}, right_hip_roll: {roll_rate: 0.5, limit_deg: 12}");
  EXPECT_THAT(find(two_sources, "C020").found, HasSubstr("if the mixes of roll_rate (")) << "of both sources";
}

TEST_F(MixesOfACheck, AreAddedUpByJoint) {
  const std::string pitch = "  - {mix: {ankle_pitch: {pitch: 0.1, limit_deg: 12}}}\n";
  const std::string rate = "  - {mix: {ankle_pitch: {pitch_rate: 0.1, limit_deg: 12}}}\n";
  const auto codes_with = [&](const std::string& mixes) {
    return codes(check("steps:\n  - {pose: stand, time_s: 1}\n" + mixes + "  - {wait_s: 1}\n"));
  };
  EXPECT_THAT(codes_with(pitch), IsEmpty());
  EXPECT_THAT(codes_with(pitch + rate), testing::Contains("C021"));
}

TEST_F(MotionCheckerTest, GoesOnAfterACancelledCheck) {
  std::string steps = "steps:\n";
  for (int i = 0; i < 30; ++i)
    steps += fmt::format("  - {{pose: {{from: stand, ankle_pitch: {}, elbow: {}}}, time_s: 0.4}}\n",
                         -20 - i % 9, -i);
  const CompiledMotion motion = compiled(steps);
  MotionChecker interrupted(kRobot);
  std::optional<MotionReport> report;
  int cancelled = -1;
  for (std::chrono::microseconds delay{0}; !report; delay = 2 * delay + std::chrono::microseconds(500)) {
    std::stop_source cancel;
    if (delay.count() == 0) cancel.request_stop();
    const std::jthread other([&cancel, delay] {
      std::this_thread::sleep_for(delay);
      cancel.request_stop();
    });
    report = interrupted.check(motion, cancel.get_token());
    ++cancelled;
  }
  EXPECT_GT(cancelled, 0);
  MotionChecker fresh(kRobot);
  const MotionReport whole = fresh.check(motion);
  EXPECT_EQ(simulation::print(report->diagnostics), simulation::print(whole.diagnostics));
  EXPECT_EQ(report->least_margin_m, whole.least_margin_m);
  EXPECT_EQ(report->least_margin_s, whole.least_margin_s);
  ASSERT_EQ(interrupted.states().size(), fresh.states().size());
  for (std::size_t i = 0; i < fresh.states().size(); ++i) {
    ASSERT_EQ(interrupted.states()[i].zmp_m, fresh.states()[i].zmp_m) << i;
    ASSERT_EQ(interrupted.states()[i].overlap.depth_m, fresh.states()[i].overlap.depth_m) << i;
  }
}

// A checker that has seen the versions before gives the report of one that has not.
TEST_F(MotionCheckerTest, RandomEditsGiveTheReportOfAFreshCheck) {
  std::mt19937_64 random(test::kSeed);
  std::vector<int> tilts{0, 5, 10, 15, 20};
  MotionChecker edited(kRobot);
  for (int edit = 0; edit < 4; ++edit) {
    tilts[random() % tilts.size()] = static_cast<int>(random() % 30);
    if (random() % 3 == 0) tilts.push_back(static_cast<int>(random() % 30));
    std::string steps = "steps:\n  - {pose: stand, time_s: 0.5}\n";
    for (const int tilt : tilts)
      steps += fmt::format("  - {{pose: {{from: stand, ankle_pitch: {}}}, time_s: 0.3}}\n", -12 - tilt);
    const CompiledMotion motion = compiled(steps);
    const MotionReport seen = edited.check(motion);
    MotionChecker fresh(kRobot);
    const MotionReport whole = fresh.check(motion);
    ASSERT_EQ(simulation::print(seen.diagnostics), simulation::print(whole.diagnostics));
    ASSERT_EQ(seen.least_margin_m, whole.least_margin_m);
    ASSERT_EQ(seen.paths.front().steps.size(), whole.paths.front().steps.size());
    for (std::size_t i = 0; i < whole.paths.front().steps.size(); ++i)
      ASSERT_EQ(seen.paths.front().steps[i].torque.share, whole.paths.front().steps[i].torque.share);
    if (edit > 0) {
      EXPECT_LT(edited.analysis().computed(), fresh.analysis().computed());
    }
  }
}

}  // namespace
}  // namespace koboshi::tools
