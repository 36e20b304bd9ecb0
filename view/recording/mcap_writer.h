#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <zstd.h>

#include "base/file/output_file.h"
#include "view/recording/mcap_format.h"

namespace koboshi::view {

// Writes an MCAP file (mcap_format.h) of Protobuf messages in blocks: chunks that are compressed by zstd,
// with a message index after each. A complete block is on the disk when the next one begins, so a file that
// is cut off holds all blocks before the cut. The same calls give the same bytes. All functions throw
// WriteError.
class McapWriter {
 public:
  using Texts = std::map<std::string, std::string>;

  // `library` names the writing program.
  McapWriter(const std::filesystem::path& file, std::string_view library);

  void add_metadata(std::string_view name, const Texts& metadata);
  // Adds a Protobuf schema: the full name of the message and a serialised FileDescriptorSet. Returns its id.
  std::uint16_t add_schema(std::string_view message, std::string_view descriptors);
  // Returns the channel's id.
  std::uint16_t add_channel(std::string_view topic, std::uint16_t schema, const Texts& metadata = {});
  void add_message(std::uint16_t channel, std::uint64_t time_us, std::string_view data);

  // Ends the block, which must then be on the disk.
  void end_block();
  // Length of the present block so far, before compression.
  std::size_t block_bytes() const { return block_.size(); }

  // Writes index and end of the file; nothing may be added afterwards.
  void close();

 private:
  struct Times {
    std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t last_ns = 0;
    void add(std::uint64_t time_ns);
    void add(const Times& other);
    std::uint64_t start_ns() const { return first_ns <= last_ns ? first_ns : 0; }
  };
  // Place of a message: time and offset in the uncompressed block.
  struct Place {
    std::uint64_t time_ns;
    std::uint64_t offset;
  };

  void write(std::string_view bytes);
  void write_record(McapRecord kind, std::initializer_list<std::string_view> parts);
  std::string_view compressed_block();
  void write_chunk(std::string& index);
  std::map<std::uint16_t, std::uint64_t> write_message_indices();
  std::string statistics() const;

  OutputFile file_;
  std::uint64_t offset_ = 0;  // bytes written
  std::uint32_t crc_ = 0;     // of all bytes written
  std::string block_;         // records of the present block
  // Kept from block to block for its memory.
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> compressor_;
  std::string compressed_;
  Times block_times_;
  std::map<std::uint16_t, std::vector<Place>> places_;  // of the present block's messages, by channel

  // The records that the summary repeats.
  std::string schemas_;
  std::string channels_;
  std::string chunk_indices_;
  std::string metadata_indices_;
  std::uint16_t schema_count_ = 0;
  std::uint16_t channel_count_ = 0;
  std::uint32_t metadata_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  Times times_;
  std::map<std::uint16_t, std::uint64_t> message_counts_;  // by channel
};

}  // namespace koboshi::view
