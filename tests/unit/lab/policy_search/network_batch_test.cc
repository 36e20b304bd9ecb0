#include "lab/policy_search/network_batch.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "lab/policy_search/mirrored_network.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

constexpr double kStep = 1e-6;

// Three inputs, of which the first two are mirror images of each other; outputs likewise.
MirroredNetwork mirrored() {
  return {MirrorImage{.place = {1, 0, 2}, .sign = {1.0, 1.0, -1.0}},
          {4},
          MirrorImage{.place = {1, 0}, .sign = {-1.0, -1.0}},
          true};
}

class Gradients : public testing::Test {
 protected:
  std::vector<double> random_numbers(std::size_t count) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(random_.normal());
    return numbers;
  }
  Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::Map<const Eigen::MatrixXd>(random_numbers(static_cast<std::size_t>(rows * columns)).data(),
                                             rows, columns);
  }

  sim_board::RandomStream random_{3, "test"};
};

TEST_F(Gradients, ForwardIsThatOfTheNetwork) {
  const MirroredNetwork network = mirrored();
  const tools::Mlp mlp = network.network(random_numbers(network.parameters()));
  const Eigen::MatrixXd in = random_matrix(3, 5);
  NetworkBatch batch(mlp);
  const Eigen::MatrixXd out = batch.forward(in);
  ASSERT_EQ(out.rows(), 2);
  for (Eigen::Index column = 0; column < in.cols(); ++column) {
    const std::vector<double> expected = mlp.run({in.col(column).data(), 3});
    for (Eigen::Index row = 0; row < 2; ++row)
      EXPECT_NEAR(out(row, column), expected[static_cast<std::size_t>(row)], 1e-14);
  }
}

// The slopes of sum(weights * outputs) by differences, with a linear and with a mirrored network.
TEST_F(Gradients, BackwardIsTheSlopeOfTheOutputs) {
  const MirroredNetwork free(MirrorImage::none(3), {5, 4}, MirrorImage::none(2), false);
  for (const MirroredNetwork& network : {mirrored(), free}) {
    for (const auto last : {policy::Activation::kTanh, policy::Activation::kLinear}) {
      std::vector<double> parameters = random_numbers(network.parameters());
      const Eigen::MatrixXd in = random_matrix(3, 7);
      const Eigen::MatrixXd slopes = random_matrix(2, 7);
      const auto with_last = [&](const std::vector<double>& all) {
        tools::Mlp mlp = network.network(all);
        mlp.layers.back().activation = last;
        return mlp;
      };
      const auto value = [&](const std::vector<double>& all) {
        return NetworkBatch(with_last(all)).forward(in).cwiseProduct(slopes).sum();
      };
      NetworkBatch batch(with_last(parameters));
      batch.forward(in);
      const std::vector<double> gradient = network.gradient(batch.backward(slopes));
      ASSERT_EQ(gradient.size(), parameters.size());
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        const double kept = parameters[i];
        parameters[i] = kept + kStep;
        const double above = value(parameters);
        parameters[i] = kept - kStep;
        const double below = value(parameters);
        parameters[i] = kept;
        EXPECT_NEAR(gradient[i], (above - below) / (2.0 * kStep), 1e-7) << i;
      }
    }
  }
}

TEST_F(Gradients, RefuseOtherFunctions) {
  tools::Mlp mlp = mirrored().network(random_numbers(mirrored().parameters()));
  mlp.layers.front().activation = policy::Activation::kRelu;
  EXPECT_THROW(NetworkBatch{mlp}, std::logic_error);
}

}  // namespace
}  // namespace koboshi::lab
