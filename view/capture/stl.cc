#include "view/capture/stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "base/text/foreign_text.h"
#include "base/text/text.h"

namespace koboshi::view {
namespace {

constexpr std::size_t kHeader_bytes = 80 + 4;        // a title, and the number of triangles
constexpr std::size_t kNormal_bytes = 3 * 4;         // in front of each triangle's corners
constexpr std::size_t kTriangle_bytes = 4 * 12 + 2;  // normal, three corners and an attribute

using Corner = std::array<float, 3>;

// FNV-1a over the coordinates.
struct CornerHash {
  std::size_t operator()(const Corner& corner) const {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const float value : corner) hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 0x100000001B3;
    return hash ^ hash >> 32;
  }
};

// Collects triangles; corners at the same place become one vertex.
class MeshBuilder {
 public:
  void add(const std::array<Corner, 3>& corners) {
    auto& triangle = mesh_.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      for (const float value : corners[i]) is_finite_ = is_finite_ && std::isfinite(value);
      const auto next = static_cast<std::uint32_t>(mesh_.vertices_m.size());
      const auto [vertex, is_new] = vertices_.try_emplace(corners[i], next);
      if (is_new) mesh_.vertices_m.emplace_back(corners[i].data());
      triangle[i] = vertex->second;
    }
  }

  StlFile take() {
    if (!is_finite_) return {.fault = "a vertex that is no finite number", .is_damaged = true};
    return {.mesh = std::move(mesh_)};
  }

 private:
  Mesh mesh_;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;  // only looked up: its order is arbitrary
  bool is_finite_ = true;
};

StlFile read_binary(const std::string& bytes, std::size_t count) {
  MeshBuilder builder;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<Corner, 3> corners;
    std::memcpy(&corners, bytes.data() + kHeader_bytes + kTriangle_bytes * i + kNormal_bytes, sizeof corners);
    builder.add(corners);
  }
  return builder.take();
}

// The words of an ASCII file with their lines.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  // The next word in lower case letters, as some exporters write capitals; empty at the end.
  std::string next() {
    skip_blanks();
    std::string word;
    while (at_ < text_.size() && !is_blank(text_[at_])) {
      const char c = text_[at_++];
      word += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return word;
  }
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }
  std::string place() const { return "line " + std::to_string(line_); }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  void skip_blanks() {
    for (; at_ < text_.size() && is_blank(text_[at_]); ++at_) line_ += text_[at_] == '\n' ? 1 : 0;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

StlFile damaged(const Words& words, const std::string& word, const std::string& expected) {
  return {.fault = "in " + words.place() + " " + (word.empty() ? "the end" : "'" + one_line(word) + "'") +
                   " instead of " + expected,
          .is_damaged = true};
}

// A number of any magnitude: one beyond the range of float becomes infinite. Nothing for another text.
std::optional<float> coordinate(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) return std::numeric_limits<float>::infinity();
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return static_cast<float>(value);
}

// solid NAME { facet normal x y z outer loop { vertex x y z }3 endloop endfacet } endsolid NAME, once or
// more.
StlFile read_ascii(std::string_view text) {
  constexpr std::array kBefore{"normal", "", "", "", "outer", "loop"};  // empty: a number
  Words words(text);
  MeshBuilder builder;
  std::size_t count = 0;
  while (true) {
    const std::string word = words.next();
    if (word.empty()) break;
    if (word == "solid" || word == "endsolid") {
      words.skip_line();
      continue;
    }
    if (word != "facet") return damaged(words, word, "facet");
    for (const std::string_view expected : kBefore) {
      const std::string next = words.next();
      if (expected.empty() ? next.empty() : next != expected)
        return damaged(words, next, expected.empty() ? "a number" : std::string(expected));
    }
    std::array<Corner, 3> corners{};
    for (Corner& corner : corners) {
      if (const std::string vertex = words.next(); vertex != "vertex")
        return damaged(words, vertex, "vertex");
      for (float& value : corner) {
        const std::string number = words.next();
        const auto parsed = coordinate(number);
        if (!parsed) return damaged(words, number, "a number");
        value = *parsed;
      }
    }
    for (const char* expected : {"endloop", "endfacet"})
      if (const std::string end = words.next(); end != expected) return damaged(words, end, expected);
    builder.add(corners);
    ++count;
  }
  if (count == 0) return {.fault = "no triangle", .is_damaged = true};
  return builder.take();
}

}  // namespace

StlFile read_stl(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.size() >= kHeader_bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kHeader_bytes - sizeof count, sizeof count);
    if (bytes.size() == kHeader_bytes + kTriangle_bytes * count) return read_binary(bytes, count);
  }
  // A binary file may begin with the same word, but its size then fits its number of triangles.
  if (const std::string text = with_line_feeds(bytes); Words(text).next() == "solid") return read_ascii(text);
  return {.fault = bytes.empty() ? "an empty file"
                                 : "another format, or a binary STL of another length than it says"};
}

}  // namespace koboshi::view
