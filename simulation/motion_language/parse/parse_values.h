#pragma once

#include <optional>
#include <vector>

#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/reader.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Parses conditions, assignments and tests of a file with these variables. Reports errors.
class ValueParser {
 public:
  ValueParser(const JointNames& joints, const std::vector<VariableSource>& variables, Reader& reader)
      : joints_(joints), variables_(variables), reader_(reader) {}

  // Parses a condition; a number counts as its comparison with zero.
  [[nodiscard]] std::optional<Expression> condition(const YamlNode& node);
  // Parses the map of a step `set`. Returns whether it is free of errors.
  bool assignments(const YamlNode& value, std::vector<Assignment>& assignments);
  // Parses the tests of a step `branch` or `await`, of which `value` is the map. Returns whether they are
  // free of errors.
  bool tests(const YamlNode& value, TestBlock& block);

 private:
  // Parses a text from its letter `skip` on.
  std::optional<Expression> expression(const YamlNode& node, std::size_t skip = 0);
  bool is_test(const YamlNode& node, const Expression& expression);

  const JointNames& joints_;
  const std::vector<VariableSource>& variables_;
  Reader& reader_;
};

}  // namespace koboshi::simulation
