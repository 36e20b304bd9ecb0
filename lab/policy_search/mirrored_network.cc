#include "lab/policy_search/mirrored_network.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

// Signals of the whole robot that change their sign in its mirror image. The phase is half a turn further,
// because the feet have exchanged their parts.
constexpr std::array<std::string_view, 10> kOppositeSignals{
    "roll",          "up_y",          "roll_rate", "yaw_rate",  "acceleration_y",
    "velocity_left", "velocity_turn", "phase_sin", "phase_cos", "swing"};

constexpr std::string_view kOutputPrefix = "output.";

std::string exchanged(const std::string& name) {
  if (name.starts_with(kOutputPrefix))
    return std::string(kOutputPrefix) + exchanged(name.substr(kOutputPrefix.size()));
  if (name.starts_with("left_")) return "right_" + name.substr(5);
  if (name.starts_with("right_")) return "left_" + name.substr(6);
  return name;
}

// 0 for a name that is no joint.
int joint_sign(const std::string& joint, const simulation::NamedModel& robot) {
  const auto found = std::ranges::find(robot.joint_names, joint);
  if (found == robot.joint_names.end()) return 0;
  return robot.model.joints[static_cast<std::size_t>(found - robot.joint_names.begin())].mirror_sign;
}

double signal_sign(const std::string& signal, const simulation::NamedModel& robot) {
  if (std::ranges::find(kOppositeSignals, signal) != kOppositeSignals.end()) return -1.0;
  if (signal.ends_with("_zmp_y")) return -1.0;
  const std::string joint = signal.starts_with(kOutputPrefix) ? signal.substr(kOutputPrefix.size())
                                                              : signal.substr(0, signal.rfind('.'));
  return joint_sign(joint, robot) < 0 ? -1.0 : 1.0;
}

std::size_t place_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw std::logic_error("a map without " + name);
  return static_cast<std::size_t>(found - names.begin());
}

template <typename Sign>
MirrorImage image_of(const std::vector<std::string>& names, const Sign& sign) {
  MirrorImage image;
  for (const std::string& name : names) {
    image.place.push_back(place_of(names, exchanged(name)));
    image.sign.push_back(sign(name));
  }
  return image;
}

// Neuron i of the first half has its counterpart in the second half.
MirrorImage halves(std::size_t size) {
  MirrorImage image{.place = {}, .sign = std::vector<double>(size, 1.0)};
  for (std::size_t i = 0; i < size; ++i) image.place.push_back((i + size / 2) % size);
  return image;
}

}  // namespace

MirrorImage MirrorImage::none(std::size_t size) {
  MirrorImage image{.place = {}, .sign = std::vector<double>(size, 1.0)};
  for (std::size_t i = 0; i < size; ++i) image.place.push_back(i);
  return image;
}

MirrorImage mirrored_inputs(const tools::PolicyMap& map, const simulation::NamedModel& robot) {
  std::vector<std::string> names;
  for (const tools::MappedInput& input : map.inputs) names.push_back(input.name);
  return image_of(names, [&](const std::string& name) { return signal_sign(name, robot); });
}

MirrorImage mirrored_outputs(const tools::PolicyMap& map, const simulation::NamedModel& robot) {
  std::vector<std::string> names;
  for (const tools::MappedOutput& output : map.outputs) names.push_back(output.joint);
  return image_of(names, [&](const std::string& name) { return joint_sign(name, robot) < 0 ? -1.0 : 1.0; });
}

MirroredNetwork::MirroredNetwork(MirrorImage inputs, const std::vector<std::size_t>& hidden,
                                 MirrorImage outputs, bool mirror) {
  images_.push_back(std::move(inputs));
  for (const std::size_t width : hidden) images_.push_back(mirror ? halves(width) : MirrorImage::none(width));
  images_.push_back(std::move(outputs));
  for (std::size_t layer = 1; layer < images_.size(); ++layer) {
    for (std::size_t row = 0; row < images_[layer].place.size(); ++row) {
      if (images_[layer].place[row] >= row) parameters_ += images_[layer - 1].place.size() + 1;
    }
  }
}

std::vector<double> MirroredNetwork::start(std::uint64_t seed) const {
  sim_board::RandomStream random(seed, "first weights");
  std::vector<double> parameters;
  for (std::size_t layer = 1; layer + 1 < images_.size(); ++layer) {
    const std::size_t columns = images_[layer - 1].place.size();
    for (std::size_t row = 0; row < images_[layer].place.size(); ++row) {
      if (images_[layer].place[row] < row) continue;
      for (std::size_t column = 0; column < columns; ++column)
        parameters.push_back(random.normal() / std::sqrt(static_cast<double>(columns)));
      parameters.push_back(0.0);
    }
  }
  parameters.resize(parameters_);
  return parameters;
}

tools::Mlp MirroredNetwork::network(std::span<const double> parameters) const {
  if (parameters.size() != parameters_) throw std::logic_error("a wrong number of parameters");
  tools::Mlp mlp;
  mlp.factor.assign(images_.front().place.size(), 1.0);
  mlp.offset.assign(images_.front().place.size(), 0.0);
  auto next = parameters.begin();
  for (std::size_t i = 1; i < images_.size(); ++i) {
    const MirrorImage& in = images_[i - 1];
    const MirrorImage& out = images_[i];
    tools::MlpLayer layer{
        .rows = out.place.size(), .columns = in.place.size(), .activation = policy::Activation::kTanh};
    layer.weights.resize(layer.rows * layer.columns);
    layer.biases.resize(layer.rows);
    for (std::size_t row = 0; row < layer.rows; ++row) {
      const std::size_t other = out.place[row];
      if (other < row) continue;
      for (std::size_t column = 0; column < layer.columns; ++column) {
        const double weight = *next++;
        layer.weights[row * layer.columns + column] = weight;
        if (other != row)
          layer.weights[other * layer.columns + in.place[column]] = out.sign[row] * in.sign[column] * weight;
      }
      layer.biases[row] = *next++;
      if (other != row) layer.biases[other] = out.sign[row] * layer.biases[row];
    }
    mlp.layers.push_back(std::move(layer));
  }
  return mlp;
}

std::vector<double> MirroredNetwork::gradient(const std::vector<LayerGradient>& layers) const {
  std::vector<double> gradient;
  for (std::size_t i = 1; i < images_.size(); ++i) {
    const MirrorImage& in = images_[i - 1];
    const MirrorImage& out = images_[i];
    const LayerGradient& layer = layers[i - 1];
    for (std::size_t row = 0; row < out.place.size(); ++row) {
      const std::size_t other = out.place[row];
      if (other < row) continue;
      for (std::size_t column = 0; column < in.place.size(); ++column) {
        double slope = layer.weights[row * in.place.size() + column];
        if (other != row)
          slope +=
              out.sign[row] * in.sign[column] * layer.weights[other * in.place.size() + in.place[column]];
        gradient.push_back(slope);
      }
      gradient.push_back(layer.biases[row] + (other == row ? 0.0 : out.sign[row] * layer.biases[other]));
    }
  }
  return gradient;
}

}  // namespace koboshi::lab
