#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/error.h"

namespace koboshi::simulation {

// The messages of the motion compiler and of the check.

enum class Severity { kError, kWarning, kNote };

// A place in a motion file, or in an option of the command line (`--set`), which replaces `file` in messages.
struct Place {
  int line = 0;    // from 1; 0: the file as a whole
  int column = 0;  // from 1; 0: unknown
  int length = 1;  // letters to underline
  std::string option = {};
};

// A message. Its code is stable; docs/reference/motion-language.md lists all codes.
struct Diagnostic {
  std::string code;  // "M012"
  Severity severity = Severity::kError;
  Place place = {};
  std::string found;  // without "found"
  std::string expected;
  std::string hint = {};            // a whole sentence; empty: none
  std::string limit = {};           // InputError::limit()
  std::filesystem::path file = {};  // Diagnostics::add sets it,
  std::string source_line = {};     // and this
};

// An error of a motion file with all of its diagnostics. `what()` is the first error's line.
class MotionError : public InputError {
 public:
  explicit MotionError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

// Collects the messages about one file, in the order of their discovery.
class Diagnostics {
 public:
  // Errors after which the compiler gives up.
  static constexpr std::size_t kMaxErrors = 20;

  // `text`: the file's content, which the messages quote.
  explicit Diagnostics(std::filesystem::path file, std::string text = {});

  // Adds a message. A second error at the same place is dropped: it is usually a consequence of the first.
  // Throws MotionError at kMaxErrors.
  void add(Diagnostic diagnostic);
  bool has_errors() const { return error_count_ > 0; }
  std::size_t error_count() const { return error_count_; }
  const std::vector<Diagnostic>& all() const { return all_; }
  const std::filesystem::path& file() const { return file_; }
  // Throws MotionError if there is an error.
  void throw_errors() const;

 private:
  std::filesystem::path file_;
  std::vector<std::string> lines_;
  std::vector<Diagnostic> all_;
  std::size_t error_count_ = 0;
};

// Returns "FILE:LINE:COLUMN: error[M012]: found FOUND, expected EXPECTED", the source line with a caret, and
// the hint, each on its line, with a line feed after the last one.
[[nodiscard]] std::string print(const Diagnostic& diagnostic);
[[nodiscard]] std::string print(const std::vector<Diagnostic>& diagnostics);

// Returns a JSON list of objects with the keys code, severity, file, line, column, length, found, expected
// and hint, for editors and CI.
[[nodiscard]] std::string json_text(const std::vector<Diagnostic>& diagnostics);

// Returns "did you mean `left_knee`?", or nothing if no name is near.
[[nodiscard]] std::string did_you_mean(std::string_view misspelt, const std::vector<std::string>& names);

}  // namespace koboshi::simulation
