#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/policy/mlp.h"

namespace koboshi::lab {

// The gradient of a scalar with respect to the weights and biases of a layer, in their order.
struct LayerGradient {
  std::vector<double> weights;  // row by row
  std::vector<double> biases;
};

// A multilayer perceptron, of layers with tanh or without a function, for many inputs at once. Each is a
// column of a matrix. The normaliser of the perceptron's inputs is left out.
class NetworkBatch {
 public:
  explicit NetworkBatch(const tools::Mlp& network);

  // Returns the outputs, and keeps what backward() needs of them.
  const Eigen::MatrixXd& forward(const Eigen::MatrixXd& in);
  // Returns the gradients of a scalar, by layer, whose slopes with respect to the outputs of the last
  // forward() these are (backpropagation).
  [[nodiscard]] std::vector<LayerGradient> backward(const Eigen::MatrixXd& slopes) const;

 private:
  struct BatchLayer {
    Eigen::MatrixXd weights;
    Eigen::VectorXd biases;
    bool has_tanh = false;
  };

  std::vector<BatchLayer> layers_;
  std::vector<Eigen::MatrixXd> activations_;  // the inputs, then the outputs of each layer
};

}  // namespace koboshi::lab
