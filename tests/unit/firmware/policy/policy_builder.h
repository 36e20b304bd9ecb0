#pragma once

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "firmware/policy/policy.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::test {

// Writes valid and invalid policy images in the format of docs/reference/policy.md.
struct PolicyBuilder {
  struct Layer {
    std::uint8_t rows = 0;
    std::size_t columns = 0;
    policy::Activation activation = policy::Activation::kLinear;
    std::uint8_t fraction_bits = policy::kMaxFractionBits;
    std::int32_t multiplier = 0;
    std::vector<std::int32_t> biases{};
    std::vector<std::int8_t> weights{};  // row by row

    std::int8_t weight(std::size_t row, std::size_t column) const { return weights[row * columns + column]; }
  };

  std::string name = "test";
  std::uint32_t model_id = 0;
  std::uint8_t patience_ticks = 3;
  std::vector<policy::Input> inputs{};
  std::vector<policy::Output> outputs{};
  std::vector<Layer> layers{};

  static void put_i32(std::vector<std::byte>& bytes, std::int32_t value) {
    put(bytes, static_cast<std::uint32_t>(value), 4);
  }

  std::vector<std::byte> image() const {
    std::vector<std::byte> bytes;
    put(bytes, policy::kPolicyMagic, 4);
    put(bytes, policy::kPolicyVersion, 4);
    bytes.resize(16);
    put(bytes, model_id, 4);
    for (std::size_t i = 0; i < policy::kPolicyNameSize; ++i)
      put(bytes, i < name.size() ? static_cast<unsigned char>(name[i]) : 0u, 1);
    put(bytes, static_cast<std::uint32_t>(inputs.size()), 1);
    put(bytes, static_cast<std::uint32_t>(outputs.size()), 1);
    put(bytes, static_cast<std::uint32_t>(layers.size()), 1);
    put(bytes, patience_ticks, 1);
    for (std::size_t i = 0; i < policy::padded(inputs.size()); ++i)
      put(bytes, i < inputs.size() ? inputs[i].signal : 0u, 1);
    for (const policy::Input& input : inputs) {
      for (const std::int32_t field : {input.mean, input.multiplier, input.low, input.high})
        put_i32(bytes, field);
    }
    for (const policy::Output& output : outputs) {
      for (const std::int32_t field :
           {std::int32_t{output.joint}, output.scale, output.bound.raw(), output.rate.raw()})
        put_i32(bytes, field);
    }
    for (const Layer& layer : layers) {
      put(bytes, layer.rows, 1);
      put(bytes, static_cast<std::uint32_t>(layer.activation), 1);
      put(bytes, layer.fraction_bits, 1);
      put(bytes, 0, 1);
      put_i32(bytes, layer.multiplier);
    }
    for (const Layer& layer : layers) {
      for (const std::int32_t bias : layer.biases) put_i32(bytes, bias);
      for (std::size_t row = 0; row < layer.rows; row += 4) {
        for (std::size_t column = 0; column < layer.columns; column += 2) {
          for (const std::size_t pair : {row, row + 2}) {
            for (const std::size_t c : {column, column + 1})
              put(bytes,
                  static_cast<std::uint16_t>(
                      policy::packed_weights(layer.weight(pair, c), layer.weight(pair + 1, c))),
                  2);
          }
        }
      }
    }
    seal(bytes);
    return bytes;
  }
};

// Leg joints of the test robot that a policy may move, by their roles.
inline std::vector<std::uint8_t> hips_and_ankles(const robot::RobotModel& model) {
  using enum robot::JointRole;
  std::vector<std::uint8_t> joints;
  for (const robot::JointRole role :
       {kLeftHipRoll, kLeftHipPitch, kLeftAnklePitch, kLeftAnkleRoll, kRightHipRoll, kRightHipPitch,
        kRightAnklePitch, kRightAnkleRoll, kLeftHipYaw, kRightHipYaw})
    joints.push_back(static_cast<std::uint8_t>(*model.find(role)));
  return joints;
}

inline policy::Output make_output(std::uint8_t joint) {
  return {.joint = joint, .scale = 4'000, .bound = degrees(8.0), .rate = degrees(0.5)};
}

// A network with random weights, whose activations stay within their range most of the time.
inline PolicyBuilder random_policy(std::mt19937& random, const robot::RobotModel& model, std::size_t inputs,
                                   std::vector<std::uint8_t> hidden, std::size_t outputs,
                                   policy::Activation activation) {
  const auto draw = [&](std::int32_t low, std::int32_t high) {
    return std::uniform_int_distribution<std::int32_t>(low, high)(random);
  };
  PolicyBuilder builder;
  builder.model_id = model.id;
  for (std::size_t i = 0; i < inputs; ++i)
    builder.inputs.push_back({.signal = static_cast<std::uint8_t>(draw(0, policy::kSignals - 1)),
                              .mean = draw(-100'000, 100'000),
                              .multiplier = draw(1 << 26, 1 << 28),
                              .low = -400'000,
                              .high = 400'000});
  const auto joints = hips_and_ankles(model);
  for (std::size_t i = 0; i < outputs; ++i) builder.outputs.push_back(make_output(joints[i]));
  hidden.push_back(static_cast<std::uint8_t>(policy::padded(outputs)));
  std::size_t columns = policy::padded(inputs);
  bool last_was_tanh = false;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    PolicyBuilder::Layer layer{.rows = hidden[i], .columns = columns};
    const bool last = i + 1 == hidden.size();
    layer.activation = last ? policy::Activation::kLinear : activation;
    for (std::size_t row = 0; row < layer.rows; ++row) layer.biases.push_back(draw(-200'000, 200'000));
    for (std::size_t w = 0; w < layer.rows * columns; ++w)
      layer.weights.push_back(static_cast<std::int8_t>(draw(-127, 127)));
    // The sum of n products of standard deviations 73 and a, divided by 2^10: about a, or 2^12 of 2^15.
    layer.multiplier = last_was_tanh ? 460'000 : 3'700'000;
    last_was_tanh = activation == policy::Activation::kTanh;
    columns = layer.rows;
    builder.layers.push_back(layer);
  }
  return builder;
}

}  // namespace koboshi::test
