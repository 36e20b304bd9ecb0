#include "tools/view/capture/stl.h"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <unordered_map>

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

}  // namespace

std::optional<Mesh> read_stl(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.size() < kHeader_bytes) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader_bytes - sizeof count, sizeof count);
  if (bytes.size() != kHeader_bytes + kTriangle_bytes * count) return {};
  Mesh mesh;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices;  // only looked up: its order is arbitrary
  for (std::size_t i = 0; i < count; ++i) {
    std::array<Corner, 3> corners;
    std::memcpy(&corners, bytes.data() + kHeader_bytes + kTriangle_bytes * i + kNormal_bytes, sizeof corners);
    auto& triangle = mesh.triangles.emplace_back();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto next = static_cast<std::uint32_t>(mesh.vertices_m.size());
      const auto [vertex, is_new] = vertices.try_emplace(corners[corner], next);
      if (is_new) mesh.vertices_m.emplace_back(corners[corner].data());
      triangle[corner] = vertex->second;
    }
  }
  return mesh;
}

}  // namespace koboshi::view
