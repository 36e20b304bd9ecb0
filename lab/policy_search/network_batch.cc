#include "lab/policy_search/network_batch.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace koboshi::lab {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

NetworkBatch::NetworkBatch(const tools::Mlp& network) {
  for (const tools::MlpLayer& layer : network.layers) {
    if (layer.activation != policy::Activation::kTanh && layer.activation != policy::Activation::kLinear)
      throw std::logic_error("a layer with another function than tanh");
    const auto rows = static_cast<Eigen::Index>(layer.rows);
    layers_.push_back({.weights = Eigen::Map<const RowMajor>(layer.weights.data(), rows,
                                                             static_cast<Eigen::Index>(layer.columns)),
                       .biases = Eigen::Map<const Eigen::VectorXd>(layer.biases.data(), rows),
                       .has_tanh = layer.activation == policy::Activation::kTanh});
  }
}

const Eigen::MatrixXd& NetworkBatch::forward(const Eigen::MatrixXd& in) {
  activations_.assign(1, in);
  for (const BatchLayer& layer : layers_) {
    Eigen::MatrixXd out = (layer.weights * activations_.back()).colwise() + layer.biases;
    if (layer.has_tanh) out = out.unaryExpr([](double sum) { return std::tanh(sum); });
    activations_.push_back(std::move(out));
  }
  return activations_.back();
}

std::vector<LayerGradient> NetworkBatch::backward(const Eigen::MatrixXd& slopes) const {
  std::vector<LayerGradient> gradients(layers_.size());
  Eigen::MatrixXd back = slopes;
  for (std::size_t i = layers_.size(); i-- > 0;) {
    const Eigen::MatrixXd& out = activations_[i + 1];
    if (layers_[i].has_tanh) back = (back.array() * (1.0 - out.array().square())).matrix();
    const RowMajor weights = back * activations_[i].transpose();
    const Eigen::VectorXd biases = back.rowwise().sum();
    gradients[i].weights.assign(weights.data(), weights.data() + weights.size());
    gradients[i].biases.assign(biases.data(), biases.data() + biases.size());
    if (i > 0) back = layers_[i].weights.transpose() * back;
  }
  return gradients;
}

}  // namespace koboshi::lab
