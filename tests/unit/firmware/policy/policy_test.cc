#include "firmware/policy/policy.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/firmware/policy/policy_builder.h"

namespace koboshi::policy {
namespace {

using test::PolicyBuilder;

class PolicyImage : public ::testing::Test {
 protected:
  PolicyImage() {
    model_.id = 0x1234'5678;
    std::mt19937 random(7);
    builder_ = test::random_policy(random, model_, 6, {8, 16}, 3, Activation::kElu);
  }

  PolicyVerdict open(const std::vector<std::byte>& image) { return Policy::open(image, model_, policy_); }
  PolicyVerdict open() {
    image_ = builder_.image();
    return open(image_);
  }

  robot::RobotModel model_ = test::make_test_robot();
  PolicyBuilder builder_;
  std::vector<std::byte> image_;  // of the policy
  Policy policy_;
};

TEST_F(PolicyImage, OpensWithItsContents) {
  const std::vector<std::byte> image = builder_.image();
  ASSERT_TRUE(open(image).ok());
  EXPECT_EQ(policy_.name(), "test");
  EXPECT_EQ(policy_.image_size_bytes(), image.size());
  EXPECT_EQ(policy_.input_count(), 6u);
  EXPECT_EQ(policy_.output_count(), 3u);
  EXPECT_EQ(policy_.layer_count(), 3u);
  EXPECT_EQ(policy_.patience_ticks(), 3);
  EXPECT_EQ(policy_.input(5).low, -400'000);
  EXPECT_EQ(policy_.input(5).mean, builder_.inputs[5].mean);
  EXPECT_EQ(policy_.output(2).bound, test::degrees(8.0));
  EXPECT_EQ(policy_.layer(0).columns, 8u);
  EXPECT_EQ(policy_.layer(1).columns, 8u);
  EXPECT_EQ(policy_.layer(1).rows, 16u);
  EXPECT_EQ(policy_.layer(2).rows, 8u);
  EXPECT_GT(policy_.work(), Work::kFixed);
}

TEST_F(PolicyImage, MovesToAnotherAddress) {
  const std::vector<std::byte> image = builder_.image();
  ASSERT_TRUE(open(image).ok());
  Activations a{{100, -200, 300, -400, 500, -600}};
  Activations b;
  Activations c = a;
  const Activations first = policy_.run(a, b);
  const std::vector<std::byte> moved = image;
  policy_.move_to(moved.data());
  EXPECT_EQ(policy_.run(c, b).values, first.values);
}

TEST_F(PolicyImage, OfAnotherRobotIsRefused) {
  ++builder_.model_id;
  EXPECT_EQ(open().status, PolicyStatus::kOtherRobot);
}

TEST_F(PolicyImage, AtAnOddAddressIsRefused) {
  std::vector<std::byte> image = builder_.image();
  image.insert(image.begin(), std::byte{0});
  EXPECT_EQ(Policy::open(std::span(image).subspan(1), model_, policy_).status, PolicyStatus::kMisaligned);
}

TEST_F(PolicyImage, ThatIsDamagedIsRefused) {
  std::vector<std::byte> image = builder_.image();
  EXPECT_EQ(open(std::vector<std::byte>(image.begin(), image.end() - 1)).status, PolicyStatus::kTruncated);
  image[200] ^= std::byte{4};
  EXPECT_EQ(open(image).status, PolicyStatus::kBadCrc);
  image[4] = std::byte{2};
  EXPECT_EQ(open(image).status, PolicyStatus::kBadVersion);
  image[0] = std::byte{0};
  EXPECT_EQ(open(image).status, PolicyStatus::kBadMagic);
  EXPECT_EQ(policy_.input_count(), 0u) << "a refused image has changed the policy";
}

TEST_F(PolicyImage, WithBytesTooFewOrTooManyIsRefused) {
  std::vector<std::byte> image = builder_.image();
  image.resize(image.size() + 4);
  test::seal(image);
  EXPECT_EQ(open(image).status, PolicyStatus::kBadSize);
  for (std::size_t size = image.size() - 8; size >= 16; size -= 4) {
    image.resize(size);
    test::seal(image);
    const PolicyVerdict verdict = open(image);
    ASSERT_EQ(verdict.status, PolicyStatus::kBadSize) << size;
  }
}

struct Refusal {
  const char* what;
  std::function<void(PolicyBuilder&)> change;
  PolicyStatus status;
  std::uint16_t index;
};

TEST_F(PolicyImage, WithAFieldOutOfRangeIsRefused) {
  using enum PolicyStatus;
  const Refusal refusals[] = {
      {"no name", [](auto& p) { p.name = ""; }, kBadName, 0},
      {"name", [](auto& p) { p.name = "a\nb"; }, kBadName, 0},
      {"no patience", [](auto& p) { p.patience_ticks = 0; }, kBadCount, 0},
      {"patience", [](auto& p) { p.patience_ticks = 101; }, kBadCount, 0},
      {"no inputs", [](auto& p) { p.inputs.clear(); }, kBadCount, 0},
      {"no outputs", [](auto& p) { p.outputs.clear(); }, kBadCount, 0},
      {"no layers", [](auto& p) { p.layers.clear(); }, kBadCount, 0},
      {"layers", [](auto& p) { p.layers.resize(5, p.layers[0]); }, kBadCount, 0},
      {"signal", [](auto& p) { p.inputs[2].signal = kSignals; }, kBadInput, 2},
      {"mean", [](auto& p) { p.inputs[1].mean = kMaxSignal + 1; }, kBadInput, 1},
      {"low", [](auto& p) { p.inputs[1].low = -kMaxSignal - 1; }, kBadInput, 1},
      {"high", [](auto& p) { p.inputs[1].high = kMaxSignal + 1; }, kBadInput, 1},
      {"range", [](auto& p) { p.inputs[5].high = p.inputs[5].low - 1; }, kBadInput, 5},
      {"joint", [](auto& p) { p.outputs[1].joint = 20; }, kBadOutput, 1},
      {"knee", [](auto& p) { p.outputs[1].joint = test::kKnee; }, kBadOutput, 1},
      {"head", [](auto& p) { p.outputs[1].joint = test::kHeadTilt; }, kBadOutput, 1},
      {"joint twice", [](auto& p) { p.outputs[2].joint = p.outputs[0].joint; }, kBadOutput, 2},
      {"scale", [](auto& p) { p.outputs[0].scale = kMaxScale + 1; }, kBadOutput, 0},
      {"scale below", [](auto& p) { p.outputs[0].scale = -kMaxScale - 1; }, kBadOutput, 0},
      {"no bound", [](auto& p) { p.outputs[0].bound = {}; }, kBadOutput, 0},
      {"bound", [](auto& p) { p.outputs[0].bound = test::degrees(15.01); }, kBadOutput, 0},
      {"negative bound", [](auto& p) { p.outputs[0].bound = test::degrees(-1.0); }, kBadOutput, 0},
      {"no rate", [](auto& p) { p.outputs[0].rate = {}; }, kBadOutput, 0},
      {"rate beyond the servo", [](auto& p) { p.outputs[0].rate = test::degrees(20.0); }, kBadOutput, 0},
      {"no rows", [](auto& p) { p.layers[1].rows = 0; }, kBadLayer, 1},
      {"rows", [](auto& p) { p.layers[1].rows = 12; }, kBadLayer, 1},
      {"rows of the last", [](auto& p) { p.layers[2].rows = 16; }, kBadLayer, 2},
      {"function", [](auto& p) { p.layers[0].activation = static_cast<Activation>(5); }, kBadLayer, 0},
      {"bits", [](auto& p) { p.layers[0].fraction_bits = 13; }, kBadLayer, 0},
      {"bits below", [](auto& p) { p.layers[0].fraction_bits = 7; }, kBadLayer, 0},
      {"multiplier", [](auto& p) { p.layers[0].multiplier = -1; }, kBadLayer, 0},
      {"bias", [](auto& p) { p.layers[1].biases[3] = kMaxBias; }, kBadBias, 1},
      {"bias below", [](auto& p) { p.layers[1].biases[3] = -kMaxBias; }, kBadBias, 1},
  };
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(refusal.what);
    PolicyBuilder changed = builder_;
    refusal.change(changed);
    for (auto& layer : changed.layers) {  // the builder needs whole layers
      layer.weights.resize((layer.rows + 4u) * layer.columns);
      layer.biases.resize(layer.rows);
    }
    const std::vector<std::byte> image = changed.image();
    const PolicyVerdict verdict = open(image);
    EXPECT_EQ(verdict.status, refusal.status);
    EXPECT_EQ(verdict.index, refusal.index);
  }
}

TEST_F(PolicyImage, WithMoreWorkThanATickHasRoomForIsRefused) {
  std::mt19937 random(1);
  builder_ = test::random_policy(random, model_, 96, {104, 104}, 8, Activation::kTanh);
  EXPECT_EQ(open().status, PolicyStatus::kTooMuchWork);
}

// On this robot of 20 joints.
TEST_F(PolicyImage, HasRoomForSevenThousandWeights) {
  struct Row {
    Activation activation;
    std::uint8_t first;
    std::uint8_t second;
    std::size_t weights;
  };
  for (const Row& row : {Row{Activation::kRelu, 88, 40, 7'360}, Row{Activation::kTanh, 80, 40, 6'720},
                         Row{Activation::kElu, 72, 40, 6'080}, Row{Activation::kSilu, 72, 40, 6'080}}) {
    std::mt19937 random(1);
    builder_ = test::random_policy(random, model_, 40, {row.first, row.second}, 8, row.activation);
    const PolicyVerdict verdict = open();
    EXPECT_TRUE(verdict.ok()) << static_cast<int>(verdict.status);
    std::size_t weights = 0;
    for (std::size_t i = 0; i < policy_.layer_count(); ++i)
      weights += policy_.layer(i).rows * policy_.layer(i).columns;
    EXPECT_EQ(weights, row.weights);
    std::printf("%zu weights: %u instructions at most\n", weights, policy_.work());
  }
}

TEST_F(PolicyImage, NormalisesClampsAndReportsInputs) {
  builder_.inputs = {{.signal = 0, .mean = 1'000, .multiplier = 1 << 30, .low = -8'000, .high = 9'000},
                     {.signal = 1, .mean = 0, .multiplier = -(1 << 28), .low = -4'000, .high = 4'000}};
  builder_.layers[0].weights.resize(8 * 8);
  ASSERT_TRUE(open().ok());
  Signals::Values signals{};
  Activations in;
  in.values.fill(77);
  signals[0] = 5'000;
  signals[1] = -1'600;
  EXPECT_EQ(policy_.normalise(signals, in), 2u);
  EXPECT_EQ(in.values[0], 1'000);
  EXPECT_EQ(in.values[1], 100);
  EXPECT_EQ(in.values[2], 0);
  EXPECT_EQ(in.values[3], 0);
  signals[1] = 4'001;
  EXPECT_EQ(policy_.normalise(signals, in), 1u);
  EXPECT_EQ(in.values[1], -250);
  signals[0] = -kMaxSignal;
  EXPECT_EQ(policy_.normalise(signals, in), 0u);
  EXPECT_EQ(in.values[0], -2'250);
}

}  // namespace
}  // namespace koboshi::policy
