#include "view/recording/mcap_reader.h"

#include <fstream>
#include <system_error>

#include "base/text/error.h"
#include "view/recording/mcap_format.h"
#include "view/recording/mcap_records.h"

namespace koboshi::view {
namespace {

namespace fs = std::filesystem;

// Reads a file from its beginning to its end.
class SequentialReader {
 public:
  SequentialReader(const fs::path& file, const McapListener& listener)
      : file_(file), records_(file, listener), stream_(file, std::ios::binary) {
    std::error_code error;
    size_ = fs::file_size(file, error);
    if (!stream_ || error)
      throw InputError(file, 0, "no file that can be read", "a recording, such as run.mcap");
  }

  bool read() {
    std::string magic(kMcapMagic.size(), '\0');
    if (!take(magic) || magic != kMcapMagic)
      throw InputError(file_, 0, "other contents", "a recording in the container MCAP (run.mcap)");
    std::uint32_t crc = mcap_checksum(kMcapMagic);
    std::string head(kMcapRecordHead_bytes, '\0');
    std::string content;
    for (;;) {
      const std::uint64_t start = offset_;
      if (!take(head)) return false;
      McapCursor fields(head);
      const auto kind = static_cast<McapRecord>(fields.number<std::uint8_t>());
      const auto length = fields.number<std::uint64_t>();
      if (length > size_ - offset_) return false;
      content.resize(length);
      if (!take(content)) return false;
      records_.process(kind, content, start);
      if (kind == McapRecord::kDataEnd) {
        if (content.size() < sizeof crc) throw records_.damaged("a record that is shorter than its fields");
        const auto expected = McapCursor(content).number<std::uint32_t>();
        if (expected != 0 && expected != crc) throw records_.damaged("contents whose checksum differs");
        return ends_properly();
      }
      crc = mcap_checksum(content, mcap_checksum(head, crc));
    }
  }

 private:
  // Reads as many bytes as `into` has; returns false if the file ends before.
  bool take(std::string& into) {
    stream_.read(into.data(), static_cast<std::streamsize>(into.size()));
    if (static_cast<std::size_t>(stream_.gcount()) != into.size()) return false;
    offset_ += into.size();
    return true;
  }

  bool ends_properly() {
    std::string end(kMcapMagic.size(), '\0');
    stream_.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
    return take(end) && end == kMcapMagic;
  }

  const fs::path file_;
  McapRecords records_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;
};

}  // namespace

bool read_mcap(const fs::path& file, const McapListener& listener) {
  return SequentialReader(file, listener).read();
}

}  // namespace koboshi::view
