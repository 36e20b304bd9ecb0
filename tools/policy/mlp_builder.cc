#include "tools/policy/mlp_builder.h"

#include <fmt/format.h>

#include <cmath>

namespace koboshi::tools {

std::size_t MlpBuilder::width() const {
  return mlp_.layers.empty() ? mlp_.factor.size() : mlp_.layers.back().rows;
}

std::string MlpBuilder::set_width(std::size_t width) {
  if (this->width() == width) return {};
  if (this->width() != 0) return fmt::format("{} elements where there are {}", width, this->width());
  mlp_.factor.assign(width, 1.0);
  mlp_.offset.assign(width, 0.0);
  return {};
}

// A layer that leaves its inputs as they are.
void MlpBuilder::append_diagonal() {
  const std::size_t size = width();
  MlpLayer layer{.rows = size, .columns = size};
  layer.weights.resize(size * size);
  layer.biases.resize(size);
  for (std::size_t i = 0; i < size; ++i) layer.weights[i * size + i] = 1.0;
  mlp_.layers.push_back(layer);
  activated_ = false;
}

std::string MlpBuilder::scale(std::span<const double> factor, std::span<const double> offset) {
  const std::size_t size = std::max(factor.size(), offset.size());
  if (size > 1) {
    if (std::string fault = set_width(size); !fault.empty()) return fault;
  } else if (width() == 0) {
    return "one number for all inputs before the number of inputs is known";
  }
  const auto at = [](std::span<const double> values, std::size_t i) {
    return values[values.size() == 1 ? 0 : i];
  };
  if (mlp_.layers.empty()) {
    if (std::isfinite(mlp_.clip)) append_diagonal();
  } else if (activated_) {
    append_diagonal();
  }
  if (mlp_.layers.empty()) {
    for (std::size_t i = 0; i < width(); ++i) {
      mlp_.factor[i] *= at(factor, i);
      mlp_.offset[i] = mlp_.offset[i] * at(factor, i) + at(offset, i);
    }
    return {};
  }
  MlpLayer& layer = mlp_.layers.back();
  for (std::size_t row = 0; row < layer.rows; ++row) {
    for (std::size_t c = 0; c < layer.columns; ++c) layer.weights[row * layer.columns + c] *= at(factor, row);
    layer.biases[row] = layer.biases[row] * at(factor, row) + at(offset, row);
  }
  return {};
}

std::string MlpBuilder::clip(double low, double high) {
  if (!mlp_.layers.empty()) return "a clip after the first layer; bounds of the outputs belong into the map";
  if (!(high > 0.0) || low != -high) return fmt::format("bounds of {} and {}, not -c and c", low, high);
  if (std::isfinite(mlp_.clip)) return "a second clip";
  mlp_.clip = high;
  return {};
}

std::string MlpBuilder::multiply(std::size_t rows, std::size_t columns, std::vector<double> weights) {
  if (std::string fault = set_width(columns); !fault.empty()) return fault;
  // A diagonal in front of it disappears in the product.
  const bool merges = !mlp_.layers.empty() && !activated_;
  if (merges) {
    MlpLayer& before = mlp_.layers.back();
    MlpLayer product{.rows = rows, .columns = before.columns};
    product.weights.resize(rows * before.columns);
    product.biases.resize(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t k = 0; k < columns; ++k) {
        const double w = weights[row * columns + k];
        product.biases[row] += w * before.biases[k];
        for (std::size_t c = 0; c < before.columns; ++c)
          product.weights[row * before.columns + c] += w * before.weight(k, c);
      }
    }
    before = std::move(product);
    return {};
  }
  mlp_.layers.push_back({.rows = rows,
                         .columns = columns,
                         .weights = std::move(weights),
                         .biases = std::vector<double>(rows, 0.0)});
  activated_ = false;
  return {};
}

std::string MlpBuilder::activate(policy::Activation activation) {
  if (mlp_.layers.empty()) return "an activation function before the first layer";
  if (activated_) append_diagonal();
  mlp_.layers.back().activation = activation;
  activated_ = true;
  return {};
}

std::string MlpBuilder::slice(std::size_t begin, std::size_t end) {
  if (mlp_.layers.empty()) return "a slice of the inputs; leave out inputs in the map";
  MlpLayer& layer = mlp_.layers.back();
  if (begin >= end || end > layer.rows) return fmt::format("elements {} to {} of {}", begin, end, layer.rows);
  const auto at = [](std::size_t index) { return static_cast<std::ptrdiff_t>(index); };
  layer.weights = {layer.weights.begin() + at(begin * layer.columns),
                   layer.weights.begin() + at(end * layer.columns)};
  layer.biases = {layer.biases.begin() + at(begin), layer.biases.begin() + at(end)};
  layer.rows = end - begin;
  return {};
}

}  // namespace koboshi::tools
