#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>

namespace koboshi::studio {

// The times of samples, strictly increasing; 8 bytes a sample. Several series share them.
class SampleTimes {
 public:
  void append(std::uint64_t time_us);
  // Removes the samples after the first `size`.
  void truncate(std::size_t size);

  std::size_t size() const { return times_us_.size(); }
  bool empty() const { return times_us_.empty(); }
  std::uint64_t operator[](std::size_t index) const { return times_us_[index]; }
  // Returns the number of samples at or before a time.
  std::size_t count_until(std::uint64_t time_us) const;
  // Returns the number of samples before a time, at least `start`. The search takes O(log k) steps for a
  // result of start + k, and adds them to `nodes`.
  std::size_t count_before(double time_us, std::size_t start, std::size_t& nodes) const;

 private:
  std::deque<std::uint64_t> times_us_{};
};

// Lowest and highest of a set of values; low > high: no value is finite.
struct Extent {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  bool empty() const { return low > high; }
  void add(const Extent& other) {
    low = other.low < low ? other.low : low;
    high = other.high > high ? other.high : high;
  }
  bool operator==(const Extent&) const = default;
};

// An append-only series of values with a pyramid of extents: a node of the lowest level covers kLeaf samples,
// a node of another level covers kBranch nodes of the level below. Only whole nodes exist, so that appending
// never changes one. NaN and infinities are gaps: they belong to no extent.
//
// A sample takes 4 bytes and its share of the pyramid 8/16 * (1 + 1/4 + 1/16 ...) = 0.67 bytes: an hour of
// 250 signals at 100 Hz takes 420 MB. Deques, because growing vectors would copy all of it within one sample.
class Series {
 public:
  static constexpr std::size_t kLeaf = 16;
  static constexpr std::size_t kBranch = 4;
  static constexpr std::size_t kLevels = 8;  // the highest has a node for each 262,144 samples

  void append(float value);
  void truncate(std::size_t size);

  std::size_t size() const { return values_.size(); }
  float operator[](std::size_t index) const { return values_[index]; }
  // Returns the extent of the samples with first <= index < last, and adds the number of samples and nodes
  // that were read to `nodes`: at most max_nodes(last - first).
  Extent extent(std::size_t first, std::size_t last, std::size_t& nodes) const;
  static std::size_t max_nodes(std::size_t samples);

 private:
  void append_node(std::size_t level, const Extent& extent);

  std::deque<float> values_{};
  std::array<std::deque<Extent>, kLevels> levels_{};
};

// The samples within one column of pixels. First, last, lowest and highest value suffice to draw the same
// pixels as with all samples (M4 aggregation: Jugel, Jerzak, Hackenbroich and Markl, PVLDB 7(10), 2014).
struct Column {
  std::size_t samples = 0;
  Extent extent{};
  float first = std::numeric_limits<float>::quiet_NaN();  // NaN: a gap, or no sample
  float last = std::numeric_limits<float>::quiet_NaN();
};

// Divides from_us <= time < to_us into columns of equal duration. Returns the number of samples, nodes and
// times that were read, which grows with the number of columns and with the logarithm of the samples in each,
// not with the samples.
std::size_t summarise(const SampleTimes& times, const Series& values, double from_us, double to_us,
                      std::span<Column> columns);

}  // namespace koboshi::studio
