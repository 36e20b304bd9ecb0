#include "tools/policy/quantise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "base/text/error.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/policy/policy.h"
#include "hal/port/period.h"
#include "simulation/policy/policy_file.h"

namespace koboshi::tools {
namespace {

using policy::Activation;

constexpr double kMaxActivation = 32'767.0;
constexpr double kMaxWeight = 127.0;
constexpr double kTick_s = hal::kControlPeriod_us * 1e-6;
// Room for values beyond the recorded ones, in the range of an activation: 25 %, a third of a bit.
constexpr double kHeadroom = 1.25;
constexpr double kMaxMultiplier = 2'147'483'647.0;

double rounded(double value) { return std::round(value); }

struct Range {
  double low = 0.0;
  double high = 0.0;
};

class Quantiser {
 public:
  Quantiser(const Mlp& network, const PolicyMap& map, const std::vector<std::vector<double>>& rows,
            const simulation::NamedModel& robot, const std::filesystem::path& onnx)
      : network_(network), map_(map), rows_(rows), robot_(robot), onnx_(onnx) {}

  QuantisedPolicy run() {
    check_sizes();
    find_ranges();
    watch_activations();
    make_inputs();
    for (std::size_t i = 0; i < network_.layers.size(); ++i) make_layer(i);
    make_outputs();
    contents_.model_id = robot_.model.id;
    contents_.name = map_.name;
    contents_.patience_ticks = map_.patience_ticks;
    return finish();
  }

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError(onnx_, 0, found, expected);
  }
  void check_sizes() const;
  void find_ranges();
  void watch_activations();
  void make_inputs();
  void make_layer(std::size_t index);
  void make_outputs();
  QuantisedPolicy finish();
  std::vector<double> network_inputs(const std::vector<double>& signals) const;
  std::vector<double> offsets_of(const std::vector<double>& signals) const;
  void measure(QuantisedPolicy& result) const;
  std::int32_t signal_raw(std::size_t input, double value) const;
  bool is_last(std::size_t layer) const { return layer + 1 == network_.layers.size(); }

  const Mlp& network_;
  const PolicyMap& map_;
  const std::vector<std::vector<double>>& rows_;
  const simulation::NamedModel& robot_;
  const std::filesystem::path& onnx_;
  std::vector<Range> ranges_;         // of the signals, in SI units
  std::vector<double> largest_sums_;  // by layer, of the recorded rows
  std::vector<double> input_units_;   // of the activation of each input
  double unit_ = 1.0;                 // of the activations that the next layer takes
  simulation::PolicyContents contents_;
};

void Quantiser::check_sizes() const {
  if (network_.inputs() != map_.inputs.size())
    fail(count_text(network_.inputs(), "input") + " of the network",
         fmt::format("the {} of the map", map_.inputs.size()));
  if (network_.outputs() != map_.outputs.size())
    fail(count_text(network_.outputs(), "output") + " of the network",
         fmt::format("the {} of the map", map_.outputs.size()));
  if (network_.layers.size() > policy::kMaxLayers)
    fail(count_text(network_.layers.size(), "layer"), fmt::format("at most {}", policy::kMaxLayers));
  for (const MlpLayer& layer : network_.layers) {
    if (layer.rows > policy::kMaxWidth || layer.columns > policy::kMaxWidth)
      fail(fmt::format("a layer of {} times {}", layer.rows, layer.columns),
           fmt::format("at most {} inputs and outputs of a layer", policy::kMaxWidth));
  }
}

void Quantiser::find_ranges() {
  for (std::size_t i = 0; i < map_.inputs.size(); ++i) {
    if (map_.inputs[i].range) {
      ranges_.push_back({map_.inputs[i].range->first, map_.inputs[i].range->second});
      continue;
    }
    Range range{rows_.front()[i], rows_.front()[i]};
    for (const std::vector<double>& row : rows_)
      range = {std::min(range.low, row[i]), std::max(range.high, row[i])};
    const double margin = map_.margin * (range.high - range.low);
    ranges_.push_back({range.low - margin, range.high + margin});
  }
}

std::vector<double> Quantiser::network_inputs(const std::vector<double>& signals) const {
  std::vector<double> in;
  for (std::size_t i = 0; i < signals.size(); ++i)
    in.push_back(std::clamp(signals[i], ranges_[i].low, ranges_[i].high) * map_.inputs[i].scale +
                 map_.inputs[i].offset);
  return in;
}

// Clamped to the bounds, as the firmware does.
std::vector<double> Quantiser::offsets_of(const std::vector<double>& signals) const {
  std::vector<double> offsets = network_.run(network_inputs(signals));
  for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] *= map_.outputs[i].scale_rad;
  return offsets;
}

void Quantiser::watch_activations() {
  largest_sums_.assign(network_.layers.size(), 0.0);
  for (const std::vector<double>& row : rows_) {
    static_cast<void>(
        network_.run(network_inputs(row), [this](std::size_t layer, std::span<const double> sums) {
          for (const double sum : sums) largest_sums_[layer] = std::max(largest_sums_[layer], std::abs(sum));
        }));
  }
}

std::int32_t Quantiser::signal_raw(std::size_t input, double value) const {
  return static_cast<std::int32_t>(std::clamp(rounded(value / map_.inputs[input].unit),
                                              -static_cast<double>(policy::kMaxSignal),
                                              static_cast<double>(policy::kMaxSignal)));
}

// An input has a unit of its own: its range, or the clip, takes all bits. A clip is the saturation.
void Quantiser::make_inputs() {
  for (std::size_t i = 0; i < map_.inputs.size(); ++i) {
    const MappedInput& mapped = map_.inputs[i];
    // The normalised value is signal * slope + at_zero.
    const double slope = mapped.scale * network_.factor[i];
    const double at_zero = mapped.offset * network_.factor[i] + network_.offset[i];
    policy::Input input{.signal = mapped.signal};
    input.low = signal_raw(i, ranges_[i].low);
    input.high = signal_raw(i, ranges_[i].high);
    const double low = ranges_[i].low * slope + at_zero;
    const double high = ranges_[i].high * slope + at_zero;
    double mean = 0.0;
    if (slope != 0.0) {
      mean =
          std::clamp(-at_zero / slope, -policy::kMaxSignal * mapped.unit, policy::kMaxSignal * mapped.unit);
      // A zero that the integers do not reach would bias the input.
      if (std::abs(-at_zero / slope - mean) > mapped.unit)
        fail("a mean of " + mapped.name + " beyond the range of the signal",
             "a mean that the signal can have");
    } else if (at_zero != 0.0) {
      fail("a factor of zero for " + mapped.name, "an input that depends on its signal");
    }
    input.mean = signal_raw(i, mean);
    double largest = std::max({std::abs(low), std::abs(high), 1e-9});
    largest = std::min(largest, network_.clip);
    double unit = largest / kMaxActivation;
    // A fine signal in coarse integers: the multiplier has its limit at a half.
    const double finest = std::abs(slope) * mapped.unit * 2.0;
    if (unit < finest && network_.clip <= largest)
      fail(fmt::format("a clip of {} at {} of its signal", mapped.name, network_.clip / std::abs(slope)),
           fmt::format("at least {:.4g}", finest * kMaxActivation / std::abs(slope)));
    unit = std::max(unit, finest);
    input.multiplier = static_cast<std::int32_t>(
        std::clamp(rounded(slope * mapped.unit / unit * 4'294'967'296.0), -kMaxMultiplier, kMaxMultiplier));
    input_units_.push_back(unit);
    contents_.inputs.push_back(input);
  }
}

void Quantiser::make_layer(std::size_t index) {
  const MlpLayer& layer = network_.layers[index];
  simulation::PolicyLayer quantised{
      .rows = layer.rows, .columns = layer.columns, .activation = layer.activation};
  // Weights that take the inputs' own units.
  std::vector<double> weights = layer.weights;
  if (index == 0) {
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= input_units_[i % layer.columns];
    unit_ = 1.0;
  }
  double largest = 0.0;
  for (const double weight : weights) largest = std::max(largest, std::abs(weight));
  if (largest == 0.0) largest = 1.0;
  const double weight_unit = largest / kMaxWeight;
  for (const double weight : weights)
    quantised.weights.push_back(static_cast<std::int8_t>(rounded(weight / weight_unit)));
  const double sum_unit = weight_unit * unit_;
  for (const double bias : layer.biases) {
    const double raw = rounded(bias / sum_unit);
    if (std::abs(raw) >= policy::kMaxBias)
      fail(fmt::format("a bias of {} in layer {}", bias, index), "biases that the weights can counter");
    quantised.biases.push_back(static_cast<std::int32_t>(raw));
  }
  // The unit of the pre-activations.
  const double reach = std::max(largest_sums_[index] * kHeadroom, 1e-9);
  double out_unit = 0.0;
  switch (layer.activation) {
    case Activation::kLinear:
    case Activation::kRelu:
      out_unit = reach / kMaxActivation;
      break;
    case Activation::kTanh:
      out_unit = std::ldexp(1.0, -policy::kMaxFractionBits);
      break;
    case Activation::kElu:
    case Activation::kSilu:
      while (quantised.fraction_bits > policy::kMinFractionBits &&
             std::ldexp(reach, quantised.fraction_bits) > kMaxActivation)
        --quantised.fraction_bits;
      out_unit = std::ldexp(1.0, -quantised.fraction_bits);
      break;
  }
  if (is_last(index) && layer.activation == Activation::kLinear) {
    for (const MappedOutput& output : map_.outputs) {
      if (output.scale_rad == 0.0) continue;
      // An output beyond its bound must be seen.
      out_unit =
          std::max(out_unit, output.bound_rad / std::abs(output.scale_rad) * kHeadroom / kMaxActivation);
    }
  }
  out_unit = std::max(out_unit, sum_unit * 2.0);  // the multiplier has its limit at a half
  const bool is_fixed = layer.activation != Activation::kLinear && layer.activation != Activation::kRelu;
  if (is_fixed && sum_unit / out_unit > 0.5)
    fail(fmt::format("weights of layer {} that are too large", index), "weights below 100 or so");
  quantised.multiplier =
      static_cast<std::int32_t>(std::min(rounded(sum_unit / out_unit * 4'294'967'296.0), kMaxMultiplier));
  unit_ = layer.activation == Activation::kTanh ? std::ldexp(1.0, -policy::kTanhFractionBits) : out_unit;
  contents_.layers.push_back(std::move(quantised));
}

void Quantiser::make_outputs() {
  for (const MappedOutput& mapped : map_.outputs) {
    const double raw_per_rad = std::ldexp(1.0, 32) / (2.0 * std::numbers::pi);
    const double scale = rounded(unit_ * mapped.scale_rad * raw_per_rad);
    if (std::abs(scale) > policy::kMaxScale)
      fail("offsets of " + mapped.joint + " beyond a quarter turn", "a smaller scale_rad");
    contents_.outputs.push_back({.joint = mapped.index,
                                 .scale = static_cast<std::int32_t>(scale),
                                 .bound = fixed::from_double<fixed::Angle>(mapped.bound_rad),
                                 .rate = fixed::from_double<fixed::Angle>(mapped.rate_rad_per_s * kTick_s)});
    // Rounding must not exceed the validator's limit.
    contents_.outputs.back().bound = std::min(contents_.outputs.back().bound, policy::kMaxOffset);
  }
}

void Quantiser::measure(QuantisedPolicy& result) const {
  policy::Policy policy;
  const policy::PolicyVerdict verdict = policy::Policy::open(result.image, robot_.model, policy);
  if (!verdict.ok()) {
    fail(simulation::describe(verdict),
         fmt::format("a network that the firmware accepts, of at most {} instructions", policy::kMaxWork));
  }
  result.work = policy.work();
  for (std::size_t i = 0; i < policy.layer_count(); ++i)
    result.weights += policy.layer(i).rows * policy.layer(i).columns;
  result.errors.resize(map_.outputs.size());
  std::vector<double> squares(map_.outputs.size());
  for (const std::vector<double>& row : rows_) {
    policy::Signals::Values signals{};
    for (std::size_t i = 0; i < row.size(); ++i) signals[map_.inputs[i].signal] = signal_raw(i, row[i]);
    policy::Activations a;
    policy::Activations b;
    static_cast<void>(policy.normalise(signals, a));
    const policy::Activations& out = policy.run(a, b);
    const std::vector<double> expected = offsets_of(row);
    bool clamped = false;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const policy::Output output = policy.output(i);
      const auto offset = fixed::Angle::from_raw(out.values[i] * output.scale);
      const double bound_rad = fixed::to_double(output.bound);
      const double got_rad = std::clamp(fixed::to_double(offset), -bound_rad, bound_rad);
      const double error_rad = got_rad - std::clamp(expected[i], -bound_rad, bound_rad);
      clamped = clamped || std::abs(expected[i]) > bound_rad;
      QuantisationError& error = result.errors[i];
      error.largest_rad = std::max(error.largest_rad, std::abs(error_rad));
      error.range_rad = std::max(error.range_rad, std::abs(expected[i]));
      squares[i] += error_rad * error_rad;
    }
    result.clamped_rows += clamped ? 1 : 0;
  }
  for (std::size_t i = 0; i < squares.size(); ++i)
    result.errors[i].rms_rad = std::sqrt(squares[i] / static_cast<double>(rows_.size()));
}

QuantisedPolicy Quantiser::finish() {
  QuantisedPolicy result;
  result.image = simulation::make_policy_image(contents_);
  measure(result);
  return result;
}

}  // namespace

QuantisedPolicy quantise(const Mlp& network, const PolicyMap& map,
                         const std::vector<std::vector<double>>& rows, const simulation::NamedModel& robot,
                         const std::filesystem::path& onnx) {
  return Quantiser(network, map, rows, robot, onnx).run();
}

}  // namespace koboshi::tools
