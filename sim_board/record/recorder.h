#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <span>
#include <thread>
#include <vector>

#include "hal/port/can.h"
#include "sim_board/can/observer.h"
#include "sim_board/record/output_file.h"
#include "sim_board/record/ring.h"
#include "sim_board/record/trace.h"

namespace koboshi::sim {

// Records a run into its folder: `trace.csv`, one row for each call of `row`, and `can.log`, every sound
// frame on the bus at the time of its last bit, as `candump -L` would. What is recorded is copied into a
// ring; a thread of the recorder's own formats and writes it, so that a simulation step neither allocates nor
// formats nor waits for the disk.
class Recorder final : public BusObserver {
 public:
  static constexpr std::size_t kDefaultRingWords = std::size_t{1}
                                                   << 16;  // half a mebibyte, more than a second of a walk

  // Opens both files in an existing folder; throws WriteError.
  Recorder(const std::filesystem::path& folder, std::vector<TraceColumn> columns, WhenFull when_full,
           std::size_t ring_words = kDefaultRingWords);
  // Writes what has been recorded. Errors can no longer be told: call `close` first.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // One value for each column, of its kind. Throws WriteError once something could not be written.
  void row(std::uint64_t time_us, std::span<const TraceValue> values);
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;

  // Writes everything and ends the thread; nothing may be recorded afterwards. Throws WriteError for the
  // first thing that could not be written, then or before.
  void close();
  // Rows and frames that were lost because the ring was full.
  std::uint64_t dropped() const { return ring_.dropped(); }

 private:
  void write_records();
  void write(const Ring::Record& record);
  void finish();

  TraceFormatter formatter_;
  OutputFile trace_;
  OutputFile log_;
  Ring ring_;
  std::exception_ptr error_;  // of the thread; read after it has ended or once failed_ is set
  std::atomic<bool> failed_ = false;
  std::thread writer_;
};

}  // namespace koboshi::sim
