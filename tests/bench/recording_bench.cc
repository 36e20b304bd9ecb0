// Times of opening long recordings as the studio does, by hand:
//
//   recording_bench repeat RUN COPIES FILE    writes the run COPIES times in a row, with shifted times
//   recording_bench open RUN                  index, poses at random moments, values of the whole run, memory

#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "studio/plot/series.h"
#include "studio/run/overview_reader.h"
#include "studio/run/recording_window.h"
#include "view/recording/read_recording.h"
#include "view/recording/recording_file.h"

namespace {

using koboshi::view::Recording;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double peak_MiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void repeat(const std::filesystem::path& run, int copies, const std::filesystem::path& file) {
  const Recording minute = koboshi::view::read_recording(run);
  Recording head = minute;
  head.samples.clear();
  koboshi::view::RecordingFile out(file, head);
  const std::uint64_t length_us = minute.samples.back().time_us;
  for (int copy = 0; copy < copies; ++copy) {
    const std::uint64_t shift_us = length_us * static_cast<std::uint64_t>(copy);
    auto event = minute.events.begin();
    auto push = minute.pushes.begin();
    auto frame = minute.frames.begin();
    for (const koboshi::view::Sample& sample : minute.samples) {
      for (; frame != minute.frames.end() && frame->end_us <= sample.time_us; ++frame)
        out.add_frame({frame->end_us + shift_us, frame->frame});
      for (; push != minute.pushes.end() && push->start_us <= sample.time_us; ++push) {
        koboshi::view::Push shifted = *push;
        shifted.start_us += shift_us;
        shifted.end_us += shift_us;
        out.add_push(shifted);
      }
      for (; event != minute.events.end() && event->time_us <= sample.time_us; ++event)
        out.add_event({event->time_us + shift_us, event->kind, event->text});
      out.add_sample(sample.time_us + shift_us, sample.links, sample.contacts, sample.values);
    }
  }
  out.close();
}

void open(const std::filesystem::path& run) {
  const auto start = Clock::now();
  const double before_s = processor_s();
  koboshi::studio::RecordingWindow window(run);
  koboshi::studio::OverviewReader overview(run);
  window.show(0);
  fmt::print("first picture's poses   {:8.3f} s, {} of {} chunks read, {:.1f} MB\n", seconds_since(start),
             window.index().mcap().chunks_read(), window.index().mcap().chunks().size(),
             1e-6 * static_cast<double>(window.index().mcap().bytes_read()));
  // As the studio's plots take them.
  koboshi::studio::SampleTimes times;
  std::vector<koboshi::studio::Series> series(window.head().signals.size());
  while (!overview.finished()) {
    for (const Recording& block : overview.take(64)) {
      for (const koboshi::view::Sample& sample : block.samples) {
        times.append(sample.time_us);
        for (std::size_t i = 0; i < series.size(); ++i) series[i].append(sample.values[i]);
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  fmt::print("values of the whole run {:8.3f} s, {:.2f} s of the processor: {} samples of {} signals{}\n",
             seconds_since(start), processor_s() - before_s, times.size(), series.size(), overview.error());
  const auto jumps = Clock::now();
  constexpr int kJumps = 100;
  for (int i = 0; i < kJumps; ++i)
    window.show(window.end_us() / kJumps * static_cast<std::uint64_t>(37 * i % kJumps));
  fmt::print("a jump                  {:8.1f} ms\n", 1e3 * seconds_since(jumps) / kJumps);
  fmt::print("memory                  {:8.0f} MiB at most\n", peak_MiB());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "repeat" && argc == 5) {
    repeat(argv[2], std::atoi(argv[3]), argv[4]);
  } else if (what == "open" && argc == 3) {
    open(argv[2]);
  } else {
    fmt::print(stderr, "usage: recording_bench repeat RUN COPIES FILE | open RUN\n");
    return 2;
  }
  return 0;
}
