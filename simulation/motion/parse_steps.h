#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulation/motion/joints.h"
#include "simulation/motion/poses.h"
#include "simulation/motion/reader.h"
#include "simulation/motion/source.h"

namespace koboshi::simulation {

// What the steps of a file can refer to.
struct StepContext {
  int version = 1;
  StepSource::Interpolation interpolation = StepSource::Interpolation::kLinear;  // default of the file
  const std::vector<VariableSource>& variables;
  std::vector<std::string> routines;
  std::uint32_t allowed = 0;  // mask of the joints that the motion may move
};

// Parses a list of steps. Reports errors and leaves out the steps concerned.
class StepParser {
 public:
  StepParser(const JointNames& joints, const StepContext& context, PoseBuilder& poses, Reader& reader)
      : joints_(joints), context_(context), poses_(poses), reader_(reader) {}

  [[nodiscard]] std::vector<StepSource> parse(const sim::YamlNode& list);

 private:
  using Node = sim::YamlNode;

  std::optional<StepSource> parse_step(const Node& node);
  bool check_kind(const Node& node, const std::string& kind);
  bool parse_kind(const std::string& kind, const Node& map, const Node& value, StepSource& step);
  bool parse_word(const Node& node, StepSource& step);
  bool parse_move(const Node& map, const Node& value, StepSource& step);
  bool parse_loop(const Node& value, StepSource& step);
  bool parse_if(const Node& map, const Node& value, StepSource& step);
  bool parse_wait(const Node& value, StepSource& step);
  bool parse_jump(const Node& map, const Node& value, StepSource& step);
  bool parse_expect(const Node& value, StepSource& step);
  bool parse_raw_expect(const Node& value, StepSource& step);
  bool parse_set(const Node& value, StepSource& step);
  bool parse_call(const Node& value, StepSource& step);
  bool parse_stiffness(const Node& value, std::vector<StiffnessSetting>& settings);
  bool parse_torque_off(const Node& value, StepSource& step);
  bool parse_mix(const Node& value, std::vector<MixSetting>& settings);
  std::optional<double> mix_limit_deg(const Node& node);
  bool parse_lean(const Node& value, std::optional<LeanSetting>& lean);
  bool parse_tests(const Node& value, bool is_await, StepSource& step);
  bool is_test(const Node& node, const Expression& expression);

  std::optional<std::uint32_t> time_us(const Node& map, const std::string& key);
  std::optional<std::uint32_t> joints(const Node& place, const std::string& name);
  std::optional<Expression> expression(const Node& node, std::size_t skip = 0);
  std::optional<Expression> condition(const Node& node);
  bool set_text(const Node& node, std::string& text);

  const JointNames& joints_;
  const StepContext& context_;
  PoseBuilder& poses_;
  Reader& reader_;
  int depth_ = 0;
};

// Parses `linear`, `minimum_jerk` or `cubic`.
[[nodiscard]] std::optional<StepSource::Interpolation> parse_interpolation(const sim::YamlNode& node,
                                                                           Reader& reader);

// Names of the sources of `mix`, in the order of the image.
inline constexpr std::array<std::string_view, 5> kMixSources{"roll_rate", "pitch_rate", "yaw_rate", "roll",
                                                             "pitch"};

}  // namespace koboshi::simulation
