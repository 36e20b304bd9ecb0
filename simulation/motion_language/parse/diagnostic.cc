#include "simulation/motion_language/parse/diagnostic.h"

#include <algorithm>
#include <array>
#include <sstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "base/text/text.h"

namespace koboshi::simulation {
namespace {

constexpr std::array<std::string_view, 3> kSeverityNames{"error", "warning", "note"};
constexpr std::size_t kMaxQuotedColumns = 160;

std::string_view name_of(Severity severity) { return kSeverityNames.at(static_cast<std::size_t>(severity)); }

InputError first_error(const std::vector<Diagnostic>& diagnostics) {
  const auto first = std::find_if(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& diagnostic) {
    return diagnostic.severity == Severity::kError;
  });
  if (first == diagnostics.end()) throw std::logic_error("a motion error without an error");
  const std::filesystem::path option(first->place.option);
  return InputError(option.empty() ? first->file : option, first->place.line, first->found, first->expected,
                    first->limit);
}

// Quotes the part of the line around the place. Tabs become blanks, so that the caret stands below its
// letter; in text that is not UTF-8 or has characters that one cannot see, question marks replace all bytes
// beyond ASCII.
std::string quote(const Diagnostic& diagnostic) {
  const Place& place = diagnostic.place;
  const auto column = static_cast<std::size_t>(std::max(place.column, 1)) - 1;
  if (diagnostic.source_line.empty() || column > diagnostic.source_line.size()) return {};
  const std::size_t begin = column < kMaxQuotedColumns / 2 ? 0 : column - kMaxQuotedColumns / 2;
  std::string text = diagnostic.source_line.substr(begin, kMaxQuotedColumns);
  for (char& letter : text)
    if (static_cast<unsigned char>(letter) < ' ' || letter == '\x7f') letter = ' ';
  const bool is_visible = utf8_text(text) == text;
  for (char& letter : text)
    if (!is_visible && static_cast<unsigned char>(letter) > '\x7f') letter = '?';
  const std::string number = std::to_string(place.line);
  const std::string margin(number.size(), ' ');
  std::string quoted = fmt::format(" {} | {}\n", number, text);
  if (place.column == 0) return quoted;
  const std::size_t caret = column - begin;
  const std::size_t room = text.size() > caret ? text.size() - caret : 1;
  const std::size_t length = std::min(static_cast<std::size_t>(std::max(place.length, 1)), room);
  return quoted + fmt::format(" {} | {}^{}\n", margin, std::string(caret, ' '), std::string(length - 1, '~'));
}

}  // namespace

MotionError::MotionError(std::vector<Diagnostic> diagnostics)
    : InputError(first_error(diagnostics)), diagnostics_(std::move(diagnostics)) {}

Diagnostics::Diagnostics(std::filesystem::path file, std::string text) : file_(std::move(file)) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines_.push_back(std::move(line));
}

void Diagnostics::add(Diagnostic diagnostic) {
  const bool is_error = diagnostic.severity == Severity::kError;
  const auto same_place = [&](const Diagnostic& other) {
    return is_error && other.severity == Severity::kError && diagnostic.place.line > 0 &&
           other.place.line == diagnostic.place.line && other.place.column == diagnostic.place.column;
  };
  if (std::any_of(all_.begin(), all_.end(), same_place)) return;
  diagnostic.file = file_;
  const auto line = static_cast<std::size_t>(std::max(diagnostic.place.line, 0));
  if (line > 0 && line <= lines_.size()) diagnostic.source_line = lines_[line - 1];
  all_.push_back(std::move(diagnostic));
  error_count_ += is_error ? 1 : 0;
  if (error_count_ == kMaxErrors) throw_errors();
}

void Diagnostics::throw_errors() const {
  if (has_errors()) throw MotionError(all_);
}

std::string print(const Diagnostic& diagnostic) {
  const Place& place = diagnostic.place;
  std::string text = utf8_text(place.option.empty() ? diagnostic.file.string() : place.option);
  if (place.line > 0) text += fmt::format(":{}", place.line);
  if (place.line > 0 && place.column > 0) text += fmt::format(":{}", place.column);
  text += fmt::format(": {}[{}]: found {}, expected {}\n", name_of(diagnostic.severity), diagnostic.code,
                      diagnostic.found, diagnostic.expected);
  text += quote(diagnostic);
  if (!diagnostic.hint.empty()) text += fmt::format("   = {}\n", diagnostic.hint);
  return text;
}

std::string print(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) text += print(diagnostic);
  return text;
}

std::string json_text(const std::vector<Diagnostic>& diagnostics) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Diagnostic& diagnostic : diagnostics) {
    const Place& place = diagnostic.place;
    list.push_back({{"code", diagnostic.code},
                    {"severity", name_of(diagnostic.severity)},
                    {"file", place.option.empty() ? diagnostic.file.string() : place.option},
                    {"line", place.line},
                    {"column", place.column},
                    {"length", place.length},
                    {"found", diagnostic.found},
                    {"expected", diagnostic.expected},
                    {"hint", diagnostic.hint}});
  }
  return list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string did_you_mean(std::string_view misspelt, const std::vector<std::string>& names) {
  const auto nearest = nearest_name(misspelt, names);
  return nearest ? "did you mean `" + *nearest + "`?" : std::string();
}

}  // namespace koboshi::simulation
