#include <benchmark/benchmark.h>

#include <QApplication>
#include <cmath>
#include <vector>

#include "studio/plot/plot_panel.h"

// Plots of the studio, with QT_QPA_PLATFORM=offscreen. A window needs 25 pictures a second for everything it
// shows.
namespace koboshi::studio {
namespace {

constexpr std::uint64_t kTick_us = 10'000;
constexpr std::size_t kHour = 360'000;  // samples

// Six signals with a step period of 0.6 s and noise.
struct Plot {
  std::shared_ptr<SampleTimes> times = std::make_shared<SampleTimes>();
  TimeView view{};
  PlotWidget widget{view, nullptr};

  Plot() {
    std::vector<Trace> traces;
    for (std::size_t i = 0; i < kHour; ++i) times->append((i + 1) * kTick_us);
    for (int k = 0; k < 6; ++k) {
      const auto values = std::make_shared<Series>();
      std::uint32_t noise = 1;
      for (std::size_t i = 0; i < kHour; ++i) {
        noise = noise * 1'664'525U + 1'013'904'223U;
        const double wave =
            std::sin(0.105 * static_cast<double>(i) + k) + 1e-4 * static_cast<double>(i % 10'000);
        values->append(static_cast<float>(wave + 0.1 * static_cast<double>(noise >> 8) / (1 << 24)));
      }
      traces.push_back({.signal = {.name = "signal_" + std::to_string(k), .unit = "N"},
                        .times = times,
                        .values = values,
                        .colour = k,
                        .dashed = k == 5});
    }
    widget.resize(1280, 400);
    widget.set_traces(std::move(traces));
    view.set_extent(static_cast<double>(kTick_us), static_cast<double>(kHour * kTick_us));
  }
};

// A repaint of everything after the range has moved; the argument is the range in seconds.
void BM_Scroll(benchmark::State& state) {
  Plot plot;
  const double range_us = 1e6 * static_cast<double>(state.range(0));
  QImage picture(plot.widget.size(), QImage::Format_RGB32);
  double from_us = 0.0;
  for (auto _ : state) {
    from_us += 0.003 * range_us;
    if (from_us + range_us > plot.view.end_us()) from_us = 0.0;
    plot.view.set_range(from_us, from_us + range_us);
    plot.widget.refresh();
    plot.widget.render(&picture);
  }
}
BENCHMARK(BM_Scroll)->Arg(3600)->Arg(60)->Arg(10)->Arg(4)->Arg(1)->Unit(benchmark::kMillisecond);

// Only the cursor moves.
void BM_MoveCursor(benchmark::State& state) {
  Plot plot;
  QImage picture(plot.widget.size(), QImage::Format_RGB32);
  std::uint64_t time_us = 0;
  for (auto _ : state) {
    time_us += kTick_us;
    plot.view.set_cursor(time_us);
    plot.widget.render(&picture);
  }
}
BENCHMARK(BM_MoveCursor)->Unit(benchmark::kMillisecond);

// A sample of 250 signals.
void BM_Append(benchmark::State& state) {
  PlotPanel panel;
  std::vector<view::Signal> signals(250);
  for (std::size_t i = 0; i < signals.size(); ++i) signals[i].name = "signal_" + std::to_string(i);
  panel.set_signals(signals);
  const std::vector<float> values(signals.size(), 1.5F);
  std::uint64_t time_us = 0;
  for (auto _ : state) panel.append(time_us += kTick_us, values);
}
BENCHMARK(BM_Append)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace koboshi::studio

int main(int argc, char** argv) {
  QApplication app(argc, argv);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
