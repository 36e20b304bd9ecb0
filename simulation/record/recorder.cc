#include "simulation/record/recorder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <utility>

#include "sim_board/can/candump_log.h"

namespace koboshi::simulation {
namespace {

enum RecordKind : std::uint32_t { kRow, kFrame };

constexpr std::size_t kFrameWords = 3;

void pack(std::span<std::uint64_t> words, const hal::CanFrame& frame, std::uint64_t time_us) {
  words[0] = time_us;
  words[1] = std::bit_cast<std::uint64_t>(frame.data);
  words[2] =
      std::uint64_t{frame.identifier} << 16 | std::uint64_t{frame.size} << 8 | (frame.remote ? 1u : 0u);
}

hal::CanFrame unpack(std::span<const std::uint64_t> words) {
  return {.identifier = static_cast<std::uint16_t>(words[2] >> 16),
          .size = static_cast<std::uint8_t>(words[2] >> 8 & 0xFFu),
          .remote = (words[2] & 1u) != 0,
          .data = std::bit_cast<std::array<std::uint8_t, 8>>(words[1])};
}

}  // namespace

Recorder::Recorder(const std::filesystem::path& folder, std::vector<TraceColumn> columns, WhenFull when_full,
                   std::size_t ring_words)
    : formatter_(std::move(columns)),
      trace_(folder / "trace.csv"),
      log_(folder / "can.log"),
      writer_(ring_words, when_full, [this](const Ring::Record& record) { write(record); }) {
  trace_.write(formatter_.header());
}

void Recorder::row(std::uint64_t time_us, std::span<const TraceValue> values) {
  assert(values.size() == formatter_.columns().size());
  writer_.check();
  const std::span<std::uint64_t> words = writer_.claim(kRow, values.size() + 1);
  if (words.empty()) return;
  words[0] = time_us;
  for (std::size_t i = 0; i < values.size(); ++i) {
    assert(values[i].kind == formatter_.columns()[i].kind);
    words[i + 1] = values[i].bits;
  }
  writer_.publish();
}

void Recorder::on_bus_frame(const hal::CanFrame& frame, std::uint64_t /*start_us*/, std::uint64_t end_us) {
  const std::span<std::uint64_t> words = writer_.claim(kFrame, kFrameWords);
  if (words.empty()) return;
  pack(words, frame, end_us);
  writer_.publish();
}

void Recorder::close() {
  writer_.close();
  trace_.close();
  log_.close();
}

void Recorder::write(const Ring::Record& record) {
  if (record.kind == kRow) {
    trace_.write(formatter_.row(record.words[0], record.words.subspan(1)));
    return;
  }
  std::array<char, sim_board::kMaxLogLineBytes> line;
  log_.write({line.data(), sim_board::format_log_line(line, unpack(record.words), record.words[0])});
}

}  // namespace koboshi::simulation
