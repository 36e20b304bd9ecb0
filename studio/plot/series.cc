#include "studio/plot/series.h"

#include <algorithm>
#include <cmath>

#include "firmware/fixed/contract.h"

namespace koboshi::studio {
namespace {

Extent extent_of(float value) { return std::isfinite(value) ? Extent{value, value} : Extent{}; }

}  // namespace

void SampleTimes::append(std::uint64_t time_us) {
  KOBOSHI_ASSERT(times_us_.empty() || time_us > times_us_.back());
  times_us_.push_back(time_us);
}

void SampleTimes::truncate(std::size_t size) {
  if (size < times_us_.size()) times_us_.resize(size);
}

std::size_t SampleTimes::count_until(std::uint64_t time_us) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(times_us_, time_us) - times_us_.begin());
}

std::size_t SampleTimes::count_before(double time_us, std::size_t start, std::size_t& nodes) const {
  const auto is_before = [&](std::size_t index) {
    ++nodes;
    return static_cast<double>(times_us_[index]) < time_us;
  };
  std::size_t low = start;  // all samples below it are before the time
  std::size_t stride = 1;
  while (low + stride <= size() && is_before(low + stride - 1)) {
    low += stride;
    stride *= 2;
  }
  std::size_t high = std::min(low + stride - 1, size());  // the sample there, if any, is not before the time
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (is_before(middle)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

void Series::append(float value) {
  values_.push_back(value);
  if (values_.size() % kLeaf != 0) return;
  Extent extent;
  for (std::size_t i = values_.size() - kLeaf; i < values_.size(); ++i) extent.add(extent_of(values_[i]));
  append_node(0, extent);
}

void Series::append_node(std::size_t level, const Extent& extent) {
  for (Extent node = extent; level < kLevels; ++level) {
    std::deque<Extent>& nodes = levels_[level];
    nodes.push_back(node);
    if (nodes.size() % kBranch != 0) return;
    node = {};
    for (std::size_t i = nodes.size() - kBranch; i < nodes.size(); ++i) node.add(nodes[i]);
  }
}

void Series::truncate(std::size_t size) {
  if (size >= values_.size()) return;
  values_.resize(size);
  std::size_t nodes = size / kLeaf;
  for (std::deque<Extent>& level : levels_) {
    level.resize(nodes);
    nodes /= kBranch;
  }
}

Extent Series::extent(std::size_t first, std::size_t last, std::size_t& nodes) const {
  KOBOSHI_ASSERT(first <= last && last <= size());
  Extent extent;
  const auto add_values = [&](std::size_t begin, std::size_t end) {
    nodes += end - begin;
    for (std::size_t i = begin; i < end; ++i) extent.add(extent_of(values_[i]));
  };
  const std::size_t first_node = (first + kLeaf - 1) / kLeaf;
  const std::size_t last_node = last / kLeaf;
  if (first_node >= last_node) {
    add_values(first, last);
    return extent;
  }
  add_values(first, first_node * kLeaf);
  add_values(last_node * kLeaf, last);
  // Climbs while whole parents remain; their nodes exist, because those of `last_node` and before do.
  std::size_t begin = first_node;
  std::size_t end = last_node;
  for (std::size_t level = 0; begin < end; ++level) {
    const bool is_top = level + 1 == kLevels;
    const std::size_t inner_begin = is_top ? end : std::min(end, (begin + kBranch - 1) / kBranch * kBranch);
    const std::size_t inner_end = is_top ? end : std::max(inner_begin, end / kBranch * kBranch);
    for (std::size_t i = begin; i < inner_begin; ++i) extent.add(levels_[level][i]);
    for (std::size_t i = inner_end; i < end; ++i) extent.add(levels_[level][i]);
    nodes += inner_begin - begin + end - inner_end;
    begin = inner_begin / kBranch;
    end = inner_end / kBranch;
    if (is_top || inner_begin == inner_end) break;
  }
  return extent;
}

std::size_t Series::max_nodes(std::size_t samples) {
  std::size_t nodes = 2 * (kLeaf - 1);
  std::size_t left = samples / kLeaf;
  for (std::size_t level = 0; level + 1 < kLevels && left > 0; ++level, left /= kBranch)
    nodes += 2 * (kBranch - 1);
  return nodes + left;
}

std::size_t summarise(const SampleTimes& times, const Series& values, double from_us, double to_us,
                      std::span<Column> columns) {
  std::size_t nodes = 0;
  const double duration_us = (to_us - from_us) / static_cast<double>(columns.size());
  std::size_t first = times.count_before(from_us, 0, nodes);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::size_t last =
        times.count_before(from_us + static_cast<double>(i + 1) * duration_us, first, nodes);
    columns[i] = {};
    if (first < last) {
      columns[i] = {.samples = last - first,
                    .extent = values.extent(first, last, nodes),
                    .first = values[first],
                    .last = values[last - 1]};
    }
    first = last;
  }
  return nodes;
}

}  // namespace koboshi::studio
