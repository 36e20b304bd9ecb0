#include "tools/view/recording/mcap_reader.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include "sim_board/input/error.h"
#include "tools/view/recording/mcap_format.h"

namespace koboshi::view {
namespace {

namespace fs = std::filesystem;

// Larger blocks than any writer makes are taken for damage, before memory is allocated for them.
constexpr std::uint64_t kMaxReadBlock_bytes = std::uint64_t{1} << 30;

std::uint32_t checksum(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

// A record that is shorter than its fields.
struct TooShort {};

// Takes fields from the front of a record. Throws TooShort.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  template <typename Unsigned>
  Unsigned number() {
    Unsigned value;
    std::memcpy(&value, bytes(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view bytes(std::uint64_t size) {
    if (size > rest_.size()) throw TooShort();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  std::string_view text() { return bytes(number<std::uint32_t>()); }
  std::map<std::string, std::string> map() {
    Cursor entries(text());
    std::map<std::string, std::string> map;
    while (!entries.empty()) {
      std::string key(entries.text());
      map.emplace(std::move(key), entries.text());
    }
    return map;
  }
  std::string_view rest() const { return rest_; }
  bool empty() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

struct Record {
  McapRecord kind{};
  std::string_view content;
};

class Reader {
 public:
  Reader(const fs::path& file, const McapListener& listener)
      : file_(file), listener_(listener), stream_(file, std::ios::binary) {
    std::error_code error;
    size_ = fs::file_size(file, error);
    if (!stream_ || error)
      throw sim::InputError(file, 0, "no file that can be read", "a recording, such as run.mcap");
  }

  bool read() {
    std::string magic(kMcapMagic.size(), '\0');
    if (!take(magic) || magic != kMcapMagic)
      throw sim::InputError(file_, 0, "other contents", "a recording in the container MCAP (run.mcap)");
    try {
      return read_records();
    } catch (const TooShort&) {
      throw damaged("a record that is shorter than its fields");
    }
  }

 private:
  sim::InputError damaged(const std::string& found) const {
    return {file_, 0, fmt::format("{} (at byte {})", found, record_start_), "an undamaged recording"};
  }

  // Reads as many bytes as `into` has; returns false if the file ends before.
  bool take(std::string& into) {
    stream_.read(into.data(), static_cast<std::streamsize>(into.size()));
    if (static_cast<std::size_t>(stream_.gcount()) != into.size()) return false;
    offset_ += into.size();
    return true;
  }

  bool read_records() {
    std::uint32_t crc = checksum(kMcapMagic);
    std::string head(kMcapRecordHead_bytes, '\0');
    std::string content;
    for (;;) {
      record_start_ = offset_;
      if (!take(head)) return false;
      Cursor fields(head);
      const auto kind = static_cast<McapRecord>(fields.number<std::uint8_t>());
      const auto length = fields.number<std::uint64_t>();
      if (length > size_ - offset_) return false;
      content.resize(length);
      if (!take(content)) return false;
      if (kind == McapRecord::kDataEnd) {
        const auto expected = Cursor(content).number<std::uint32_t>();
        if (expected != 0 && expected != crc) throw damaged("contents whose checksum differs");
        return ends_properly();
      }
      crc = checksum(content, checksum(head, crc));
      process({kind, content});
    }
  }

  bool ends_properly() {
    std::string end(kMcapMagic.size(), '\0');
    stream_.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
    return take(end) && end == kMcapMagic;
  }

  void process(const Record& record) {
    Cursor fields(record.content);
    switch (record.kind) {
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

  void add_schema(Cursor& fields) {
    const auto id = fields.number<std::uint16_t>();
    schemas_[id] = fields.text();
  }

  void add_channel(Cursor& fields) {
    const auto id = fields.number<std::uint16_t>();
    const auto schema = fields.number<std::uint16_t>();
    McapChannel channel;
    channel.topic = fields.text();
    channel.schema = schemas_[schema];
    fields.text();  // encoding
    channel.metadata = fields.map();
    channels_[id] = std::move(channel);
  }

  void pass_on_message(Cursor& fields) {
    const auto channel = channels_.find(fields.number<std::uint16_t>());
    if (channel == channels_.end()) throw damaged("a message of an unknown channel");
    fields.number<std::uint32_t>();  // sequence
    const auto time_ns = fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();  // publish time
    listener_.on_message(channel->second, time_ns / kNanosecondsPerMicrosecond, fields.rest());
  }

  void process_chunk(Cursor& fields) {
    fields.bytes(2 * sizeof(std::uint64_t));  // start and end time
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string_view compression = fields.text();
    const std::string_view stored = fields.bytes(fields.number<std::uint64_t>());
    const std::string records = uncompressed(compression, stored, size);
    if (crc != 0 && checksum(records) != crc) throw damaged("a block whose checksum differs");
    for (Cursor rest(records); !rest.empty();) {
      const auto kind = static_cast<McapRecord>(rest.number<std::uint8_t>());
      const std::string_view content = rest.bytes(rest.number<std::uint64_t>());
      if (kind == McapRecord::kChunk) throw damaged("a block within a block");
      process({kind, content});
    }
  }

  std::string uncompressed(std::string_view compression, std::string_view stored, std::uint64_t size) const {
    if (compression.empty()) return std::string(stored);
    if (compression != "zstd") throw damaged(fmt::format("a block compressed by '{}'", compression));
    if (size > kMaxReadBlock_bytes) throw damaged(fmt::format("a block of {} bytes", size));
    // The frame's own size, if it has one, before memory is allocated for the size that the block claims.
    const auto content = ZSTD_getFrameContentSize(stored.data(), stored.size());
    if (content == ZSTD_CONTENTSIZE_ERROR || (content != ZSTD_CONTENTSIZE_UNKNOWN && content != size))
      throw damaged("a block that cannot be decompressed");
    std::string records(size, '\0');
    const std::size_t result = ZSTD_decompress(records.data(), records.size(), stored.data(), stored.size());
    if (ZSTD_isError(result) != 0 || result != size) throw damaged("a block that cannot be decompressed");
    return records;
  }

  const fs::path file_;
  const McapListener& listener_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;
  std::uint64_t record_start_ = 0;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
};

}  // namespace

bool read_mcap(const fs::path& file, const McapListener& listener) { return Reader(file, listener).read(); }

}  // namespace koboshi::view
