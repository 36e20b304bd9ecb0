#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "firmware/policy/activation.h"

namespace koboshi::tools {

// A layer of a multilayer perceptron in floating point: f(weights * in + biases).
struct MlpLayer {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> weights{};  // row by row
  std::vector<double> biases{};
  policy::Activation activation = policy::Activation::kLinear;

  [[nodiscard]] double weight(std::size_t row, std::size_t column) const {
    return weights[row * columns + column];
  }
};

// A multilayer perceptron with the normaliser of its inputs: clamp(input * factor + offset, -clip, clip).
struct Mlp {
  std::vector<double> factor{};  // by input
  std::vector<double> offset{};
  double clip = std::numeric_limits<double>::infinity();
  std::vector<MlpLayer> layers{};

  [[nodiscard]] std::size_t inputs() const { return factor.size(); }
  [[nodiscard]] std::size_t outputs() const { return layers.back().rows; }

  // Called with the pre-activations of each layer.
  using Watch = std::function<void(std::size_t layer, std::span<const double> sums)>;
  [[nodiscard]] std::vector<double> run(std::span<const double> in, const Watch& watch = {}) const;
};

}  // namespace koboshi::tools
