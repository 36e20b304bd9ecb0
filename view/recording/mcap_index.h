#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "view/recording/mcap_records.h"

namespace koboshi::view {

// A chunk of an MCAP file.
struct McapChunk {
  std::uint64_t start_us = 0;  // of its messages
  std::uint64_t end_us = 0;
  std::uint64_t offset = 0;  // of its record in the file
  std::uint64_t length = 0;  // of its record, with opcode and length
};

// Reads an MCAP file chunk by chunk, in any order, by the index in its summary. A file that was cut off has
// no summary: the heads of its records are read instead, and the chunks behind the cut are missing. Functions
// throw InputError for damaged contents.
class McapIndex {
 public:
  // Reads the index and passes the metadata on, but no chunk. The listener must outlive this object.
  McapIndex(const std::filesystem::path& file, const McapListener& listener);

  // In the order of the file.
  const std::vector<McapChunk>& chunks() const { return chunks_; }
  // Whether the file has a summary.
  bool complete() const { return complete_; }
  // Those of the summary and of the chunks that have been read.
  const std::map<std::uint16_t, McapChannel>& channels() const { return records_.channels(); }
  // Passes on the messages of a chunk.
  void read(std::size_t chunk);

  // How much has been read so far.
  std::uint64_t bytes_read() const { return bytes_read_; }
  std::size_t chunks_read() const { return chunks_read_; }

 private:
  struct Head {
    McapRecord kind{};
    std::uint64_t length = 0;  // of the content
  };

  std::string take(std::uint64_t offset, std::uint64_t size);
  Head head_at(std::uint64_t offset);
  bool read_summary();
  void process_summary(std::string_view summary, std::uint64_t start);
  void scan();
  void add_chunk(const McapChunk& chunk);

  const std::filesystem::path file_;
  McapRecords records_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  bool complete_ = false;
  std::vector<McapChunk> chunks_;
  std::uint64_t bytes_read_ = 0;
  std::size_t chunks_read_ = 0;
};

}  // namespace koboshi::view
