#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/text/error.h"

namespace koboshi::tools {

// Everything that an import decides and a user may decide otherwise: the content of import.yaml
// (docs/reference/import-file.md). A file may have any part of it.
struct ImportDecisions {
  // Where a decision stands.
  struct Place {
    std::filesystem::path source{};  // the file, or the option of the command line
    int line = 0;                    // 0: no line of a file
  };
  std::map<std::string, Place> places{};  // by "joints/left_knee"

  std::map<std::string, std::string> answers{};  // by the question's name
  std::map<std::string, std::string> joints{};   // joint of robot.sdf: joint of the source
  std::map<std::string, double> locked_deg{};    // joint of the source: its angle
  std::map<std::string, double> zero_deg{};      // joint of robot.sdf: the source's angle at zero
  std::map<std::string, std::array<double, 2>> limits_deg{};  // joint of robot.sdf: lower, upper
  std::map<std::string, std::string> servos{};                // joint of robot.sdf: servo type
  std::map<std::string, std::string> repairs{};               // repair: take or keep
};

// Reads a file of decisions. Throws InputError.
[[nodiscard]] ImportDecisions read_decisions(const std::filesystem::path& file);

// Returns an error about a decision, at its place; `source` is that of decisions without a place.
[[nodiscard]] InputError decision_error(const ImportDecisions& decisions, const std::string& key,
                                        const std::string& name, const std::filesystem::path& source,
                                        const std::string& found, const std::string& expected);

// Replaces the decisions of `base` by those of `other`, one by one.
void override_decisions(ImportDecisions& base, const ImportDecisions& other);

// A question that no file answers.
struct ImportQuestion {
  std::string name{};                  // "servo"
  std::string text{};                  // "Which servo moves the joints?"
  std::string preset{};                // the answer if nobody gives another
  std::vector<std::string> choices{};  // the only answers; empty: any
};

// Answers questions from a file of decisions or by a person, and collects what was decided.
class Interview {
 public:
  // `ask` returns the answer of a person, empty for the preset; without it, presets answer.
  using Ask = std::function<std::string(const ImportQuestion&)>;
  Interview(ImportDecisions given, Ask ask, std::filesystem::path source);

  // Returns the answer. Throws InputError for one in the file that is not among the choices.
  std::string answer(const ImportQuestion& question);
  // The same for a number within a range.
  double number(const ImportQuestion& question, double min, double max);
  // The same for yes and no.
  bool yes(ImportQuestion question);

  const ImportDecisions& given() const { return given_; }
  // Returns an error about a given decision, at its place.
  [[nodiscard]] InputError error(const std::string& key, const std::string& name, const std::string& found,
                                 const std::string& expected) const {
    return decision_error(given_, key, name, source_, found, expected);
  }
  const std::vector<ImportQuestion>& questions() const { return questions_; }

  ImportDecisions taken{};  // by the stages

 private:
  // What is expected instead of an answer; nothing for a right one.
  using Expected = std::function<std::optional<std::string>(const std::string& answer)>;

  // A person is asked again until the answer is right.
  std::string decided(const ImportQuestion& question, const Expected& expected);
  [[noreturn]] void refuse(const ImportQuestion& question, const std::string& answer,
                           const std::string& expected) const;

  ImportDecisions given_;
  Ask ask_;
  std::filesystem::path source_;
  std::vector<ImportQuestion> questions_;
};

}  // namespace koboshi::tools
