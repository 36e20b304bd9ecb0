#include "lab/policy_search/mirrored_network.h"

#include <gtest/gtest.h>

#include "lab/learn/learning_study.h"
#include "sim_board/description/load.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

class NetworkOfAStudy : public testing::Test {
 protected:
  simulation::NamedModel robot_ =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
  tools::PolicyMap map_ =
      learned_map(read_learning_study(KOBOSHI_SOURCE_DIR "/studies/learn/residual.yaml"), robot_);

  MirroredNetwork network(const std::vector<std::size_t>& hidden) const {
    return {mirrored_inputs(map_, robot_), hidden, mirrored_outputs(map_, robot_), true};
  }
  std::size_t input(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(map_.inputs, name, &tools::MappedInput::name) -
                                    map_.inputs.begin());
  }
};

std::vector<double> image_of(const MirrorImage& mirror, const std::vector<double>& values) {
  std::vector<double> image;
  for (std::size_t i = 0; i < values.size(); ++i) image.push_back(mirror.sign[i] * values[mirror.place[i]]);
  return image;
}

TEST_F(NetworkOfAStudy, MirrorsInputsBySideAndSign) {
  const MirrorImage mirror = mirrored_inputs(map_, robot_);
  EXPECT_EQ(mirror.place[input("roll")], input("roll"));
  EXPECT_EQ(mirror.sign[input("roll")], -1.0);
  EXPECT_EQ(mirror.sign[input("pitch")], 1.0);
  EXPECT_EQ(mirror.sign[input("phase_cos")], -1.0) << "half a turn later";
  EXPECT_EQ(mirror.place[input("left_zmp_y")], input("right_zmp_y"));
  EXPECT_EQ(mirror.sign[input("left_zmp_y")], -1.0);
  EXPECT_EQ(mirror.sign[input("right_zmp_x")], 1.0);
}

TEST_F(NetworkOfAStudy, GivesMirroredOutputsForMirroredInputs) {
  for (const std::vector<std::size_t>& hidden :
       {std::vector<std::size_t>{}, std::vector<std::size_t>{6}, std::vector<std::size_t>{8, 4}}) {
    const MirroredNetwork network = this->network(hidden);
    sim_board::RandomStream random(5, "test");
    std::vector<double> parameters;
    for (std::size_t i = 0; i < network.parameters(); ++i) parameters.push_back(0.5 * random.normal());
    const tools::Mlp mlp = network.network(parameters);
    std::vector<double> signals;
    for (std::size_t i = 0; i < map_.inputs.size(); ++i) signals.push_back(random.normal());
    const std::vector<double> outputs = mlp.run(signals);
    const std::vector<double> expected = image_of(mirrored_outputs(map_, robot_), outputs);
    const std::vector<double> got = mlp.run(image_of(mirrored_inputs(map_, robot_), signals));
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], expected[i], 1e-12) << hidden.size();
    EXPECT_GT(std::abs(outputs[0] - outputs[1]), 1e-3) << "left and right differ";
  }
}

TEST_F(NetworkOfAStudy, HasHalfTheParametersOfAFreeOne) {
  const std::size_t in = map_.inputs.size();
  const std::size_t out = map_.outputs.size();
  const MirroredNetwork free(MirrorImage::none(in), {6}, MirrorImage::none(out), false);
  EXPECT_EQ(free.parameters(), 6 * (in + 1) + out * 7);
  EXPECT_EQ(2 * network({6}).parameters(), free.parameters());
}

TEST_F(NetworkOfAStudy, BeginsWithoutOffsets) {
  const MirroredNetwork network = this->network({8});
  const tools::Mlp mlp = network.network(network.start(1));
  for (const double output : mlp.run(std::vector<double>(map_.inputs.size(), 1.0))) EXPECT_EQ(output, 0.0);
  EXPECT_EQ(network.start(1), network.start(1));
  EXPECT_NE(network.start(1), network.start(2));
}

}  // namespace
}  // namespace koboshi::lab
