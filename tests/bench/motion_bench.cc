#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tools/motion_check/check.h"

// The compiler and the check with the default robot. An editor checks after each edit, and wants an answer
// within 50 ms.
namespace koboshi::tools {
namespace {

constexpr const char* kRobot = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";
constexpr int kSteps = 500;
constexpr int kShortSteps = 50;

// A motion in which all limbs move all the time, with a loop, conditions, mixes and a declared lean.
// `knee_deg` is the knee of the pose in the middle.
std::string motion_text(int steps, double knee_deg) {
  std::string text =
      "version: 2\nrobot: koboshi\nname: bench\nvariables: {count: 0}\ninterpolation: minimum_jerk\nposes:\n"
      "  stand: {others: zero, hip_pitch: -15.9, knee: 43.72, ankle_pitch: -27.82, shoulder_roll: 8, elbow: "
      "-20}\n";
  for (int i = 0; i < steps; ++i)
    text +=
        fmt::format("  p{}: {{from: stand, knee: {:.2f}, elbow: {}, shoulder_pitch: {}, head_pan: {}.{}}}\n",
                    i, i == steps / 2 ? knee_deg : 40.0 + i % 7, -20 - i % 11, i % 13, i % 17, i);
  text += "steps:\n  - {mix: {left_ankle_pitch: {pitch_rate: 0.05, limit_deg: 3}}}\n";
  for (int i = 0; i < steps; ++i) {
    text += fmt::format("  - {{pose: p{}, time_s: 0.5}}\n", i);
    if (i % 100 == 50)
      text += "  - {set: {count: \"+= 1\"}}\n  - {if: input(1) > 3, then: [{wait_s: 0.2}]}\n";
  }
  return text;
}

class Bench {
 public:
  explicit Bench(int steps) : steps_(steps) {}

  CompiledMotion compiled(double knee_deg) {
    const std::filesystem::path file = folder_.path / "bench.yaml";
    std::ofstream(file) << motion_text(steps_, knee_deg);
    return checker().compile(file);
  }
  MotionChecker& checker() {
    if (!checker_) checker_.emplace(kRobot);
    return *checker_;
  }
  void forget() { checker_.reset(); }

 private:
  int steps_;
  const test::TemporaryFolder folder_;
  std::optional<MotionChecker> checker_;
};

void BM_Compile50Steps(benchmark::State& state) {
  Bench bench(kShortSteps);
  for (auto _ : state) benchmark::DoNotOptimize(bench.compiled(42.0).image.size());
}
BENCHMARK(BM_Compile50Steps)->Unit(benchmark::kMillisecond);

void BM_Check500Steps(benchmark::State& state) {
  Bench bench(kSteps);
  const CompiledMotion motion = bench.compiled(42.0);
  for (auto _ : state) {
    state.PauseTiming();
    bench.forget();
    MotionChecker& checker = bench.checker();
    state.ResumeTiming();
    benchmark::DoNotOptimize(checker.check(motion).diagnostics.size());
  }
  state.counters["ticks"] = static_cast<double>(bench.checker().trajectory().ticks());
}
BENCHMARK(BM_Check500Steps)->Unit(benchmark::kMillisecond);

// Compiled motions, so that it is the check alone; the studio's document compiles without a file.
void BM_CheckOneEditedStepOf500(benchmark::State& state) {
  Bench bench(kSteps);
  std::vector<CompiledMotion> motions;
  for (int i = 0; i < 8; ++i) motions.push_back(bench.compiled(40.0 + 0.2 * i));
  bench.checker().check(motions.back());
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(bench.checker().check(motions[next]).diagnostics.size());
    next = (next + 1) % motions.size();
  }
  state.counters["computed"] = static_cast<double>(bench.checker().analysis().computed());
}
BENCHMARK(BM_CheckOneEditedStepOf500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace koboshi::tools
