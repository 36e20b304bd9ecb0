#include "view/recording/mcap_index.h"

#include <system_error>

#include "base/text/error.h"

namespace koboshi::view {
namespace {

// The footer: start of the summary, start of its offsets, checksum.
constexpr std::uint64_t kFooterContent_bytes = 8 + 8 + 4;
constexpr std::uint64_t kEnd_bytes = kMcapRecordHead_bytes + kFooterContent_bytes + 8;
constexpr std::uint64_t kMaxSummary_bytes = std::uint64_t{1} << 30;

}  // namespace

McapIndex::McapIndex(const std::filesystem::path& file, const McapListener& listener)
    : file_(file), records_(file, listener), stream_(file, std::ios::binary) {
  std::error_code error;
  size_ = std::filesystem::file_size(file, error);
  if (!stream_ || error)
    throw InputError(file, 0, "no file that can be read", "a recording, such as run.mcap");
  if (size_ < kMcapMagic.size() || take(0, kMcapMagic.size()) != kMcapMagic)
    throw InputError(file_, 0, "other contents", "a recording in the container MCAP (run.mcap)");
  try {
    complete_ = read_summary();
    if (!complete_) scan();
  } catch (const McapTooShort&) {
    throw records_.damaged("a record that is shorter than its fields");
  }
}

std::string McapIndex::take(std::uint64_t offset, std::uint64_t size) {
  std::string bytes(size, '\0');
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset));
  stream_.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(stream_.gcount()) != size)
    throw records_.damaged("an end of the file before the end of a record");
  bytes_read_ += size;
  return bytes;
}

McapIndex::Head McapIndex::head_at(std::uint64_t offset) {
  const std::string bytes = take(offset, kMcapRecordHead_bytes);
  McapCursor fields(bytes);
  const auto kind = static_cast<McapRecord>(fields.number<std::uint8_t>());
  return {kind, fields.number<std::uint64_t>()};
}

// Returns false if the file has no summary with chunks.
bool McapIndex::read_summary() {
  if (size_ < kMcapMagic.size() + kEnd_bytes) return false;
  const std::uint64_t footer = size_ - kEnd_bytes;
  const std::string end = take(footer, kEnd_bytes);
  if (!end.ends_with(kMcapMagic)) return false;
  McapCursor fields(end);
  if (static_cast<McapRecord>(fields.number<std::uint8_t>()) != McapRecord::kFooter ||
      fields.number<std::uint64_t>() != kFooterContent_bytes)
    return false;
  const auto start = fields.number<std::uint64_t>();
  if (start == 0) return false;
  if (start > footer || footer - start > kMaxSummary_bytes)
    throw records_.damaged("a summary outside of the file");
  fields.number<std::uint64_t>();  // start of the offsets
  const auto expected = fields.number<std::uint32_t>();
  const std::string summary = take(start, footer - start);
  const std::string_view footer_part =
      std::string_view(end).substr(0, kMcapRecordHead_bytes + kFooterContent_bytes - sizeof expected);
  if (expected != 0 && expected != mcap_checksum(footer_part, mcap_checksum(summary)))
    throw records_.damaged("a summary whose checksum differs");
  process_summary(summary, start);
  return !chunks_.empty();
}

void McapIndex::process_summary(std::string_view summary, std::uint64_t start) {
  for (McapCursor rest(summary); !rest.empty();) {
    const std::uint64_t place = start + (summary.size() - rest.rest().size());
    const auto kind = static_cast<McapRecord>(rest.number<std::uint8_t>());
    const std::string_view content = rest.bytes(rest.number<std::uint64_t>());
    McapCursor fields(content);
    if (kind == McapRecord::kChunkIndex) {
      McapChunk chunk;
      chunk.start_us = fields.number<std::uint64_t>() / kNanosecondsPerMicrosecond;
      chunk.end_us = fields.number<std::uint64_t>() / kNanosecondsPerMicrosecond;
      chunk.offset = fields.number<std::uint64_t>();
      chunk.length = fields.number<std::uint64_t>();
      add_chunk(chunk);
    } else if (kind == McapRecord::kMetadataIndex) {
      const auto offset = fields.number<std::uint64_t>();
      const auto length = fields.number<std::uint64_t>();
      if (length < kMcapRecordHead_bytes || offset > size_ || length > size_ - offset)
        throw records_.damaged("metadata outside of the file");
      const std::string metadata = take(offset, length);
      records_.process(McapRecord::kMetadata, std::string_view(metadata).substr(kMcapRecordHead_bytes),
                       offset);
    } else if (kind == McapRecord::kSchema || kind == McapRecord::kChannel) {
      records_.process(kind, content, place);
    }
  }
}

// Reads the head of each record, of a chunk also its times.
void McapIndex::scan() {
  std::uint64_t offset = kMcapMagic.size();
  while (size_ - offset >= kMcapRecordHead_bytes) {
    const Head head = head_at(offset);
    const std::uint64_t content = offset + kMcapRecordHead_bytes;
    if (head.length > size_ - content || head.kind == McapRecord::kDataEnd) return;
    if (head.kind == McapRecord::kChunk) {
      const std::string times = take(content, std::min<std::uint64_t>(head.length, 16));
      McapCursor fields(times);
      const std::uint64_t start_us = fields.number<std::uint64_t>() / kNanosecondsPerMicrosecond;
      const std::uint64_t end_us = fields.number<std::uint64_t>() / kNanosecondsPerMicrosecond;
      add_chunk({start_us, end_us, offset, kMcapRecordHead_bytes + head.length});
    } else if (head.kind == McapRecord::kMetadata) {
      records_.process(head.kind, take(content, head.length), offset);
    }
    offset = content + head.length;
  }
}

void McapIndex::add_chunk(const McapChunk& chunk) {
  if (chunk.length < kMcapRecordHead_bytes || chunk.offset > size_ || chunk.length > size_ - chunk.offset)
    throw records_.damaged("a block outside of the file");
  chunks_.push_back(chunk);
}

void McapIndex::read(std::size_t chunk) {
  const McapChunk& place = chunks_[chunk];
  const std::string record = take(place.offset, place.length);
  ++chunks_read_;
  McapCursor fields(record);
  if (static_cast<McapRecord>(fields.number<std::uint8_t>()) != McapRecord::kChunk)
    throw records_.damaged("an index of a block where there is none");
  records_.process(McapRecord::kChunk, std::string_view(record).substr(kMcapRecordHead_bytes), place.offset);
}

}  // namespace koboshi::view
