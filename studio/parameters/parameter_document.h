#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/edit/yaml_document.h"
#include "sim_board/description/description.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/scenario.h"
#include "studio/document/text_document.h"
#include "studio/parameters/parameter_table.h"

namespace koboshi::studio {

// A value for the parameter with this index in its table.
struct ParameterValue {
  std::size_t index = 0;
  double value = 0.0;
};

// A robot's parameters.yaml, or a gait file, that is being edited.
//
// Every edit is one step of the undo history and changes as few bytes as it can: comments, order and layout
// of the rest stay. An edit that does not fit throws InputError and changes nothing. Indices are those
// of table().
class ParameterDocument final : public TextDocument {
 public:
  // Opens a file, whose keys tell which of the two it is. Throws InputError if it cannot be read.
  explicit ParameterDocument(const std::filesystem::path& file);

  ParameterTable table() const { return table_; }
  // Whether it holds the numbers of a gait.
  bool is_gait() const { return is_gait_; }
  const std::string& text() const override { return yaml_.text(); }

  // Whether the text has the key.
  bool is_given(std::size_t index) const;
  // The value in the text, or else the default; nothing if neither is a number.
  std::optional<double> value(std::size_t index) const;
  // The same in the file, as it was read or saved last.
  std::optional<double> file_value(std::size_t index) const;
  bool is_changed(std::size_t index) const;
  std::vector<std::size_t> changed() const;

  // Sets a value, rounded to a step. Edits with one non-empty `drag` merge into one step of the history until
  // end_drag() or another edit.
  void set(std::size_t index, double value, std::string_view drag = {});
  // Sets several values as one edit, which the history names `label`. No index twice.
  void set_all(std::span<const ParameterValue> values, std::string_view label);
  // Gives a parameter the value of the file again.
  void reset_to_file(std::size_t index);
  // Removes the key. Throws InputError for one that the file must have.
  void reset_to_default(std::size_t index);
  void reset_all_to_file();
  // Takes over the whole text, such as that of a recovery.
  void replace_text(const std::string& text);

  // The compiler's complaint about these values on this robot: one line; empty if they are good.
  [[nodiscard]] std::string problem(const sim_board::RobotDescription& robot,
                                    const simulation::NamedModel& model) const;
  // The parameters of the text. Throws InputError for an unknown key, or one of a gait file.
  [[nodiscard]] simulation::RobotParameters robot_parameters() const;
  // Gives a scenario that uses this file the values of the text in their place. Throws what
  // robot_parameters() throws.
  void apply_to(simulation::Scenario& scenario) const;

 private:
  struct Opened {
    ReadFile read;
    YamlDocument yaml;
  };
  ParameterDocument(std::filesystem::path path, Opened opened);
  static Opened open(const std::filesystem::path& file);

  void check(const std::string& text) const override;
  void take_text(std::string text) override { yaml_.replace_text(std::move(text)); }
  void match_file() override { saved_ = yaml_; }
  std::optional<double> value_in(const YamlDocument& yaml, std::size_t index) const;
  std::string checked_text(std::size_t index, double value) const;
  void set_in(YamlDocument& yaml, const ParameterValue& value) const;

  YamlDocument yaml_;
  YamlDocument saved_;  // the file, as it was read or saved last
  bool is_gait_ = false;
  ParameterTable table_;
};

}  // namespace koboshi::studio
