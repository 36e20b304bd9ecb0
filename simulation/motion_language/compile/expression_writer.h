#pragma once

#include <algorithm>
#include <cstdint>

#include "simulation/motion_language/compile/program_writer.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Writes the arithmetic and the conditions of a motion: assignments of one operation each, and branches of up
// to eight tests. Intermediate results take spare variables above those of the file.
class ExpressionWriter {
 public:
  using Label = ProgramWriter::Label;

  // A spare variable, free again at the end of its scope. Reports an error if there is none.
  class Temporary {
   public:
    Temporary(ExpressionWriter& owner, const Place& place);
    ~Temporary() { --owner_.temporaries_; }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    [[nodiscard]] std::uint8_t index() const { return index_; }

   private:
    ExpressionWriter& owner_;
    std::uint8_t index_;
  };

  // `variables`: number of those of the file.
  ExpressionWriter(std::size_t variables, ProgramWriter& program, Diagnostics& diagnostics)
      : variables_(variables), used_(variables), program_(program), diagnostics_(diagnostics) {}

  // Changes a variable.
  void assign(const Assignment& assignment, const Place& place);
  // Changes a variable by an integer or a source.
  void add_set(std::uint8_t variable, motion::Arithmetic operation, const Expression& operand,
               const Place& place);
  // Jumps to `target` if the truth of the condition, which is in normal form, is `wanted`.
  void branch(const Expression& condition, bool wanted, Label target, const Place& place);
  // Jumps to `target` if the tests hold.
  void add_branch(const TestBlock& block, Label target, const Place& place);
  // Adds the tests of the branch or wait that was added last.
  void add_tests(const TestBlock& block, const Place& place);

  // Number of variables, with the spare ones used so far.
  [[nodiscard]] std::size_t variables() const { return used_; }

 private:
  void compute_into(std::uint8_t target, const Expression& expression, const Place& place);
  void apply(std::uint8_t target, motion::Arithmetic operation, const Expression& right, const Place& place);
  void branch_on_computed(Expression comparison, bool wanted, Label target, const Place& place);

  const std::size_t variables_;
  std::size_t temporaries_ = 0;  // that are alive
  std::size_t used_;
  ProgramWriter& program_;
  Diagnostics& diagnostics_;
};

// Returns an expression that is an integer, or a variable.
[[nodiscard]] Expression integer_expression(std::int32_t value);
[[nodiscard]] Expression variable_expression(std::uint8_t index);

// Returns the fields of the branch or wait with these tests.
[[nodiscard]] motion::Condition condition_of(const TestBlock& block);

}  // namespace koboshi::simulation
