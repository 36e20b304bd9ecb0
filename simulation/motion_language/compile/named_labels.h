#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simulation/motion_language/compile/program_writer.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// The labels that a file names, in the steps of one routine or of the main program.
class NamedLabels {
 public:
  using Label = ProgramWriter::Label;

  NamedLabels(ProgramWriter& program, Diagnostics& diagnostics)
      : program_(program), diagnostics_(diagnostics) {}

  // Forgets all labels, for the next routine.
  void clear() { labels_.clear(); }
  // Returns the label to which the step at `use` jumps. It may be placed later.
  [[nodiscard]] Label target(const std::string& name, const Place& use);
  // Places the label of a step `label`; reports a second one with the same name.
  void place(const StepSource& step);
  // Returns the label if it is placed.
  [[nodiscard]] std::optional<Label> find_placed(const std::string& name) const;
  // Returns the names of the placed labels, for hints.
  [[nodiscard]] std::vector<std::string> placed_names() const;
  // Reports each label that a step jumps to and that is not placed. `expected`: "a label of this routine".
  void check(const std::string& expected) const;

 private:
  struct NamedLabel {
    Label label = 0;
    bool is_placed = false;
    std::optional<Place> first_use = {};
  };

  NamedLabel& entry(const std::string& name);

  ProgramWriter& program_;
  Diagnostics& diagnostics_;
  std::map<std::string, NamedLabel> labels_;
};

}  // namespace koboshi::simulation
