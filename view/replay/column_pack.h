#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace koboshi::view {

// Packs columns of numbers into one sequence of bytes that compresses well. A number becomes a multiple of
// the column's quantum. The prediction from the one or two numbers before it is subtracted, and the bytes of
// equal significance are stored together. data.js reverses this.
class ColumnPack {
 public:
  // Both return the description by which data.js finds the column: a JSON object.
  nlohmann::ordered_json integers(std::span<const std::int64_t> values);
  // Rounds to multiples of the quantum (> 0), by at most half of it. Not-a-numbers stay; infinities become
  // not-a-numbers.
  nlohmann::ordered_json numbers(std::span<const float> values, double quantum);

  const std::string& bytes() const { return bytes_; }

 private:
  nlohmann::ordered_json add(std::span<const std::int64_t> values);

  std::string bytes_;
};

// Reverses ColumnPack, for tests and as the definition of the format.
std::vector<double> unpack(const nlohmann::ordered_json& column, std::string_view bytes);

// The quantum of a column that is only plotted: 1 if all values are integers, else the power of ten that is
// between 1e-6 and 1e-5 of the largest magnitude.
double plot_quantum(std::span<const float> values);

}  // namespace koboshi::view
