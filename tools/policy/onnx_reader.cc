#include "tools/policy/onnx_reader.h"

#include <fmt/format.h>
#include <onnx/onnx_pb.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "tools/policy/mlp_builder.h"

namespace koboshi::tools {
namespace {

constexpr const char* kExpectedNodes =
    "Gemm, MatMul, Add, Sub, Mul, Div, Clip, Relu, Elu, Tanh, Sigmoid, Slice, Split, Constant or Identity";
constexpr std::int64_t kMaxElements = 1 << 20;  // of a tensor

struct Tensor {
  std::vector<std::int64_t> shape{};
  std::vector<double> values{};
};

// Reads one graph.
class OnnxGraph {
 public:
  OnnxGraph(const std::filesystem::path& file, const onnx::GraphProto& graph) : file_(file), graph_(graph) {}

  Mlp read(const std::string& output);

 private:
  using Node = onnx::NodeProto;
  struct Part {
    std::size_t begin = 0;
    std::size_t end = 0;
  };

  [[noreturn]] void fail(const Node& node, const std::string& found,
                         const std::string& expected = "a multilayer perceptron") const {
    const std::string name = node.name().empty() ? node.output(0) : node.name();
    throw InputError(file_, 0, fmt::format("node {} ({}): {}", name, node.op_type(), found), expected);
  }
  void require(const Node& node, const std::string& fault) const {
    if (!fault.empty()) fail(node, fault);
  }
  Tensor tensor_of(const onnx::TensorProto& proto, const std::string& name) const;
  const Tensor* constant(const std::string& name) const {
    const auto found = constants_.find(name);
    return found == constants_.end() ? nullptr : &found->second;
  }
  const onnx::AttributeProto* attribute(const Node& node, std::string_view name) const {
    for (const auto& each : node.attribute()) {
      if (each.name() == name) return &each;
    }
    return nullptr;
  }
  std::set<const Node*> needed_for(const std::string& output) const;
  std::string find_input() const;
  // Whether the name is that of the present value; takes the part of a split that it names.
  bool is_value(const Node& node, const std::string& name);
  // The operand of a node that is constant; the other one must be the present value.
  const Tensor& operand(const Node& node, bool& value_is_first);
  std::vector<std::int64_t> integers(const Node& node, std::string_view name, int input) const;
  void set_value(const Node& node) { value_ = node.output(0); }

  void read_node(const Node& node);
  void read_constant(const Node& node);
  void read_gemm(const Node& node);
  void read_matmul(const Node& node);
  void read_arithmetic(const Node& node);
  void read_clip(const Node& node);
  void read_elu(const Node& node);
  void read_slice(const Node& node);
  void read_split(const Node& node);
  bool read_silu(const Node& node);
  void multiply(const Node& node, const Tensor& weights, bool transposed, double factor);
  void scale(const Node& node, std::vector<double> factor, std::vector<double> offset) {
    require(node, builder_.scale(factor, offset));
  }

  const std::filesystem::path& file_;
  const onnx::GraphProto& graph_;
  std::map<std::string, Tensor> constants_;
  MlpBuilder builder_;
  std::string value_;                  // name of the present value
  std::string sigmoid_;                // name of its sigmoid, if a node has made it
  std::map<std::string, Part> parts_;  // of the present value, by the outputs of a Split
};

std::size_t count_of(const std::vector<std::int64_t>& shape) {
  std::int64_t count = 1;
  for (const std::int64_t size : shape) {
    if (size < 0 || size > kMaxElements) return std::numeric_limits<std::size_t>::max();
    count *= size;
    if (count > kMaxElements) return std::numeric_limits<std::size_t>::max();
  }
  return static_cast<std::size_t>(count);
}

template <typename Number>
void append_raw(std::string_view raw, std::vector<double>& values) {
  for (std::size_t at = 0; at + sizeof(Number) <= raw.size(); at += sizeof(Number)) {
    Number number{};
    std::memcpy(&number, raw.data() + at, sizeof(Number));  // little-endian, as this machine is
    values.push_back(static_cast<double>(number));
  }
}

Tensor OnnxGraph::tensor_of(const onnx::TensorProto& proto, const std::string& name) const {
  using Proto = onnx::TensorProto;
  Tensor tensor;
  tensor.shape.assign(proto.dims().begin(), proto.dims().end());
  const auto refuse = [&](const std::string& found) {
    throw InputError(file_, 0, fmt::format("tensor {}: {}", name, found), "numbers within the file");
  };
  if (proto.data_location() == Proto::EXTERNAL) refuse("its data in another file");
  auto& values = tensor.values;
  switch (proto.data_type()) {
    case Proto::FLOAT:
      values.assign(proto.float_data().begin(), proto.float_data().end());
      if (proto.has_raw_data()) append_raw<float>(proto.raw_data(), values);
      break;
    case Proto::DOUBLE:
      values.assign(proto.double_data().begin(), proto.double_data().end());
      if (proto.has_raw_data()) append_raw<double>(proto.raw_data(), values);
      break;
    case Proto::INT64:
      values.assign(proto.int64_data().begin(), proto.int64_data().end());
      if (proto.has_raw_data()) append_raw<std::int64_t>(proto.raw_data(), values);
      break;
    default:
      refuse(fmt::format("data type {}", proto.data_type()));
  }
  if (values.size() != count_of(tensor.shape)) refuse("other data than its shape says");
  if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); }))
    refuse("a value that is not finite");
  return tensor;
}

// The nodes that the output depends on: a network may have others, such as the deviation of its actions.
std::set<const onnx::NodeProto*> OnnxGraph::needed_for(const std::string& output) const {
  std::map<std::string, const Node*> makers;
  for (const Node& node : graph_.node()) {
    for (const std::string& name : node.output()) makers[name] = &node;
  }
  std::set<const Node*> needed;
  std::vector<std::string> wanted{output};
  while (!wanted.empty()) {
    const auto maker = makers.find(wanted.back());
    wanted.pop_back();
    if (maker == makers.end() || !needed.insert(maker->second).second) continue;
    wanted.insert(wanted.end(), maker->second->input().begin(), maker->second->input().end());
  }
  return needed;
}

std::string OnnxGraph::find_input() const {
  std::vector<std::string> inputs;
  for (const auto& input : graph_.input()) {
    if (!constants_.contains(input.name())) inputs.push_back(input.name());
  }
  if (inputs.size() != 1)
    throw InputError(file_, 0, fmt::format("{} inputs", inputs.size()),
                     "a network with one vector of inputs");
  return inputs.front();
}

Mlp OnnxGraph::read(const std::string& output) {
  for (const auto& initializer : graph_.initializer())
    constants_[initializer.name()] = tensor_of(initializer, initializer.name());
  value_ = find_input();
  std::vector<std::string> outputs;
  for (const auto& each : graph_.output()) outputs.push_back(each.name());
  if (outputs.empty()) throw InputError(file_, 0, "no outputs", "a network with an output");
  const std::string wanted = output.empty() ? outputs.front() : output;
  if (std::ranges::find(outputs, wanted) == outputs.end())
    throw InputError(file_, 0, "no output " + wanted, join_alternatives(outputs));
  const std::set<const Node*> needed = needed_for(wanted);
  const Node* last = nullptr;
  for (const Node& node : graph_.node()) {
    if (!needed.contains(&node)) continue;
    if (node.output_size() == 0) fail(node, "no output");
    read_node(node);
    last = &node;
  }
  if (last == nullptr) throw InputError(file_, 0, "an output without nodes", "a multilayer perceptron");
  if (!is_value(*last, wanted)) fail(*last, "its result is not the output " + wanted);
  if (builder_.mlp().layers.empty()) throw InputError(file_, 0, "no layer", "a multilayer perceptron");
  return builder_.mlp();
}

bool OnnxGraph::is_value(const Node& node, const std::string& name) {
  if (name == value_) return true;
  const auto part = parts_.find(name);
  if (part == parts_.end()) return false;
  require(node, builder_.slice(part->second.begin, part->second.end));
  value_ = name;
  parts_.clear();
  return true;
}

void OnnxGraph::read_node(const Node& node) {
  const std::string& kind = node.op_type();
  if (kind == "Constant") return read_constant(node);
  if (kind == "Mul" && read_silu(node)) return;
  if (!sigmoid_.empty()) fail(node, "a sigmoid that is not multiplied with its own argument", "SiLU");
  if (node.input_size() == 0) fail(node, "no input");
  if (kind == "Gemm") return read_gemm(node);
  if (kind == "MatMul") return read_matmul(node);
  if (kind == "Add" || kind == "Sub" || kind == "Mul" || kind == "Div") return read_arithmetic(node);
  const bool is_known = kind == "Clip" || kind == "Elu" || kind == "Slice" || kind == "Split" ||
                        kind == "Sigmoid" || kind == "Relu" || kind == "Tanh" || kind == "Identity";
  if (!is_known) fail(node, "a node that the firmware does not compute", kExpectedNodes);
  if (!is_value(node, node.input(0))) fail(node, "a branch");
  if (kind == "Clip") return read_clip(node);
  if (kind == "Elu") return read_elu(node);
  if (kind == "Slice") return read_slice(node);
  if (kind == "Split") return read_split(node);
  if (kind == "Sigmoid") {
    sigmoid_ = node.output(0);
    return;
  }
  if (kind == "Relu") require(node, builder_.activate(policy::Activation::kRelu));
  if (kind == "Tanh") require(node, builder_.activate(policy::Activation::kTanh));
  set_value(node);
}

void OnnxGraph::read_constant(const Node& node) {
  const auto* const value = attribute(node, "value");
  if (value == nullptr || !value->has_t()) fail(node, "a constant without a tensor");
  constants_[node.output(0)] = tensor_of(value->t(), node.output(0));
}

// Returns whether the node makes x sigmoid(x).
bool OnnxGraph::read_silu(const Node& node) {
  if (sigmoid_.empty() || node.input_size() != 2) return false;
  const bool matches = (node.input(0) == sigmoid_ && node.input(1) == value_) ||
                       (node.input(1) == sigmoid_ && node.input(0) == value_);
  if (!matches) return false;
  require(node, builder_.activate(policy::Activation::kSilu));
  sigmoid_.clear();
  set_value(node);
  return true;
}

// Weights in the order of rows of outputs, or transposed.
void OnnxGraph::multiply(const Node& node, const Tensor& weights, bool transposed, double factor) {
  if (weights.shape.size() != 2) fail(node, "weights that are no matrix");
  const auto first = static_cast<std::size_t>(weights.shape[0]);
  const auto second = static_cast<std::size_t>(weights.shape[1]);
  const std::size_t rows = transposed ? second : first;
  const std::size_t columns = transposed ? first : second;
  if (rows == 0 || columns == 0) fail(node, "an empty matrix");
  std::vector<double> by_row(rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t c = 0; c < columns; ++c)
      by_row[row * columns + c] = factor * weights.values[transposed ? c * rows + row : row * columns + c];
  }
  require(node, builder_.multiply(rows, columns, std::move(by_row)));
}

void OnnxGraph::read_gemm(const Node& node) {
  const auto flag = [&](const char* name) {
    const auto* const given = attribute(node, name);
    return given != nullptr && given->i() != 0;
  };
  const auto factor = [&](const char* name) {
    const auto* const given = attribute(node, name);
    return given == nullptr ? 1.0 : static_cast<double>(given->f());
  };
  const Tensor* const weights = node.input_size() > 1 ? constant(node.input(1)) : nullptr;
  if (weights == nullptr || !is_value(node, node.input(0)) || flag("transA"))
    fail(node, "other operands than the value and constant weights");
  multiply(node, *weights, !flag("transB"), factor("alpha"));
  if (node.input_size() > 2) {
    const Tensor* const biases = constant(node.input(2));
    if (biases == nullptr || biases->values.empty()) fail(node, "biases that are not constant");
    std::vector<double> offset = biases->values;
    for (double& value : offset) value *= factor("beta");
    scale(node, {1.0}, std::move(offset));
  }
  set_value(node);
}

void OnnxGraph::read_matmul(const Node& node) {
  const Tensor* const weights = node.input_size() == 2 ? constant(node.input(1)) : nullptr;
  if (weights == nullptr || !is_value(node, node.input(0)))
    fail(node, "other operands than the value and constant weights");
  multiply(node, *weights, true, 1.0);
  set_value(node);
}

const Tensor& OnnxGraph::operand(const Node& node, bool& value_is_first) {
  if (node.input_size() != 2) fail(node, "not two operands");
  for (const int place : {1, 0}) {
    const Tensor* const tensor = constant(node.input(place));
    if (tensor == nullptr || tensor->values.empty() || !is_value(node, node.input(1 - place))) continue;
    value_is_first = place == 1;
    return *tensor;
  }
  fail(node, "other operands than the value and a constant");
}

void OnnxGraph::read_arithmetic(const Node& node) {
  bool value_is_first = true;
  std::vector<double> numbers = operand(node, value_is_first).values;
  const std::string& kind = node.op_type();
  if (kind == "Add") {
    scale(node, {1.0}, std::move(numbers));
  } else if (kind == "Mul") {
    scale(node, std::move(numbers), {0.0});
  } else if (kind == "Sub") {
    if (value_is_first) {
      for (double& number : numbers) number = -number;
    }
    scale(node, {value_is_first ? 1.0 : -1.0}, std::move(numbers));
  } else {
    if (!value_is_first) fail(node, "a constant divided by the value");
    for (double& number : numbers) {
      if (number == 0.0) fail(node, "a division by zero");
      number = 1.0 / number;
    }
    scale(node, std::move(numbers), {0.0});
  }
  set_value(node);
}

void OnnxGraph::read_clip(const Node& node) {
  const auto bound = [&](const char* name, int input) -> std::optional<double> {
    if (const auto* const given = attribute(node, name)) return given->f();
    if (node.input_size() <= input || node.input(input).empty()) return std::nullopt;
    const Tensor* const tensor = constant(node.input(input));
    if (tensor == nullptr || tensor->values.size() != 1) fail(node, "a bound that is not one constant");
    return tensor->values.front();
  };
  const auto low = bound("min", 1);
  const auto high = bound("max", 2);
  if (!low || !high) fail(node, "one bound", "two bounds, -c and c");
  require(node, builder_.clip(*low, *high));
  set_value(node);
}

void OnnxGraph::read_elu(const Node& node) {
  if (const auto* const alpha = attribute(node, "alpha"); alpha != nullptr && alpha->f() != 1.0F)
    fail(node, fmt::format("alpha = {}", alpha->f()), "alpha = 1");
  require(node, builder_.activate(policy::Activation::kElu));
  set_value(node);
}

// An attribute of older versions of the operator, or an input of newer ones.
std::vector<std::int64_t> OnnxGraph::integers(const Node& node, std::string_view name, int input) const {
  if (const auto* const given = attribute(node, name)) {
    if (given->ints_size() == 0) return {given->i()};
    return {given->ints().begin(), given->ints().end()};
  }
  if (node.input_size() <= input || node.input(input).empty()) return {};
  const Tensor* const tensor = constant(node.input(input));
  if (tensor == nullptr) fail(node, fmt::format("{} that are not constant", name));
  std::vector<std::int64_t> numbers;
  for (const double value : tensor->values)
    numbers.push_back(static_cast<std::int64_t>(std::clamp(value, -1e9, 1e9)));
  return numbers;
}

void OnnxGraph::read_slice(const Node& node) {
  const auto starts = integers(node, "starts", 1);
  const auto ends = integers(node, "ends", 2);
  const auto axes = integers(node, "axes", 3);
  const auto steps = integers(node, "steps", 4);
  const bool is_last_axis = axes.size() == 1 && (axes[0] == 1 || axes[0] == -1);
  const auto width = static_cast<std::int64_t>(builder_.width());
  if (starts.size() != 1 || ends.size() != 1 || !is_last_axis || !(steps.empty() || steps[0] == 1))
    fail(node, "another slice than of consecutive elements of the last axis");
  const auto place = [width](std::int64_t index) {
    return std::clamp<std::int64_t>(index < 0 ? index + width : index, 0, width);
  };
  require(node, builder_.slice(static_cast<std::size_t>(place(starts[0])),
                               static_cast<std::size_t>(place(ends[0]))));
  set_value(node);
}

void OnnxGraph::read_split(const Node& node) {
  const auto* const axis = attribute(node, "axis");
  if (axis == nullptr || (axis->i() != 1 && axis->i() != -1)) fail(node, "another axis than the last");
  auto sizes = integers(node, "split", 1);
  const auto parts = static_cast<std::size_t>(node.output_size());
  if (sizes.empty()) sizes.assign(parts, static_cast<std::int64_t>(builder_.width() / parts));
  if (sizes.size() != parts) fail(node, "another number of sizes than outputs");
  std::size_t begin = 0;
  for (std::size_t i = 0; i < parts; ++i) {
    if (sizes[i] <= 0 || sizes[i] > kMaxElements) fail(node, "a size out of range");
    const std::size_t end = begin + static_cast<std::size_t>(sizes[i]);
    parts_[node.output(static_cast<int>(i))] = {begin, end};
    begin = end;
  }
  if (begin != builder_.width()) fail(node, fmt::format("{} elements of {}", begin, builder_.width()));
  value_.clear();
}

}  // namespace

bool reads_onnx() { return true; }

Mlp read_onnx(const std::filesystem::path& file, const std::string& output) {
  const std::string bytes = read_text_file(file, "an ONNX file");
  onnx::ModelProto model;
  if (!model.ParseFromString(bytes) || !model.has_graph())
    throw InputError(file, 0, "no model", "an ONNX file with a graph");
  return OnnxGraph(file, model.graph()).read(output);
}

}  // namespace koboshi::tools
