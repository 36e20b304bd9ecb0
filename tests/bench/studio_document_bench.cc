#include <benchmark/benchmark.h>

#include <array>
#include <string>

#include "studio/document/motion_document.h"
#include "tests/support/large_motion.h"

// Edits of a motion of 1,000 steps with 500 poses, each with the rows after it. A motion editor needs 25 a
// second.
namespace koboshi::studio {
namespace {

constexpr int kSteps = 1000;

std::shared_ptr<const MotionRobot> robot() {
  static const auto loaded = load_motion_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return loaded;
}

std::unique_ptr<MotionDocument> large_motion() {
  return MotionDocument::restore(
      robot(), {.recovery_file = {}, .original = {}, .text = test::large_motion(kSteps, test::bent_legs)});
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
