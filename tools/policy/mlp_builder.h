#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tools/policy/mlp.h"

namespace koboshi::tools {

// Makes an Mlp of the elementary operations of a graph, in their order. Scalings are folded into the
// normaliser or into a layer. Each function returns what makes the operation impossible there; empty if it is
// possible.
class MlpBuilder {
 public:
  // Factor and offset by element, or one of each for all.
  [[nodiscard]] std::string scale(std::span<const double> factor, std::span<const double> offset);
  [[nodiscard]] std::string clip(double low, double high);
  // `weights` by row; biases zero.
  [[nodiscard]] std::string multiply(std::size_t rows, std::size_t columns, std::vector<double> weights);
  [[nodiscard]] std::string activate(policy::Activation activation);
  // Keeps the elements from `begin` to before `end`.
  [[nodiscard]] std::string slice(std::size_t begin, std::size_t end);

  // Elements of the present value; 0 while nothing has told.
  [[nodiscard]] std::size_t width() const;
  [[nodiscard]] const Mlp& mlp() const { return mlp_; }

 private:
  [[nodiscard]] std::string set_width(std::size_t width);
  void append_diagonal();

  Mlp mlp_;
  bool activated_ = false;  // the last layer has its activation function
};

}  // namespace koboshi::tools
