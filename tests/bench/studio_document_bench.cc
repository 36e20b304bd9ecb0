#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <array>
#include <string>

#include "tools/studio/document/motion_document.h"

// Edits of a motion of 1,000 steps with 500 poses, each with the rows after it. A motion editor needs 25 a
// second.
namespace koboshi::studio {
namespace {

constexpr std::size_t kPoses = 500;
constexpr std::size_t kSteps = 1000;

std::shared_ptr<const MotionRobot> robot() {
  static const auto loaded = load_motion_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return loaded;
}

std::unique_ptr<MotionDocument> large_motion() {
  std::string text = "version: 2\nrobot: koboshi\nname: large\nposes:\n";
  for (std::size_t i = 0; i < kPoses; ++i) {
    text += fmt::format(
        "  p{}: {{hip_roll: 4, hip_pitch: -15.90, knee: {}.5, ankle_pitch: -27.82, shoulder_roll: 8, elbow: "
        "-20}}\n",
        i, 20 + i % 30);
  }
  text += "steps:\n";
  for (std::size_t i = 0; i < kSteps; ++i)
    text += fmt::format("  - {{pose: p{}, time_s: 0.5}}\n", i % kPoses);
  return MotionDocument::restore(robot(), {.recovery_file = {}, .original = {}, .text = text});
}

void BM_DragJoint(benchmark::State& state) {
  const auto document = large_motion();
  double angle_rad = 0.1;
  for (auto _ : state) {
    angle_rad = angle_rad > 0.5 ? 0.1 : angle_rad + 0.01;
    const std::array<JointAngle, 1> angles{{{0, angle_rad}}};
    document->set_angles(kSteps / 2, angles, PoseScope::kAllSteps, "drag");
    benchmark::DoNotOptimize(document->rows().rows.size());
  }
  if (document->compiled() == nullptr) state.SkipWithError("the motion does not compile");
}
BENCHMARK(BM_DragJoint)->Unit(benchmark::kMillisecond);

void BM_DragTime(benchmark::State& state) {
  const auto document = large_motion();
  const std::array<std::size_t, 1> rows{kSteps / 2};
  double time_s = 0.3;
  for (auto _ : state) {
    time_s = time_s > 2.0 ? 0.3 : time_s + 0.01;
    document->set_time(rows, time_s, "drag");
    benchmark::DoNotOptimize(document->rows().rows.size());
  }
}
BENCHMARK(BM_DragTime)->Unit(benchmark::kMillisecond);

void BM_InsertAndUndo(benchmark::State& state) {
  const auto document = large_motion();
  for (auto _ : state) {
    document->insert_step({StepPlace::Kind::kAfter, kSteps / 2}, "{wait_s: 1}");
    document->undo();
  }
}
BENCHMARK(BM_InsertAndUndo)->Unit(benchmark::kMillisecond);

void BM_ScaleAllTimes(benchmark::State& state) {
  const auto document = large_motion();
  std::vector<std::size_t> rows(kSteps);
  for (std::size_t i = 0; i < kSteps; ++i) rows[i] = i;
  double factor = 2.0;
  for (auto _ : state) {
    document->scale_time(rows, factor);
    factor = 1.0 / factor;
  }
}
BENCHMARK(BM_ScaleAllTimes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace koboshi::studio
