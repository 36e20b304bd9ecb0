#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace koboshi::view {

struct McapChannel {
  std::string topic;
  std::string schema;  // full name of the message
  std::map<std::string, std::string> metadata;
};

// Receives the contents of an MCAP file in their order. Views are valid during the call.
struct McapListener {
  std::function<void(const std::string& name, const std::map<std::string, std::string>& metadata)>
      on_metadata;
  std::function<void(const McapChannel& channel, std::uint64_t time_us, std::string_view data)> on_message;
};

// Reads an MCAP file whose chunks are compressed by zstd or not at all; indices are not needed. Returns
// whether the file is complete: false if it ends before its end, and then everything up to the last whole
// block has been passed on. Throws InputError for another file and for one with damaged contents.
bool read_mcap(const std::filesystem::path& file, const McapListener& listener);

}  // namespace koboshi::view
