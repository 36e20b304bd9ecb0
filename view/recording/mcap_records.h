#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "base/text/error.h"
#include "view/recording/mcap_format.h"
#include "view/recording/mcap_reader.h"

namespace koboshi::view {

// A record that is shorter than its fields.
struct McapTooShort {};

// Takes fields from the front of a record. Throws McapTooShort.
class McapCursor {
 public:
  explicit McapCursor(std::string_view bytes) : rest_(bytes) {}

  template <typename Unsigned>
  Unsigned number() {
    Unsigned value;
    std::memcpy(&value, bytes(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view bytes(std::uint64_t size) {
    if (size > rest_.size()) throw McapTooShort();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  std::string_view text() { return bytes(number<std::uint32_t>()); }
  std::map<std::string, std::string> map() {
    McapCursor entries(text());
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

std::uint32_t mcap_checksum(std::string_view bytes, std::uint32_t before = 0);

// Interprets the records of an MCAP file, whoever reads them from it. Knows the schemas and channels that it
// has met. Functions throw InputError for damaged contents.
class McapRecords {
 public:
  // The listener must outlive this object.
  McapRecords(std::filesystem::path file, const McapListener& listener)
      : file_(std::move(file)), listener_(listener) {}

  // Interprets a record that begins at this byte of the file; a chunk with all its records.
  void process(McapRecord kind, std::string_view content, std::uint64_t start);
  const std::map<std::uint16_t, McapChannel>& channels() const { return channels_; }

  // The error for what was found in the last record.
  InputError damaged(const std::string& found) const;

 private:
  void process_inner(McapRecord kind, std::string_view content);
  void add_schema(McapCursor& fields);
  void add_channel(McapCursor& fields);
  void pass_on_message(McapCursor& fields);
  void process_chunk(McapCursor& fields);
  void uncompress(std::string_view compression, std::string_view stored, std::uint64_t size);

  const std::filesystem::path file_;
  const McapListener& listener_;
  std::uint64_t record_start_ = 0;
  std::string records_;  // of the present chunk; kept from call to call for its memory
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
};

}  // namespace koboshi::view
