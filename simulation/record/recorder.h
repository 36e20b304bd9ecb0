#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/file/output_file.h"
#include "hal/port/can.h"
#include "sim_board/can/observer.h"
#include "simulation/record/background_writer.h"
#include "simulation/record/trace.h"

namespace koboshi::simulation {

// Records a run in its folder: `trace.csv`, one row per call of `row`, and `can.log`, every valid frame on
// the bus with the time of its last bit, as `candump -L` would. Records are copied into a ring, and a
// separate thread formats and writes them. A simulation step therefore neither allocates nor formats nor
// waits for the disk.
class Recorder final : public sim_board::BusObserver {
 public:
  // Opens both files in an existing folder; throws WriteError.
  Recorder(const std::filesystem::path& folder, std::vector<TraceColumn> columns, WhenFull when_full,
           std::size_t ring_words = BackgroundWriter::kDefaultRingWords);
  // Writes the remaining records and ignores errors: call `close` first to detect them.
  ~Recorder() = default;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Records one value per column, of the column's type. Throws WriteError after a failed write.
  void row(std::uint64_t time_us, std::span<const TraceValue> values);
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;

  // Writes all records and ends the thread; nothing may be recorded afterwards. Throws WriteError for the
  // first failed write.
  void close();
  // Number of rows and frames lost because the ring was full.
  std::uint64_t dropped() const { return writer_.dropped(); }

 private:
  void write(const Ring::Record& record);

  TraceFormatter formatter_;
  OutputFile trace_;
  OutputFile log_;
  BackgroundWriter writer_;  // last member: its thread uses the others
};

}  // namespace koboshi::simulation
