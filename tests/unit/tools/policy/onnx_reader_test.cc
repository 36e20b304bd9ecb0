#include "tools/policy/onnx_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;
using Floats = std::vector<float>;

// Writes graphs as exporters do.
class OnnxFile : public ::testing::Test {
 protected:
  OnnxFile() {
    model_.set_ir_version(8);
    model_.mutable_graph()->add_input()->set_name("obs");
    model_.mutable_graph()->add_output()->set_name("actions");
  }

  void constant(const std::string& name, const Floats& values, const std::vector<int>& shape,
                bool raw = true) {
    fill(*model_.mutable_graph()->add_initializer(), values, shape, raw);
    model_.mutable_graph()->mutable_initializer()->rbegin()->set_name(name);
  }
  static void fill(onnx::TensorProto& tensor, const Floats& values, const std::vector<int>& shape, bool raw) {
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    for (const int size : shape) tensor.add_dims(size);
    if (raw) tensor.set_raw_data(values.data(), values.size() * sizeof(float));
    if (!raw) tensor.mutable_float_data()->Add(values.begin(), values.end());
  }
  void integers(const std::string& name, const std::vector<std::int64_t>& values) {
    auto& tensor = *model_.mutable_graph()->add_initializer();
    tensor.set_name(name);
    tensor.set_data_type(onnx::TensorProto::INT64);
    tensor.add_dims(static_cast<std::int64_t>(values.size()));
    tensor.mutable_int64_data()->Add(values.begin(), values.end());
  }
  onnx::NodeProto& node(const std::string& kind, const std::vector<std::string>& in,
                        const std::vector<std::string>& out) {
    auto& made = *model_.mutable_graph()->add_node();
    made.set_op_type(kind);
    for (const std::string& name : in) made.add_input(name);
    for (const std::string& name : out) made.add_output(name);
    return made;
  }
  static void set(onnx::NodeProto& node, const std::string& name, std::int64_t value) {
    auto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INT);
    attribute.set_i(value);
  }
  Floats random_floats(std::size_t count) {
    std::normal_distribution<float> normal;
    Floats values(count);
    for (float& value : values) value = normal(random_);
    return values;
  }
  Mlp read(const std::string& output = {}) {
    const auto path = folder_.path / "net.onnx";
    std::ofstream(path, std::ios::binary) << model_.SerializeAsString();
    return read_onnx(path, output);
  }
  std::string refusal() {
    try {
      read();
      return "none";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  std::mt19937 random_{3};
  onnx::ModelProto model_;
  test::TemporaryFolder folder_;
};

// A policy as rsl_rl exports it: Gemm with transB, Elu.
TEST_F(OnnxFile, OfGemmAndEluIsRead) {
  const Floats w0 = random_floats(4 * 3);
  const Floats b0 = random_floats(4);
  const Floats w1 = random_floats(2 * 4);
  const Floats b1 = random_floats(2);
  constant("w0", w0, {4, 3});
  constant("b0", b0, {4}, false);
  constant("w1", w1, {2, 4});
  constant("b1", b1, {2});
  set(node("Gemm", {"obs", "w0", "b0"}, {"h"}), "transB", 1);
  node("Elu", {"h"}, {"a"});
  set(node("Gemm", {"a", "w1", "b1"}, {"actions"}), "transB", 1);
  const Mlp mlp = read();
  const std::vector<double> in{0.3, -1.2, 0.8};
  const std::vector<double> out = mlp.run(in);
  std::vector<double> hidden(4);
  for (std::size_t r = 0; r < 4; ++r) {
    hidden[r] = b0[r];
    for (std::size_t c = 0; c < 3; ++c) hidden[r] += double{w0[r * 3 + c]} * in[c];
    if (hidden[r] < 0.0) hidden[r] = std::expm1(hidden[r]);
  }
  ASSERT_EQ(out.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r) {
    double expected = b1[r];
    for (std::size_t c = 0; c < 4; ++c) expected += double{w1[r * 4 + c]} * hidden[c];
    EXPECT_NEAR(out[r], expected, 1e-9);
  }
}

// A policy with a normaliser, MatMul and Add, SiLU, and the mean as a part of the result; the deviation's
// branch has nodes that the firmware does not compute.
TEST_F(OnnxFile, OfNormaliserSiluAndSplitIsRead) {
  const Floats mean{0.1F, -0.2F};
  const Floats deviation{2.0F, 0.5F};
  const Floats w0 = random_floats(2 * 3);
  const Floats b0 = random_floats(3);
  const Floats w1 = random_floats(3 * 4);
  constant("mean", mean, {1, 2});
  constant("deviation", deviation, {2});
  constant("low", {-1.5F}, {});
  constant("high", {1.5F}, {});
  constant("w0", w0, {2, 3});
  constant("b0", b0, {3});
  constant("w1", w1, {3, 4});
  integers("sizes", {2, 2});
  node("Sub", {"obs", "mean"}, {"n0"});
  node("Div", {"n0", "deviation"}, {"n1"});
  node("Clip", {"n1", "low", "high"}, {"n2"});
  node("MatMul", {"n2", "w0"}, {"m"});
  node("Add", {"b0", "m"}, {"z"});
  node("Sigmoid", {"z"}, {"s"});
  node("Mul", {"z", "s"}, {"a"});
  node("MatMul", {"a", "w1"}, {"both"});
  set(node("Split", {"both", "sizes"}, {"actions", "log_deviation"}), "axis", -1);
  node("Exp", {"log_deviation"}, {"spread"});
  const Mlp mlp = read();
  const std::vector<double> in{0.7, -3.0};
  std::vector<double> hidden(3);
  for (std::size_t r = 0; r < 3; ++r) {
    hidden[r] = b0[r];
    for (std::size_t c = 0; c < 2; ++c)
      hidden[r] +=
          double{w0[c * 3 + r]} * std::clamp((in[c] - double{mean[c]}) / double{deviation[c]}, -1.5, 1.5);
    hidden[r] /= 1.0 + std::exp(-hidden[r]);
  }
  const std::vector<double> out = mlp.run(in);
  ASSERT_EQ(out.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r) {
    double expected = 0.0;
    for (std::size_t c = 0; c < 3; ++c) expected += double{w1[c * 4 + r]} * hidden[c];
    EXPECT_NEAR(out[r], expected, 1e-6);  // the deviations are of single precision
  }
}

TEST_F(OnnxFile, OfASliceIsRead) {
  const Floats w = random_floats(4 * 2);
  constant("w", w, {4, 2});
  integers("starts", {1});
  integers("ends", {-1});
  integers("axes", {1});
  set(node("Gemm", {"obs", "w"}, {"z"}), "transB", 1);
  node("Slice", {"z", "starts", "ends", "axes"}, {"actions"});
  const Mlp mlp = read();
  EXPECT_EQ(mlp.outputs(), 2u);
  EXPECT_NEAR(mlp.run(std::vector<double>{1.0, 0.0})[0], w[2], 1e-9);
}

TEST_F(OnnxFile, MayHaveSeveralOutputs) {
  model_.mutable_graph()->add_output()->set_name("value");
  constant("w", {1.0F, 2.0F}, {2, 1});
  constant("v", {3.0F}, {1, 1});
  node("MatMul", {"obs", "v"}, {"value"});
  set(node("Gemm", {"obs", "w"}, {"actions"}), "transB", 1);
  EXPECT_EQ(read().outputs(), 2u);
  EXPECT_EQ(read("value").outputs(), 1u);
  EXPECT_THROW(static_cast<void>(read("none")), InputError);
}

TEST_F(OnnxFile, NamesTheNodeThatTheFirmwareDoesNotCompute) {
  constant("w", {1.0F, 2.0F}, {2, 1});
  set(node("Gemm", {"obs", "w"}, {"z"}), "transB", 1);
  auto& recurrent = node("LSTM", {"z"}, {"actions"});
  recurrent.set_name("/memory/LSTM");
  EXPECT_THAT(refusal(), HasSubstr("node /memory/LSTM (LSTM): a node that the firmware does not compute"));
  recurrent.set_op_type("Softmax");
  recurrent.set_name("");
  EXPECT_THAT(refusal(), HasSubstr("node actions (Softmax)"));
}

TEST_F(OnnxFile, NamesNodesInWrongPlaces) {
  constant("w", {1.0F, 2.0F}, {2, 1});
  constant("zero", {0.0F}, {});
  set(node("Gemm", {"obs", "w"}, {"z"}), "transB", 1);
  auto& last = node("Sigmoid", {"z"}, {"actions"});
  EXPECT_THAT(refusal(), HasSubstr("not the output actions"));
  last.set_op_type("Div");
  last.add_input("zero");
  EXPECT_THAT(refusal(), HasSubstr("node actions (Div): a division by zero"));
  last.set_op_type("Mul");
  last.set_input(1, "z");
  EXPECT_THAT(refusal(), HasSubstr("node actions (Mul)"));
  last.set_op_type("Clip");
  last.set_input(1, "");
  EXPECT_THAT(refusal(), HasSubstr("one bound"));
  last.set_op_type("Add");
  last.set_input(1, "obs");
  EXPECT_THAT(refusal(), HasSubstr("other operands than the value and a constant"));
}

TEST_F(OnnxFile, IsRefusedWhenItsTensorsDoNotFit) {
  constant("w", {1.0F, 2.0F}, {2, 2});
  node("MatMul", {"obs", "w"}, {"actions"});
  EXPECT_THAT(refusal(), HasSubstr("tensor w: other data than its shape says"));
  model_.mutable_graph()->mutable_initializer(0)->set_dims(1, 1);
  EXPECT_EQ(read().inputs(), 2u);
  model_.mutable_graph()->mutable_initializer(0)->set_data_type(onnx::TensorProto::BFLOAT16);
  EXPECT_THAT(refusal(), HasSubstr("tensor w: data type 16"));
  model_.mutable_graph()->mutable_initializer(0)->set_data_location(onnx::TensorProto::EXTERNAL);
  EXPECT_THAT(refusal(), HasSubstr("data in another file"));
}

TEST_F(OnnxFile, MustBeAModel) {
  const auto path = folder_.path / "net.onnx";
  for (const char* const text : {"", "not a model", "\x08"}) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
    EXPECT_THROW(static_cast<void>(read_onnx(path)), InputError) << text;
  }
}

// Truncated and changed files are refused, or read as another network.
TEST_F(OnnxFile, DoesNotCrashOnMutations) {
  constant("w0", random_floats(12), {4, 3});
  constant("w1", random_floats(8), {4, 2});
  set(node("Gemm", {"obs", "w0"}, {"z"}), "transB", 1);
  node("Tanh", {"z"}, {"a"});
  node("MatMul", {"a", "w1"}, {"actions"});
  const std::string whole = model_.SerializeAsString();
  const auto path = folder_.path / "net.onnx";
  int read = 0;
  for (int i = 0; i < 2'000; ++i) {
    std::string bytes = whole;
    for (auto k = 1 + random_() % 3; k > 0; --k)
      bytes[random_() % bytes.size()] = static_cast<char>(random_());
    if (i % 10 == 0) bytes.resize(random_() % bytes.size());
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    try {
      const Mlp mlp = read_onnx(path);
      const std::vector<double> out = mlp.run(std::vector<double>(mlp.inputs(), 0.1));
      EXPECT_EQ(out.size(), mlp.outputs());
      ++read;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_LT(read, 1'900);
}

}  // namespace
}  // namespace koboshi::tools
