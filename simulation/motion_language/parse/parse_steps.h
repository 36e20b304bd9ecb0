#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/parse_settings.h"
#include "simulation/motion_language/parse/parse_values.h"
#include "simulation/motion_language/parse/poses.h"
#include "simulation/motion_language/parse/reader.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// The parts of a file to which its steps refer.
struct StepContext {
  int version = 1;
  motion::Interpolation interpolation = motion::Interpolation::kLinear;  // default of the file
  const std::vector<VariableSource>& variables;
  std::vector<std::string> routines;
  std::uint32_t allowed = 0;  // mask of the joints that the motion may move
};

// Parses a list of steps. Reports errors and leaves out the steps concerned.
class StepParser {
 public:
  StepParser(const JointNames& joints, const StepContext& context, PoseBuilder& poses, Reader& reader)
      : context_(context),
        poses_(poses),
        reader_(reader),
        settings_(joints, context.allowed, reader),
        values_(joints, context.variables, reader) {}

  [[nodiscard]] std::vector<StepSource> parse(const YamlNode& list);

 private:
  using Node = YamlNode;

  std::optional<StepSource> parse_step(const Node& node);
  bool check_kind(const Node& node, const std::string& kind);
  bool parse_kind(const std::string& kind, const Node& map, const Node& value, StepSource& step);
  bool parse_word(const Node& node, StepSource& step);
  void parse_path(const YamlNode& map, const YamlNode& node, StepSource& step);
  void parse_during(const YamlNode& node, StepSource& step);
  void parse_timing(const Node& map, StepSource& step);
  bool parse_move(const Node& map, const Node& value, StepSource& step);
  bool parse_loop(const Node& value, StepSource& step);
  bool parse_if(const Node& map, const Node& value, StepSource& step);
  bool parse_wait(const Node& value, StepSource& step);
  bool parse_jump(const Node& map, const Node& value, StepSource& step);
  bool parse_call(const Node& value, StepSource& step);
  bool parse_setting(const std::string& kind, const Node& value, StepSource& step);
  bool parse_tests(const Node& value, bool is_await, StepSource& step);

  std::optional<std::uint32_t> time_us(const Node& map, const std::string& key);
  bool set_text(const Node& node, std::string& text);

  const StepContext& context_;
  PoseBuilder& poses_;
  Reader& reader_;
  SettingParser settings_;
  ValueParser values_;
  int depth_ = 0;
};

// Parses `linear`, `minimum_jerk` or `cubic`.
[[nodiscard]] std::optional<motion::Interpolation> parse_interpolation(const YamlNode& node, Reader& reader);

}  // namespace koboshi::simulation
