#include "view/replay/replay_page.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/file/output_file.h"
#include "view/render/looks.h"
#include "view/replay/page_parts.h"
#include "view/replay/replay_data.h"

namespace koboshi::view {
namespace {

std::string gzip(std::string_view data) {
  constexpr int kGzipWindow = 15 + 16;  // the largest window, and a gzip header (zlib.h)
  constexpr int kDefaultMemory = 8;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, kDefaultMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("zlib cannot start compression");
  }
  std::string compressed(deflateBound(&stream, data.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  const int status = deflate(&stream, Z_FINISH);
  compressed.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib cannot compress the data of the page");
  return compressed;
}

std::string base64(std::string_view data) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((data.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < data.size(); i += 3) {
    const std::string_view group = data.substr(i, 3);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < group.size() ? static_cast<unsigned char>(group[k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= group.size() ? kDigits[bits >> (18 - 6 * k) & 0x3F] : '=';
  }
  return text;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

// Replaces each {{NAME}} of the template by the text of this name, in one pass.
std::string filled(std::string_view text,
                   std::initializer_list<std::pair<std::string_view, std::string_view>> values) {
  std::string result;
  for (std::size_t at = 0;;) {
    const std::size_t begin = text.find("{{", at);
    result += text.substr(at, begin - at);
    if (begin == std::string_view::npos) return result;
    const std::size_t end = text.find("}}", begin);
    const std::string_view name = text.substr(begin + 2, end - begin - 2);
    for (const auto& [key, value] : values) {
      if (key == name) result += value;
    }
    at = end + 2;
  }
}

// The page's LOOKS (looks.h).
std::string looks() {
  using nlohmann::ordered_json;
  ordered_json views = ordered_json::array();
  for (const NamedView& view : kNamedViews)
    views.push_back({{"key", std::string(1, view.key)},
                     {"name", view.name},
                     {"azimuth_deg", view.azimuth_deg},
                     {"elevation_deg", view.elevation_deg}});
  ordered_json keys;
  for (const SharedKey& shared : kSharedKeys) keys[std::string(shared.action)] = shared.key;
  const auto css = [](const Colour& colour) {
    const auto byte = [](float share) { return static_cast<int>(std::lround(255.0F * share)); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(colour.red), byte(colour.green), byte(colour.blue));
  };
  const ordered_json colours{
      {"planned", css(kPlannedColour)},  {"measured", css(kMeasuredColour)}, {"true", css(kTrueColour)},
      {"com", css(kComColour)},          {"contact", css(kContactColour)},   {"push", css(kPushColour)},
      {"support", css(kMeasuredColour)}, {"left", css(kSideColours[0])},     {"right", css(kSideColours[1])}};
  return ordered_json{{"views", views}, {"keys", keys}, {"colours", colours}}.dump();
}

// Nothing is loaded from anywhere, and the data cannot become code.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:";

// `data` is base64 text, or "live".
std::string page_of(const std::string& title, const std::string& policy, std::string_view data) {
  const PageParts parts = page_parts();
  return filled(parts.html, {{"policy", policy},
                             {"title", escaped(title)},
                             {"style", parts.style},
                             {"three", parts.three},
                             {"looks", looks()},
                             {"scripts", parts.scripts},
                             {"data", data}});
}

}  // namespace

bus::Network network_of(const Recording& recording, bus::Network network) {
  bus::Network recorded;
  for (const CanNode& node : recording.nodes)
    recorded.nodes.push_back({static_cast<std::uint8_t>(node.id), node.name});
  const auto is_known = [&](const bus::NetworkNode& node) {
    return std::ranges::any_of(network.nodes, [&](const bus::NetworkNode& other) {
      return other.node_id == node.node_id && other.name == node.name;
    });
  };
  return std::ranges::all_of(recorded.nodes, is_known) ? std::move(network) : std::move(recorded);
}

std::string replay_page(const Recording& recording, const Recording* other, const bus::Network& network) {
  return page_of(recording.title, kPolicy, base64(gzip(replay_data(recording, other, network))));
}

std::string live_page(const std::string& title, std::uint16_t port) {
  return page_of(title, live_page_policy(port), "live");
}

std::string live_page_policy(std::uint16_t port) {
  return fmt::format("{}; connect-src ws://127.0.0.1:{} ws://localhost:{}", kPolicy, port, port);
}

void write_replay_page(const Recording& recording, const Recording* other, const bus::Network& network,
                       const std::filesystem::path& file) {
  write_whole_file(file, replay_page(recording, other, network));
}

}  // namespace koboshi::view
