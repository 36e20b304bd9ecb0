#include "view/recording/mcap_records.h"

#include <utility>

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

namespace koboshi::view {
namespace {

// Larger blocks than any writer makes are taken for damage, before memory is allocated for them.
constexpr std::uint64_t kMaxReadBlock_bytes = std::uint64_t{1} << 30;

}  // namespace

std::uint32_t mcap_checksum(std::string_view bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

InputError McapRecords::damaged(const std::string& found) const {
  return {file_, 0, fmt::format("{} (at byte {})", found, record_start_), "an undamaged recording"};
}

void McapRecords::process(McapRecord kind, std::string_view content, std::uint64_t start) {
  record_start_ = start;
  try {
    process_inner(kind, content);
  } catch (const McapTooShort&) {
    throw damaged("a record that is shorter than its fields");
  }
}

void McapRecords::process_inner(McapRecord kind, std::string_view content) {
  McapCursor fields(content);
  switch (kind) {
    case McapRecord::kSchema:
      return add_schema(fields);
    case McapRecord::kChannel:
      return add_channel(fields);
    case McapRecord::kMessage:
      return pass_on_message(fields);
    case McapRecord::kChunk:
      return process_chunk(fields);
    case McapRecord::kMetadata: {
      const std::string name(fields.text());
      return listener_.on_metadata(name, fields.map());
    }
    default:
      return;  // indices, and records of later versions
  }
}

void McapRecords::add_schema(McapCursor& fields) {
  const auto id = fields.number<std::uint16_t>();
  schemas_[id] = fields.text();
}

void McapRecords::add_channel(McapCursor& fields) {
  const auto id = fields.number<std::uint16_t>();
  const auto schema = fields.number<std::uint16_t>();
  McapChannel channel;
  channel.topic = fields.text();
  channel.schema = schemas_[schema];
  fields.text();  // encoding
  channel.metadata = fields.map();
  channels_[id] = std::move(channel);
}

void McapRecords::pass_on_message(McapCursor& fields) {
  const auto channel = channels_.find(fields.number<std::uint16_t>());
  if (channel == channels_.end()) throw damaged("a message of an unknown channel");
  fields.number<std::uint32_t>();  // sequence
  const auto time_ns = fields.number<std::uint64_t>();
  fields.number<std::uint64_t>();  // publish time
  listener_.on_message(channel->second, time_ns / kNanosecondsPerMicrosecond, fields.rest());
}

void McapRecords::process_chunk(McapCursor& fields) {
  fields.bytes(2 * sizeof(std::uint64_t));  // start and end time
  const auto size = fields.number<std::uint64_t>();
  const auto crc = fields.number<std::uint32_t>();
  const std::string_view compression = fields.text();
  const std::string_view stored = fields.bytes(fields.number<std::uint64_t>());
  uncompress(compression, stored, size);
  if (crc != 0 && mcap_checksum(records_) != crc) throw damaged("a block whose checksum differs");
  for (McapCursor rest(records_); !rest.empty();) {
    const auto kind = static_cast<McapRecord>(rest.number<std::uint8_t>());
    const std::string_view content = rest.bytes(rest.number<std::uint64_t>());
    if (kind == McapRecord::kChunk) throw damaged("a block within a block");
    process_inner(kind, content);
  }
}

void McapRecords::uncompress(std::string_view compression, std::string_view stored, std::uint64_t size) {
  if (compression.empty()) {
    records_ = stored;
    return;
  }
  if (compression != "zstd") throw damaged(fmt::format("a block compressed by '{}'", compression));
  if (size > kMaxReadBlock_bytes) throw damaged(fmt::format("a block of {} bytes", size));
  // The frame's own size, if it has one, before memory is allocated for the size that the block claims.
  const auto content = ZSTD_getFrameContentSize(stored.data(), stored.size());
  if (content == ZSTD_CONTENTSIZE_ERROR || (content != ZSTD_CONTENTSIZE_UNKNOWN && content != size))
    throw damaged("a block that cannot be decompressed");
  records_.resize(size);
  const std::size_t result = ZSTD_decompress(records_.data(), records_.size(), stored.data(), stored.size());
  if (ZSTD_isError(result) != 0 || result != size) throw damaged("a block that cannot be decompressed");
}

}  // namespace koboshi::view
