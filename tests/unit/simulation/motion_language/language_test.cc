#include <numbers>
#include <set>
#include <sstream>

#include "base/text/text.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/motion/instructions.h"
#include "simulation/motion_language/compile/decompile.h"
#include "simulation/motion_language/parse/joints.h"
#include "tests/unit/simulation/motion_language/motion_fixture.h"

// Checks what each construct of version 2 becomes.
namespace koboshi::simulation {
namespace {

using testing::HasSubstr;

// The steps of an image as the decompiler writes them, which names every field; without the indentation.
std::vector<std::string> lowered(const std::string& rest) {
  const Compiled compiled = compile_text(version_2(rest));
  EXPECT_EQ(compiled.messages(), "");
  if (compiled.motion.image.empty()) return {};
  const std::string text = decompile_motion(compiled.motion.image, koboshi_model(), "image");
  std::vector<std::string> lines;
  std::istringstream stream(text);
  bool in_steps = false;
  for (std::string line; std::getline(stream, line);) {
    in_steps = in_steps || line.starts_with("routines:") || line.starts_with("steps:");
    const std::size_t dash = line.find("- ");
    if (in_steps && dash != std::string::npos) lines.push_back(line.substr(dash + 2));
  }
  return lines;
}

TEST(MotionLanguage, MovesByTimeOrSpeedWithInterpolationAndPause) {
  EXPECT_THAT(lowered("interpolation: minimum_jerk\n"
                      "steps:\n"
                      "  - {pose: bend, time_s: 1, pause_s: 0.25}\n"
                      "  - {pose: bend, time_s: 1, interpolation: cubic}\n"
                      "  - {pose: bend, speed_deg_per_s: 90, interpolation: linear}\n"),
              testing::ElementsAre("{pose: p0, time_s: 1.000000, interpolation: minimum_jerk}",
                                   "{wait_s: 0.250000}", "{pose: p0, time_s: 1.000000, interpolation: cubic}",
                                   "{pose: p0, speed_deg_per_s: 90}", "end"));
}

TEST(MotionLanguage, MirrorsAndInlinesPosesOnce) {
  const Compiled compiled = compile_text(version_2(
      "steps: [{pose: {left_elbow: -30}, time_s: 1}, {pose: {left_elbow: -30}, time_s: 1, mirror: true},\n"
      "  {pose: {right_elbow: -30}, time_s: 1}]\n"));
  EXPECT_EQ(compiled.messages(), "");
  EXPECT_EQ(compiled.source.poses.size(), 5u) << "the mirrored pose is also the last inline one";
  EXPECT_EQ(compiled.source.steps[1].pose, compiled.source.steps[2].pose);
}

TEST(MotionLanguage, BranchesOnConditions) {
  EXPECT_THAT(
      lowered("steps:\n"
              "  - if: roll_mdeg > 5000 and not left_contact\n"
              "    then: [{wait_s: 1}]\n"
              "    else: [{wait_s: 2}]\n"),
      testing::ElementsAre("{branch: {to: s5, not_all: [\"roll_mdeg > 5000\", \"left_contact == 0\"]}}",
                           "{wait_s: 1.000000}", "{jump: s6}", "{label: s5}", "{wait_s: 2.000000}",
                           "{label: s6}", "end"));
}

TEST(MotionLanguage, LowersMixedConditionsToSeveralBranches) {
  EXPECT_THAT(
      lowered("steps:\n  - {label: a}\n  - {wait_s: 1}\n"
              "  - {jump: a, if: \"roll_mdeg > 5 and (pitch_mdeg < 3 or 7 < supply_mV) or walking\"}\n"),
      testing::ElementsAre("{label: s0}", "{wait_s: 1.000000}",
                           "{branch: {to: s6, not_all: [\"roll_mdeg > 5\"]}}",
                           "{branch: {to: s0, any: [\"pitch_mdeg < 3\", \"supply_mV > 7\"]}}", "{label: s6}",
                           "{branch: {to: s0, any: [\"walking != 0\"]}}", "end"));
}

TEST(MotionLanguage, ComputesInSpareVariables) {
  EXPECT_THAT(lowered("variables: {x: 3, y: 0}\n"
                      "steps:\n"
                      "  - {set: {x: \"x * 2 + 1\", y: \"10 - y\"}}\n"
                      "  - {set: {y: \"-= roll_mdeg / 1000\"}}\n"
                      "  - {jump: out, if: \"x + 1 > roll_mdeg\"}\n"
                      "  - {wait_s: 1}\n  - {label: out}\n"),
              testing::ElementsAre("{set: {v0: \"3\"}}", "{set: {v0: \"*= 2\"}}", "{set: {v0: \"+= 1\"}}",
                                   "{set: {v2: \"10\"}}", "{set: {v2: \"-= v1\"}}", "{set: {v1: \"v2\"}}",
                                   "{set: {v2: \"roll_mdeg\"}}", "{set: {v2: \"/= 1000\"}}",
                                   "{set: {v1: \"-= v2\"}}", "{set: {v2: \"v0\"}}", "{set: {v2: \"+= 1\"}}",
                                   "{set: {v3: \"roll_mdeg\"}}", "{branch: {to: s15, all: [\"v2 > v3\"]}}",
                                   "{wait_s: 1.000000}", "{label: s15}", "end"));
}

TEST(MotionLanguage, WaitsWithATimeOut) {
  EXPECT_THAT(lowered("steps:\n"
                      "  - {wait: {until: left_contact and right_contact, timeout_s: 2}}\n"
                      "  - {wait: {until: \"input(2) == 1\", timeout_s: 3, else: continue}}\n"
                      "  - {wait: {until: -roll_mdeg > 100, timeout_s: 4, else: out}}\n"
                      "  - {wait_s: 1}\n"
                      "  - {label: out}\n"),
              testing::ElementsAre(
                  "{await: {all: [\"left_contact != 0\", \"right_contact != 0\"], timeout_s: 2.000000}}",
                  "{await: {to: s5, all: [\"input(2) == 1\"], timeout_s: 3.000000}}", "{label: s5}",
                  "{await: {to: s8, all: [\"roll_mdeg < -100\"], timeout_s: 4.000000}}", "{wait_s: 1.000000}",
                  "{label: s8}", "end"));
}

TEST(MotionLanguage, PollsConditionsThatNoSingleStepCanTest) {
  const std::vector<std::string> lines =
      lowered("steps: [{wait: {until: left_load_mN - right_load_mN > 500, timeout_s: 2}}]\n");
  EXPECT_THAT(lines,
              testing::ElementsAre("{set: {v0: \"time_ms\"}}", "{set: {v0: \"+= 2000\"}}", "{label: s2}",
                                   "{set: {v1: \"left_load_mN\"}}", "{set: {v1: \"-= right_load_mN\"}}",
                                   "{branch: {to: s11, all: [\"v1 > 500\"]}}",
                                   "{branch: {to: s10, all: [\"time_ms >= v0\"]}}", "{wait_s: 0.010000}",
                                   "{jump: s2}", "{label: s10}", "fail", "{label: s11}", "end"));
}

TEST(MotionLanguage, LeadsFromThePollingOfAConditionBackToIt) {
  EXPECT_THAT(lowered("steps: [{label: again}, {wait: {until: left_load_mN + right_load_mN > 9000, "
                      "timeout_s: 1, else: again}}]\n"),
              testing::Contains("{wait_s: 0.001000}"));
}

TEST(MotionLanguage, LoopsWhileAndUntilAConditionHolds) {
  EXPECT_THAT(lowered("steps:\n"
                      "  - loop: {while: supply_mV > 6500, steps: [{pose: bend, time_s: 1}]}\n"
                      "  - loop: {until: time_ms > 9000, steps: [{pose: bend, time_s: 1}]}\n"),
              testing::ElementsAre("{label: s0}", "{branch: {to: s4, not_all: [\"supply_mV > 6500\"]}}",
                                   "{pose: p0, time_s: 1.000000}", "{jump: s0}", "{label: s4}",
                                   "{pose: p0, time_s: 1.000000}",
                                   "{branch: {to: s4, not_all: [\"time_ms > 9000\"]}}", "end"));
}

TEST(MotionLanguage, OrdersRoutinesByTheirCallsAndLeavesOutUnusedOnes) {
  const Compiled compiled =
      compile_text(version_2("routines:\n"
                             "  inner: [{wait_s: 1}]\n"
                             "  unused: [{wait_s: 9}]\n"
                             "  outer: [{call: inner}, {call: inner}]\n"
                             "steps: [{call: outer}]\n"));
  EXPECT_EQ(compiled.codes(), "M050");
  ASSERT_FALSE(compiled.motion.image.empty()) << "a warning is no error";
  EXPECT_THAT(decompile_motion(compiled.motion.image, koboshi_model(), "image"),
              HasSubstr("routines:\n"
                        "  r2:\n    - {call: r5}\n    - {call: r5}\n    - return\n"
                        "  r5:\n    - {wait_s: 1.000000}\n    - return\n"
                        "steps:\n  - {call: r2}\n  - end\n"));
}

// A routine does not know what its caller has set: after a move with a setting of its own the drive has its
// full torque again.
TEST(MotionLanguage, BeginsRoutinesWithTheSettingsOfTheRobot) {
  const Compiled compiled =
      compile_text(version_2("routines:\n  soft: [{pose: bend, time_s: 1, stiffness: {left_knee: 20}}]\n"
                             "steps: [{stiffness: {left_knee: 50}}, {call: soft}]\n"));
  ASSERT_EQ(compiled.codes(), "");
  EXPECT_THAT(decompile_motion(compiled.motion.image, koboshi_model(), "image"),
              HasSubstr("    - {stiffness: {left_knee: 20}}\n    - {pose: p0, time_s: 1.000000}\n"
                        "    - {stiffness: {left_knee: 100}}\n"));
}

// Beside another motion or the walk, the lean of the second motion does not count.
TEST(MotionLanguage, WarnsOfALeanThatAMotionWithoutLegsDeclares) {
  const auto codes = [](const std::string& joint) {
    return compile_text("version: 2\nrobot: koboshi\nname: nod\nposes:\n  nod: {" + joint +
                        ": 10}\nsteps:\n  - {pose: nod, time_s: 1, lean: {pitch_deg: 5}}\n  - {lean: none}\n")
        .codes();
  };
  EXPECT_EQ(codes("head_tilt"), "M051");
  EXPECT_EQ(codes("left_knee"), "");
}

// A 12-bit encoder has steps of 0.0879 degrees; the knee goes from 0 to 150 degrees.
TEST(MotionLanguage, TakesTheLimitForAnAngleLessThanAnEncoderStepBeyondIt) {
  const auto compiled = [](const std::string& angles) {
    return compile_text(version_2("steps: [{pose: {" + angles + "}, time_s: 1}]\n"));
  };
  const std::size_t knee = *JointNames(koboshi_model()).find("left_knee");
  for (const auto& [angle, limit_deg] : {std::pair{"left_knee: -0.08", 0.0}, {"left_knee: 150.08", 150.0}}) {
    const Compiled accepted = compiled(angle);
    EXPECT_EQ(accepted.codes(), "M052") << angle;
    EXPECT_THAT(accepted.messages(), HasSubstr("less than a step of its encoder beyond the limit"));
    ASSERT_FALSE(accepted.motion.image.empty());
    EXPECT_NEAR(fixed::to_double(*accepted.source.poses.back().angles[knee]) * 180.0 / std::numbers::pi,
                limit_deg, 1e-4);
  }
  EXPECT_EQ(compiled("left_knee: -0.09").codes(), "M012");
  EXPECT_EQ(compiled("left_knee: 150.09").codes(), "M012");
}

TEST(MotionLanguage, TakesSettingsOfAStepBack) {
  EXPECT_THAT(
      lowered("steps:\n"
              "  - {stiffness: {head: 60}}\n"
              "  - {pose: bend, time_s: 1, pause_s: 1, stiffness: {head_pan: 30, left_knee: 30},\n"
              "     mix: {ankle_pitch: {pitch_rate: 0.5, limit_deg: 5}}, lean: {pitch_deg: 20}}\n"
              "  - {pose: bend, time_s: 1}\n"),
      testing::ElementsAre(
          "{stiffness: {head_pan: 60, head_tilt: 60}}", "{lean: {pitch_deg: 20.0006103515625, roll_deg: 0}}",
          "{stiffness: {left_knee: 30, head_pan: 30}}",
          "{mix: {left_ankle_pitch: {pitch_rate: 0.5, limit_deg: 4.998779296875}}}",
          "{mix: {right_ankle_pitch: {pitch_rate: 0.5, limit_deg: 4.998779296875}}}",
          "{pose: p0, time_s: 1.000000}", "{wait_s: 1.000000}", "{mix: {left_ankle_pitch: {pitch_rate: 0}}}",
          "{mix: {right_ankle_pitch: {pitch_rate: 0}}}", "{stiffness: {left_knee: 100}}",
          "{stiffness: {head_pan: 60}}", "{lean: {pitch_deg: 0, roll_deg: 0}}",
          "{pose: p0, time_s: 1.000000}", "end"));
}

TEST(MotionLanguage, WritesTheTimesOfJointsBehindTheirMove) {
  EXPECT_THAT(
      lowered("steps:\n"
              "  - {pose: {head_pan: 10, knee: 20}, time_s: 2, pause_s: 1,\n"
              "     during: {head: [0.5, 1], left_leg: [0, 1.5], right_knee: [0, 1.5]}}\n"),
      testing::ElementsAre("{pose: p3, time_s: 2.000000, during: {head_pan: [0.500000000, 1.000000000], "
                           "left_knee: [0.000000000, 1.500000000], right_knee: [0.000000000, "
                           "1.500000000]}}",
                           "{wait_s: 1.000000}", "end"));
}

// The head turns by 60 degrees in 0.2 s, which its servo can, and in a quarter of that, which it cannot.
TEST(MotionLanguage, JudgesTheSpeedOfAJointByItsOwnTime) {
  const auto codes = [](const char* during) {
    return compile_text(version_2(("steps:\n  - {pose: {head_pan: 0}, time_s: 1}\n  - {pose: {head_pan: 60}, "
                                   "time_s: 0.2" +
                                   std::string(during) + "}\n")
                                      .c_str()))
        .codes();
  };
  EXPECT_EQ(codes(""), "");
  EXPECT_EQ(codes(", during: {head_pan: [0, 0.05]}"), "M040");
}

TEST(MotionLanguage, TakesGainsOfAMoveBack) {
  EXPECT_THAT(lowered("steps:\n"
                      "  - {gain: {head: 60}}\n"
                      "  - {pose: bend, time_s: 1, gain: {head_pan: 150, left_knee: 30}}\n"),
              testing::ElementsAre("{gain: {head_pan: 60, head_tilt: 60}}", "{gain: {head_pan: 150}}",
                                   "{gain: {left_knee: 30}}", "{pose: p0, time_s: 1.000000}",
                                   "{gain: {left_knee: 100}}", "{gain: {head_pan: 60}}", "end"));
}

TEST(MotionLanguage, MirrorsMixesOfBothSides) {
  EXPECT_THAT(lowered("steps: [{mix: {ankle_roll: {roll_rate: 0.25, limit_deg: 5}}}, {mix: none}]\n"),
              testing::ElementsAre("{mix: {left_ankle_roll: {roll_rate: 0.25, limit_deg: 4.998779296875}}}",
                                   "{mix: {right_ankle_roll: {roll_rate: 0.25, limit_deg: 4.998779296875}}}",
                                   "{mix: none}", "end"))
      << "both ankles turn the robot the same way";
}

TEST(MotionLanguage, SaturatesTheMirrorImageOfTheLeastGain) {
  EXPECT_THAT(
      lowered("steps: [{mix: {ankle_roll: {pitch_rate: -8, limit_deg: 5}}}]\n"),
      testing::ElementsAre(
          "{mix: {left_ankle_roll: {pitch_rate: -8, limit_deg: 4.998779296875}}}",
          "{mix: {right_ankle_roll: {pitch_rate: 7.999755859375, limit_deg: 4.998779296875}}}", "end"));
}

TEST(MotionLanguage, MarksItsExitPath) {
  const Compiled compiled = compile_text(version_2(
      "exit: out\nsteps: [{loop: {until: stopped, steps: [{wait_s: 1}]}}, {label: out}, {wait_s: 2}]\n"));
  EXPECT_EQ(compiled.messages(), "");
  motion::Motion opened;
  ASSERT_TRUE(motion::Motion::open(compiled.motion.image, koboshi_model().model, opened).ok());
  EXPECT_EQ(opened.exit_step(), 3);
}

TEST(MotionLanguage, DerivesPosesInAnyOrder) {
  const Compiled compiled = compile_text(
      "version: 2\nrobot: koboshi\nname: test\njoints: [arms, head]\n"
      "poses:\n"
      "  wave: {from: rest, left_elbow: -90}\n"
      "  other: {mirror: wave, head_pan: 10}\n"
      "  rest: {others: zero, shoulder_roll: 8}\n"
      "steps: [{pose: wave, time_s: 1}]\n");
  ASSERT_EQ(compiled.messages(), "");
  const JointNames joints(koboshi_model());
  const auto angle = [&](std::size_t pose, const char* joint) {
    return static_cast<double>(compiled.source.poses[pose].angles[*joints.find(joint)].value().raw()) *
           360.0 / 4'294'967'296.0;
  };
  EXPECT_NEAR(angle(0, "left_elbow"), -90, 1e-6);
  EXPECT_NEAR(angle(0, "left_shoulder_roll"), 8, 1e-6);
  EXPECT_NEAR(angle(1, "right_elbow"), -90, 1e-6);
  EXPECT_NEAR(angle(1, "left_elbow"), 0, 1e-6);
  EXPECT_NEAR(angle(1, "head_pan"), 10, 1e-6);
  EXPECT_FALSE(compiled.source.poses[0].angles[*joints.find("left_knee")]) << "others are those of the list";
}

// --- Errors: each code once, with its place

struct BadMotion {
  const char* code;
  const char* rest;   // after version_2's head, which has 4 lines
  const char* place;  // of the first message, LINE:COLUMN
  const char* text;   // in the message
};

class MotionErrors : public testing::TestWithParam<BadMotion> {};

TEST_P(MotionErrors, HaveCodePlaceAndHint) {
  const Compiled compiled = compile_text(version_2(GetParam().rest));
  ASSERT_FALSE(compiled.diagnostics.empty());
  EXPECT_EQ(compiled.diagnostics.front().code, GetParam().code) << compiled.messages();
  EXPECT_THAT(compiled.messages(),
              testing::StartsWith("motion.yaml:" + std::string(GetParam().place) + ": error["));
  EXPECT_THAT(compiled.messages(), HasSubstr(GetParam().text));
  EXPECT_TRUE(compiled.motion.image.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Language, MotionErrors,
    testing::Values(
        BadMotion{"M001", "steps: [{wait_s: 1}\n", "6", "well-formed YAML"},
        BadMotion{"M002", "", "1:1", "no key steps"},
        BadMotion{"M003", "steps: [{wait_s: 1}]\nexitt: out\n", "6:1", "did you mean `exit`?"},
        BadMotion{"M004", "steps:\n  - {pose: bend, time_s: 0}\n", "6:26", "a number from 0.001 to 60"},
        BadMotion{"M006", "variables: {roll_mdeg: 1}\nsteps: [end]\n", "5:13", "no name of a sensor"},
        BadMotion{"M010", "steps: [{pose: {left_kne: 5}, time_s: 1}]\n", "5:17", "did you mean `left_knee`?"},
        BadMotion{"M010", "steps: [{stiffness: {left_arms: 5}}]\n", "5:22", "did you mean `left_arm`?"},
        BadMotion{"M026", "steps: [{pose: {head_pan: 5}, time_s: 1, path: zmp, lean: {pitch_deg: 5}}]\n",
                  "5:53", "lean in a move of path: zmp"},
        BadMotion{"M026", "steps: [{pose: {head_pan: 5}, at_least_s: 1, path: zmp}]\n", "5:31",
                  "at_least_s in a move of path: zmp"},
        BadMotion{"M018", "steps: [{pose: {head_pan: 5}, time_s: 1, path: zmp}]\n", "5:9",
                  "a move of all joints of the legs before it"},
        BadMotion{"M026", "steps: [{pose: {head_pan: 5}, at_least_s: 1, during: {head_pan: [0, 1]}}]\n",
                  "5:46", "without time_s"},
        BadMotion{
            "M026",
            "steps: [{pose: {head_pan: 5}, time_s: 1, interpolation: cubic, during: {head_pan: [0, 1]}}]\n",
            "5:64", "that is cubic"},
        BadMotion{"M026", "steps: [{pose: {head_pan: 5}, time_s: 1, during: {head_tilt: [0, 1]}}]\n", "5:9",
                  "joints that the pose does not move"},
        BadMotion{"M004", "steps: [{pose: {head_pan: 5}, time_s: 1, during: {head_pan: [0, 1.1]}}]\n", "5:65",
                  "a number from 0 to 1"},
        BadMotion{"M004", "steps: [{pose: {head_pan: 5}, time_s: 1, during: {head_pan: [0.5, 0.5]}}]\n",
                  "5:61", "an end that is later"},
        BadMotion{"M004", "steps: [{pose: {head_pan: 5}, time_s: 1, during: {head_pan: [0.5]}}]\n", "5:61",
                  "a list of two times"},
        BadMotion{"M004", "steps: [{gain: {left_arm: 0}}]\n", "5:27", "an integer from 1 to 200"},
        BadMotion{"M004", "steps: [{gain: {left_arm: 201}}]\n", "5:27", "an integer from 1 to 200"},
        BadMotion{"M004", "steps: [{gain: {}}]\n", "5:16", "joints with their gain"},
        BadMotion{"M026", "steps: [{gain: {left_arm: 5, arms: 6}}]\n", "5:30", "a second gain for a joint"},
        BadMotion{"M011", "steps: [{pose: {knee: 5, left_knee: 6}, time_s: 1}]\n", "5:26", "a second angle"},
        BadMotion{"M012", "steps: [{pose: {knee: -5}, time_s: 1}]\n", "5:23", "expected 0 to 150"},
        BadMotion{"M013", "steps: [{pose: bent, time_s: 1}]\n", "5:16", "did you mean `bend`?"},
        BadMotion{"M015", "joints: [arms]\nsteps: [end]\n", "4:16", "the list `joints`"},
        BadMotion{"M016", "steps: [{pose: {trunk: {z_mm: 400}}, time_s: 1}]\n", "5:17", "out of reach by"},
        BadMotion{"M017", "steps: [{pose: {}, time_s: 1}]\n", "5:16", "a pose without a joint"},
        BadMotion{"M018", "steps: [{pose: {support: left, left_foot: {z_mm: 5}}, time_s: 1}]\n", "5:32",
                  "a target for the support foot"},
        BadMotion{"M020", "steps: [{poze: bend, time_s: 1}]\n", "5:9", "did you mean `pose`?"},
        BadMotion{"M021", "steps: [{label: out}, {wait_s: 1}, {jump: ouut}]\n", "5:36",
                  "did you mean `out`?"},
        BadMotion{"M022", "steps: [{label: a}, {label: a}]\n", "5:21", "a second label 'a'"},
        BadMotion{"M023", "routines: {nod: [{wait_s: 1}]}\nsteps: [{call: nodd}]\n", "6:16",
                  "did you mean `nod`?"},
        BadMotion{"M024", "routines: {a: [{call: b}], b: [{call: a}]}\nsteps: [{call: a}]\n", "5:12",
                  "on a cycle of calls"},
        BadMotion{"M025", "exit: out\nsteps: [{label: ou}, {wait_s: 1}]\n", "5:7", "did you mean `ou`?"},
        BadMotion{"M026", "steps: [{pose: bend, time_s: 1, speed_deg_per_s: 5}]\n", "5:33", "one of them"},
        BadMotion{"M030", "steps: [{wait: {until: roll_mdeg >, timeout_s: 1}}]\n", "5:35", "the end of"},
        BadMotion{"M030", "steps: [{wait: {until: 0 < roll_mdeg < 5, timeout_s: 1}}]\n", "5:38", "by `and`"},
        BadMotion{"M031", "variables: {speed: 0}\nsteps: [{set: {speed: \"1 + sped\"}}]\n", "6:28",
                  "did you mean `speed`?"},
        BadMotion{"M032", "variables: {x: 0}\nsteps: [{set: {x: \"1 < 2\"}}]\n", "6:19", "found a condition"},
        BadMotion{"M033", "variables: {x: 0}\nsteps: [{set: {x: \"1 + 2147483648\"}}]\n", "6:24", "32 bits"},
        BadMotion{"M034", "variables: {x: 0}\nsteps: [{set: {x: \"x / 0\"}}]\n", "6:22",
                  "a division by zero"},
        BadMotion{"M034", "variables: {x: 0}\nsteps: [{set: {x: \"/= 0\"}}]\n", "6:19", "a division by zero"},
        BadMotion{"M034", "variables: {x: 0}\nsteps: [{set: {x: \"%= 0\"}}]\n", "6:19", "a division by zero"},
        BadMotion{"M010", "steps: [{mix: {arms: {pitch_rate: 0.1, limit_deg: 3}}}]\n", "5:16",
                  "found the group 'arms', expected joints, each with its gains"},
        BadMotion{"M035", "variables: {x: 0}\nsteps: [{set: {xx: 1}}]\n", "6:16", "did you mean `x`?"},
        BadMotion{"M036",
                  "variables: {a: 0, b: 0, c: 0, d: 0, e: 0, f: 0, g: 0, h: 0, i: 0, j: 0, k: 0, l: 0, m: 0, "
                  "n: 0,\n"
                  "  o: 0, p: 0, q: 0}\nsteps: [end]\n",
                  "6:15", "more than 16 variables"},
        BadMotion{"M040", "steps: [{pose: straight, time_s: 1}, {pose: bend, time_s: 0.01}]\n", "5:38",
                  "degrees/s"},
        BadMotion{"M042", "steps: [{label: a}, {jump: a}]\n", "5:21", "in which no time passes"},
        BadMotion{
            "M042",
            "variables: {x: 0}\nsteps:\n  - {set: {x: 1}}\n  - loop: {times: 3, steps: [{set: {x: 2}}]}\n",
            "8:5", "in which no time passes"}));

TEST(MotionDiagnostics, OfAnImageIsOneLine) {
  const std::vector<std::byte> image =
      compile_text("version: 2\nrobot: koboshi\nname: a\nsteps: [{wait_s: 1}]\n").motion.image;
  try {
    static_cast<void>(
        read_motion_text("a.kmot", std::string(reinterpret_cast<const char*>(image.data()), image.size())));
    FAIL();
  } catch (const MotionError& error) {
    EXPECT_STREQ(error.what(),
                 "a.kmot: found the image of a motion, expected a motion file (YAML), which koboshi "
                 "motion decompile makes of it");
  }
  // Text is text, whatever its first word.
  EXPECT_FALSE(is_motion_image("KMOT: 1"));
}

TEST(MotionDiagnostics, OfVersions) {
  EXPECT_EQ(compile_text("version: 3\nrobot: koboshi\nname: a\nsteps: [end]\n").codes(), "M007");
  EXPECT_EQ(compile_text("version: 2\nrobot: nao\nname: a\nsteps: [end]\n").codes(), "M005");
  const Compiled old = compile_text(
      "version: 1\nrobot: koboshi\nname: a\nposes: {p: {knee: 5}}\n"
      "steps: [{pose: p, time_s: 1, pause_s: 1}, {call: x}]\n");
  EXPECT_EQ(old.codes(), "M008 M008");
  EXPECT_THAT(old.messages(), HasSubstr("motion format --upgrade"));
}

// Every code of codes.h is in the reference, and no other one of the compiler.
TEST(MotionDiagnostics, HaveTheirCodesInTheReference) {
  const auto codes_of = [](const char* file, const std::string& before) {
    const std::string text = read_text_file(std::string(KOBOSHI_SOURCE_DIR) + file, "a text");
    std::set<std::string> codes;
    for (std::size_t at = text.find(before + "M0"); at != std::string::npos;
         at = text.find(before + "M0", at + 1))
      codes.insert(text.substr(at + before.size(), 4));
    return codes;
  };
  const std::set<std::string> codes = codes_of("/simulation/motion_language/parse/codes.h", "\"");
  EXPECT_GT(codes.size(), 30u);
  EXPECT_EQ(codes, codes_of("/docs/reference/motion-language.md", "| "));
}

TEST(MotionDiagnostics, ReportCyclesOfPoses) {
  const Compiled compiled = compile_text(
      "version: 2\nrobot: koboshi\nname: a\n"
      "poses: {a: {from: b}, b: {mirror: c}, c: {from: a}}\nsteps: [end]\n");
  EXPECT_EQ(compiled.codes().substr(0, 4), "M014");
}

TEST(MotionDiagnostics, ReportSeveralErrorsOfOneRun) {
  const Compiled compiled =
      compile_text(version_2("exit: nowhere\nsteps:\n"
                             "  - {pose: bent, time_s: 1}\n"
                             "  - {pose: bend, time_s: 99}\n"
                             "  - {wait: {until: x > 1, timeout_s: 1}}\n"
                             "  - {loop: {times: 2, steps: [{wait_s: 0}, {lable: a}]}}\n"));
  EXPECT_EQ(compiled.codes(), "M013 M004 M031 M004 M020");
  std::string many = "steps:\n";
  for (int i = 0; i < 50; ++i) many += "  - {wait_s: 0}\n";
  EXPECT_EQ(compile_text(version_2(many)).diagnostics.size(), 20u);
}

TEST(MotionDiagnostics, OfTooManyThings) {
  std::string steps = "steps:\n";
  for (int i = 0; i < 1'100; ++i) steps += "  - {wait_s: 1}\n";
  EXPECT_EQ(compile_text(version_2(steps)).codes(), "M041");
  std::string groups = "steps:\n";
  for (int i = 1; i < 60; ++i) {
    groups += "  - {pose: {";
    for (int bit = 0; bit < 6; ++bit) {
      if ((i >> bit & 1) != 0) groups += koboshi_model().joint_names[static_cast<std::size_t>(bit)] + ": 0, ";
    }
    groups += "}, time_s: 1}\n";
  }
  EXPECT_EQ(compile_text(version_2(groups)).codes(), "M041");
  std::string deep = "{wait_s: 1}";
  for (int i = 0; i < 30; ++i) deep = "{if: walking, then: [" + deep + "]}";
  EXPECT_EQ(compile_text(version_2("steps: [" + deep + "]\n")).codes(), "M041");
}

// Operands, operators and brackets up to the number that the reader of expressions takes.
TEST(MotionLanguage, BoundsTheLengthOfAnExpression) {
  const auto codes = [](const std::string& expression) {
    return compile_text(version_2("variables: {x: 0}\nsteps: [{set: {x: \"" + expression + "\"}}]\n"))
        .codes();
  };
  const auto repeated = [](const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
  };
  const auto operands = [&](int count) { return "max(0" + repeated(", 1", count - 1) + ")"; };
  EXPECT_EQ(codes(operands(41)), "");
  EXPECT_EQ(codes(operands(42)), "M030");
  EXPECT_EQ(codes("0" + repeated(" + 1", 40)), "");
  EXPECT_EQ(codes("0" + repeated(" + 1", 41)), "M030");
  EXPECT_EQ(codes("0" + repeated(" * 1", 40)), "");
  EXPECT_EQ(codes("0" + repeated(" * 1", 41)), "M030");
  EXPECT_EQ(codes(repeated("(", 40) + "1" + repeated(")", 40)), "");
  EXPECT_EQ(codes(repeated("(", 41) + "1" + repeated(")", 41)), "M030");
}

}  // namespace
}  // namespace koboshi::simulation
