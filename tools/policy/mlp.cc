#include "tools/policy/mlp.h"

#include <algorithm>
#include <cmath>

namespace koboshi::tools {
namespace {

double value_of(policy::Activation activation, double z) {
  switch (activation) {
    case policy::Activation::kLinear:
      return z;
    case policy::Activation::kRelu:
      return std::max(z, 0.0);
    case policy::Activation::kElu:
      return z > 0.0 ? z : std::expm1(z);
    case policy::Activation::kTanh:
      return std::tanh(z);
    case policy::Activation::kSilu:
      return z / (1.0 + std::exp(-z));
  }
  return z;
}

}  // namespace

std::vector<double> Mlp::run(std::span<const double> in, const Watch& watch) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < inputs(); ++i)
    values.push_back(std::clamp(in[i] * factor[i] + offset[i], -clip, clip));
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const MlpLayer& layer = layers[i];
    std::vector<double> sums = layer.biases;
    for (std::size_t row = 0; row < layer.rows; ++row) {
      for (std::size_t c = 0; c < layer.columns; ++c) sums[row] += layer.weight(row, c) * values[c];
    }
    if (watch) watch(i, sums);
    for (double& sum : sums) sum = value_of(layer.activation, sum);
    values = std::move(sums);
  }
  return values;
}

}  // namespace koboshi::tools
