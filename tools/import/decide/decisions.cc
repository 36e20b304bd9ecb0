#include "tools/import/decide/decisions.h"

#include <algorithm>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_reader.h"

namespace koboshi::tools {
namespace {

constexpr NumberRange kAngle_deg{-360.0, 360.0};

template <typename Value, typename Read>
void read_map(const YamlMap& root, const std::string& key, std::map<std::string, Value>& values,
              ImportDecisions& decisions, const Read& read) {
  const auto map = root.optional_child(key);
  if (!map) return;
  for (const auto& [name, value] : map->entries()) {
    values[name] = read(value);
    decisions.places[key + "/" + name] = {value.source(), value.line()};
  }
}

// An answer may be a number or a boolean in YAML; the interview parses its text.
std::string answer_text(const YamlValue& value) {
  if (value.is_map() || value.is_list()) throw value.error("an answer: a word or a number");
  try {
    return number_text(value.number());
  } catch (const InputError&) {
    return value.text();
  }
}

template <typename Value>
void override_map(std::map<std::string, Value>& base, const std::map<std::string, Value>& other) {
  for (const auto& [key, value] : other) base[key] = value;
}

}  // namespace

ImportDecisions read_decisions(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap root = yaml.root();
  root.require_version(1);
  ImportDecisions decisions;
  if (root.has("source")) static_cast<void>(root.text("source"));
  const auto text = [](const YamlValue& value) { return value.text(); };
  const auto angle = [](const YamlValue& value) { return value.number(kAngle_deg); };
  read_map(root, "answers", decisions.answers, decisions, answer_text);
  read_map(root, "joints", decisions.joints, decisions, text);
  read_map(root, "locked_deg", decisions.locked_deg, decisions, angle);
  read_map(root, "zero_deg", decisions.zero_deg, decisions, angle);
  read_map(root, "limits_deg", decisions.limits_deg, decisions, [](const YamlValue& value) {
    const std::vector<double> limits = value.numbers(2, kAngle_deg);
    if (limits[0] >= limits[1]) throw value.error("a lower limit below the upper one");
    return std::array{limits[0], limits[1]};
  });
  read_map(root, "servos", decisions.servos, decisions, text);
  const std::vector<std::string> choices{"take", "keep"};
  read_map(root, "repairs", decisions.repairs, decisions,
           [&](const YamlValue& value) { return value.one_of(choices); });
  yaml.finish();
  return decisions;
}

InputError decision_error(const ImportDecisions& decisions, const std::string& key, const std::string& name,
                          const std::filesystem::path& source, const std::string& found,
                          const std::string& expected) {
  const auto place = decisions.places.find(key + "/" + name);
  if (place == decisions.places.end()) return InputError(source, 0, found, expected);
  return InputError(place->second.source, place->second.line, found, expected);
}

void override_decisions(ImportDecisions& base, const ImportDecisions& other) {
  override_map(base.places, other.places);
  override_map(base.answers, other.answers);
  override_map(base.joints, other.joints);
  override_map(base.locked_deg, other.locked_deg);
  override_map(base.zero_deg, other.zero_deg);
  override_map(base.limits_deg, other.limits_deg);
  override_map(base.servos, other.servos);
  override_map(base.repairs, other.repairs);
}

Interview::Interview(ImportDecisions given, Ask ask, std::filesystem::path source)
    : given_(std::move(given)), ask_(std::move(ask)), source_(std::move(source)) {}

void Interview::refuse(const ImportQuestion& question, const std::string& answer,
                       const std::string& expected) const {
  throw error("answers", question.name,
              "the answer " + one_line(answer) + " to the question " + question.name, expected);
}

std::string Interview::decided(const ImportQuestion& question, const Expected& expected) {
  questions_.push_back(question);
  std::string answer = question.preset;
  if (const auto given = given_.answers.find(question.name); given != given_.answers.end()) {
    answer = given->second;
  } else if (ask_) {
    ImportQuestion asked = question;
    for (std::string typed = ask_(asked); !typed.empty(); typed = ask_(asked)) {
      answer = typed;
      const auto fault = expected(answer);
      if (!fault) break;
      asked.text = "found " + one_line(answer) + ", expected " + *fault + "\n" + question.text;
      answer = question.preset;  // if nothing more comes
    }
  }
  if (const auto fault = expected(answer)) refuse(question, answer, *fault);
  return taken.answers[question.name] = answer;
}

std::string Interview::answer(const ImportQuestion& question) {
  return decided(question, [&](const std::string& answer) -> std::optional<std::string> {
    if (question.choices.empty() || std::ranges::find(question.choices, answer) != question.choices.end())
      return std::nullopt;
    return expected_names(answer, question.choices);
  });
}

double Interview::number(const ImportQuestion& question, double min, double max) {
  const std::string text = decided(question, [&](const std::string& answer) -> std::optional<std::string> {
    const auto value = parse_number(answer);
    if (value && *value >= min && *value <= max) return std::nullopt;
    return describe(NumberRange{min, max});
  });
  return parse_number(text).value();
}

bool Interview::yes(ImportQuestion question) {
  question.choices = {"yes", "no"};
  return answer(question) == "yes";
}

}  // namespace koboshi::tools
