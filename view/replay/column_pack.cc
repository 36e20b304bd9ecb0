#include "view/replay/column_pack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace koboshi::view {
namespace {

using nlohmann::ordered_json;

constexpr int kMaxOrder = 2;
// Doubles, and so JavaScript, represent integers exactly up to this magnitude.
constexpr double kMaxInteger = 9007199254740992.0;

// Prediction of a value: 0, the last one, or the straight line through the last two.
std::uint64_t prediction(int order, std::uint64_t last, std::uint64_t before_last) {
  if (order == 0) return 0;
  return order == 1 ? last : 2 * last - before_last;
}

// Maps small magnitudes of both signs to small numbers: 0, -1, 1, -2 become 0, 1, 2, 3.
std::uint64_t zigzag(std::uint64_t value) {
  return value << 1 ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(value) >> 63);
}

std::int64_t unzigzag(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1 ^ (~(value & 1) + 1));
}

std::vector<std::uint64_t> residuals(std::span<const std::int64_t> values, int order) {
  std::vector<std::uint64_t> result;
  result.reserve(values.size());
  std::uint64_t last = 0;
  std::uint64_t before_last = 0;
  for (const std::int64_t value : values) {
    const auto bits = static_cast<std::uint64_t>(value);
    result.push_back(zigzag(bits - prediction(order, last, before_last)));
    before_last = last;
    last = bits;
  }
  return result;
}

std::uint64_t total_bits(std::span<const std::uint64_t> residuals) {
  std::uint64_t bits = 0;
  for (const std::uint64_t residual : residuals) bits += static_cast<unsigned>(std::bit_width(residual));
  return bits;
}

}  // namespace

ordered_json ColumnPack::add(std::span<const std::int64_t> values) {
  int order = 0;
  std::vector<std::uint64_t> best = residuals(values, 0);
  for (int candidate = 1; candidate <= kMaxOrder; ++candidate) {
    std::vector<std::uint64_t> other = residuals(values, candidate);
    if (total_bits(other) >= total_bits(best)) continue;
    best = std::move(other);
    order = candidate;
  }
  const std::uint64_t largest = best.empty() ? 0 : *std::ranges::max_element(best);
  const int planes = (static_cast<int>(std::bit_width(largest)) + 7) / 8;
  ordered_json column = {
      {"at", bytes_.size()}, {"count", values.size()}, {"order", order}, {"planes", planes}};
  for (int plane = 0; plane < planes; ++plane) {
    for (const std::uint64_t residual : best) bytes_ += static_cast<char>(residual >> (8 * plane) & 0xFF);
  }
  return column;
}

ordered_json ColumnPack::integers(std::span<const std::int64_t> values) { return add(values); }

ordered_json ColumnPack::numbers(std::span<const float> values, double quantum) {
  std::vector<std::int64_t> multiples;
  multiples.reserve(values.size());
  std::int64_t lowest = 0;
  bool gaps = false;
  for (const float value : values) {
    const double multiple = std::round(static_cast<double>(value) / quantum);
    const bool representable = std::isfinite(value) && std::abs(multiple) < kMaxInteger / 4.0;
    multiples.push_back(representable ? static_cast<std::int64_t>(multiple)
                                      : std::numeric_limits<std::int64_t>::min());
    if (representable) {
      lowest = std::min(lowest, multiples.back());
    } else {
      gaps = true;
    }
  }
  std::ranges::replace(multiples, std::numeric_limits<std::int64_t>::min(), lowest - 1);
  ordered_json column = add(multiples);
  column["quantum"] = quantum;
  if (gaps) column["none"] = lowest - 1;
  return column;
}

std::vector<double> unpack(const ordered_json& column, std::string_view bytes) {
  const auto at = column.at("at").get<std::size_t>();
  const auto count = column.at("count").get<std::size_t>();
  const int order = column.at("order");
  const int planes = column.at("planes");
  const double quantum = column.value("quantum", 1.0);
  std::vector<double> values;
  std::uint64_t last = 0;
  std::uint64_t before_last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t residual = 0;
    for (int plane = planes; plane-- > 0;) {
      const char byte = bytes[at + static_cast<std::size_t>(plane) * count + i];
      residual = residual << 8 | static_cast<unsigned char>(byte);
    }
    const std::uint64_t bits =
        static_cast<std::uint64_t>(unzigzag(residual)) + prediction(order, last, before_last);
    before_last = last;
    last = bits;
    const auto value = static_cast<std::int64_t>(bits);
    const bool none = column.contains("none") && value == column.at("none").get<std::int64_t>();
    values.push_back(none ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(value) * quantum);
  }
  return values;
}

double plot_quantum(std::span<const float> values) {
  double largest = 0.0;
  bool integers = true;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    largest = std::max(largest, static_cast<double>(std::abs(value)));
    integers = integers && value == std::round(value);
  }
  return integers || largest == 0.0 ? 1.0 : std::pow(10.0, std::floor(std::log10(largest)) - 5.0);
}

}  // namespace koboshi::view
