#include "tools/policy/quantise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/text/error.h"
#include "firmware/policy/policy.h"
#include "sim_board/description/load.h"
#include "simulation/policy/signal_names.h"

namespace koboshi::tools {
namespace {

using policy::Activation;
using ::testing::HasSubstr;

constexpr double kDegree = 3.14159265358979 / 180.0;
constexpr const char* kSignals[] = {"roll",
                                    "pitch",
                                    "roll_rate",
                                    "pitch_rate",
                                    "velocity_forward",
                                    "left_load",
                                    "phase_sin",
                                    "left_ankle_roll.angle"};
// Standard deviations of a walk, in SI units.
constexpr double kSpread[] = {0.03, 0.03, 0.5, 0.5, 0.05, 5.0, 0.7, 0.1};

class Quantised : public ::testing::Test {
 protected:
  Quantised() {
    const auto names = simulation::signal_names(robot_.joint_names, {});
    for (const char* const name : kSignals) {
      const auto found = std::ranges::find(names, name, &simulation::SignalName::name);
      EXPECT_NE(found, names.end()) << name;
      map_.inputs.push_back({.name = name, .signal = found->signal, .unit = found->unit, .column = name});
    }
    map_.name = "quantised";
    for (const char* const joint : {"left_ankle_roll", "right_ankle_roll", "left_hip_pitch"}) {
      const auto found = std::ranges::find(robot_.joint_names, joint);
      map_.outputs.push_back({.joint = joint,
                              .index = static_cast<std::uint8_t>(found - robot_.joint_names.begin()),
                              .scale_rad = 0.05,
                              .bound_rad = 10.0 * kDegree,
                              .rate_rad_per_s = 1.0});
    }
    for (int row = 0; row < 400; ++row) {
      std::vector<double> values;
      for (const double spread : kSpread) values.push_back(spread * normal_(random_));
      rows_.push_back(values);
    }
  }

  Mlp network(std::vector<std::size_t> hidden, Activation activation, double clip = 5.0) {
    Mlp mlp;
    mlp.clip = clip;
    for (const double spread : kSpread) {
      mlp.factor.push_back(1.0 / spread);
      mlp.offset.push_back(0.1);
    }
    hidden.push_back(3);
    std::size_t columns = mlp.inputs();
    for (const std::size_t rows : hidden) {
      MlpLayer layer{.rows = rows, .columns = columns};
      for (std::size_t i = 0; i < rows * columns; ++i)
        layer.weights.push_back(normal_(random_) / std::sqrt(static_cast<double>(columns)));
      for (std::size_t i = 0; i < rows; ++i) layer.biases.push_back(0.1 * normal_(random_));
      layer.activation = activation;
      mlp.layers.push_back(layer);
      columns = rows;
    }
    mlp.layers.back().activation = Activation::kLinear;
    return mlp;
  }
  QuantisedPolicy quantise_it(const Mlp& mlp) { return quantise(mlp, map_, rows_, robot_, "net.onnx"); }
  std::string refusal(const Mlp& mlp) {
    try {
      quantise_it(mlp);
      return "none";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  std::mt19937 random_{20261128};
  std::normal_distribution<double> normal_;
  simulation::NamedModel robot_ =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
  PolicyMap map_;
  std::vector<std::vector<double>> rows_;
};

TEST_F(Quantised, IsNearTheNetwork) {
  for (const Activation activation :
       {Activation::kRelu, Activation::kElu, Activation::kTanh, Activation::kSilu}) {
    const QuantisedPolicy policy = quantise_it(network({64, 64}, activation));
    ASSERT_EQ(policy.errors.size(), 3u);
    for (const QuantisationError& error : policy.errors) {
      std::printf("function %d: largest %.4f deg, rms %.4f deg, of %.2f deg\n", static_cast<int>(activation),
                  error.largest_rad / kDegree, error.rms_rad / kDegree, error.range_rad / kDegree);
      EXPECT_GT(error.range_rad, 1.0 * kDegree);
      EXPECT_LT(error.rms_rad, 0.01 * error.range_rad);
      EXPECT_LT(error.largest_rad, 0.05 * error.range_rad);
      EXPECT_GT(error.rms_rad, 1e-5 * error.range_rad) << "suspiciously good";
    }
    policy::Policy opened;
    ASSERT_TRUE(policy::Policy::open(policy.image, robot_.model, opened).ok());
    EXPECT_EQ(opened.name(), "quantised");
    EXPECT_EQ(opened.work(), policy.work);
    EXPECT_EQ(policy.weights, 8u * 64 + 64 * 64 + 64 * 8);
  }
}

// The firmware's clip is the saturation of an input's activation.
TEST_F(Quantised, ClipsAsTheNetworkDoes) {
  const Mlp narrow = network({16}, Activation::kTanh, 1.5);
  for (const QuantisationError& error : quantise_it(narrow).errors)
    EXPECT_LT(error.largest_rad, 0.05 * error.range_rad);
  Mlp without = narrow;
  without.clip = std::numeric_limits<double>::infinity();
  double difference = 0.0;
  for (const auto& row : rows_)
    difference = std::max(difference, std::abs(narrow.run(row)[0] - without.run(row)[0]));
  EXPECT_GT(difference, 0.1) << "the clip must matter";
}

TEST_F(Quantised, HasTheRangesOfTheRecording) {
  map_.inputs[1].range = {-0.2, 0.3};
  const QuantisedPolicy result = quantise_it(network({16}, Activation::kElu));
  policy::Policy policy;
  ASSERT_TRUE(policy::Policy::open(result.image, robot_.model, policy).ok());
  double lowest = rows_[0][0];
  double highest = rows_[0][0];
  for (const auto& row : rows_) {
    lowest = std::min(lowest, row[0]);
    highest = std::max(highest, row[0]);
  }
  const double margin = 0.1 * (highest - lowest);
  EXPECT_NEAR(policy.input(0).low * map_.inputs[0].unit, lowest - margin, 1e-6);
  EXPECT_NEAR(policy.input(0).high * map_.inputs[0].unit, highest + margin, 1e-6);
  EXPECT_NEAR(policy.input(1).low * map_.inputs[1].unit, -0.2, 1e-6);
  EXPECT_NEAR(policy.input(1).high * map_.inputs[1].unit, 0.3, 1e-6);
}

TEST_F(Quantised, TellsWhenOutputsExceedTheirBounds) {
  const Mlp mlp = network({16}, Activation::kElu);
  EXPECT_EQ(quantise_it(mlp).clamped_rows, 0u);
  map_.outputs[0].bound_rad = 0.5 * kDegree;
  EXPECT_GT(quantise_it(mlp).clamped_rows, 10u);
}

TEST_F(Quantised, RefusesWhatTheFirmwareCannotRun) {
  EXPECT_THAT(refusal(network({128, 120}, Activation::kElu)), HasSubstr("more instructions than a tick"));
  EXPECT_THAT(refusal(network({130}, Activation::kElu)), HasSubstr("net.onnx: found a layer of 130 times 8"));
  EXPECT_THAT(refusal(network({8, 8, 8, 8}, Activation::kElu)),
              HasSubstr("found 5 layers, expected at most 4"));
  EXPECT_THAT(refusal(network({8}, Activation::kElu, 0.3)), HasSubstr("clip of roll at"));
  map_.outputs.pop_back();
  EXPECT_THAT(refusal(network({8}, Activation::kElu)), HasSubstr("found 3 outputs of the network"));
  map_.inputs.pop_back();
  EXPECT_THAT(refusal(network({8}, Activation::kElu)), HasSubstr("found 8 inputs of the network"));
}

}  // namespace
}  // namespace koboshi::tools
