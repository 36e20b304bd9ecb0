#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/policy_search/network_batch.h"
#include "simulation/model/robot_model.h"
#include "tools/policy/mlp.h"
#include "tools/policy/policy_map.h"

namespace koboshi::lab {

// The place of each element of a vector in the mirror image of the robot: the image's element i is
// sign[i] * the element place[i].
struct MirrorImage {
  std::vector<std::size_t> place{};
  std::vector<double> sign{};

  // Every element stays as it is.
  [[nodiscard]] static MirrorImage none(std::size_t size);
};

// Mirror images of the inputs and outputs of a map, left and right exchanged. Requires a map with both sides
// of each (learned_map() with `mirror`).
[[nodiscard]] MirrorImage mirrored_inputs(const tools::PolicyMap& map, const simulation::NamedModel& robot);
[[nodiscard]] MirrorImage mirrored_outputs(const tools::PolicyMap& map, const simulation::NamedModel& robot);

// A multilayer perceptron with tanh in every layer, as a function of a vector of parameters. Its outputs for
// the mirror image of its inputs are the mirror images of its outputs: hidden neurons come in pairs, and a
// row of weights of one side is that of the other side with its columns exchanged (an equivariant network).
// That halves the parameters, and an episode teaches both sides.
class MirroredNetwork {
 public:
  // With MirrorImage::none() at both ends and `mirror` false, all weights are free.
  MirroredNetwork(MirrorImage inputs, const std::vector<std::size_t>& hidden, MirrorImage outputs,
                  bool mirror);

  [[nodiscard]] std::size_t parameters() const { return parameters_; }
  // Random hidden layers, and outputs that are zero: the robot begins with the engine alone.
  [[nodiscard]] std::vector<double> start(std::uint64_t seed) const;
  [[nodiscard]] tools::Mlp network(std::span<const double> parameters) const;
  // The gradient with respect to the parameters, from that with respect to all weights and biases.
  [[nodiscard]] std::vector<double> gradient(const std::vector<LayerGradient>& layers) const;

 private:
  std::vector<MirrorImage> images_;  // of the inputs, of each layer's rows
  std::size_t parameters_ = 0;
};

}  // namespace koboshi::lab
