#include "simulation/motion_language/compile/named_labels.h"

#include "base/text/text.h"
#include "simulation/motion_language/parse/codes.h"

namespace koboshi::simulation {

NamedLabels::NamedLabel& NamedLabels::entry(const std::string& name) {
  const auto [found, is_new] = labels_.try_emplace(name);
  if (is_new) found->second.label = program_.new_label();
  return found->second;
}

NamedLabels::Label NamedLabels::target(const std::string& name, const Place& use) {
  NamedLabel& label = entry(name);
  if (!label.first_use) label.first_use = use;
  return label.label;
}

void NamedLabels::place(const StepSource& step) {
  NamedLabel& label = entry(step.label);
  if (label.is_placed) {
    diagnostics_.add({.code = code::kSecondLabel,
                      .place = step.place,
                      .found = "a second label '" + one_line(step.label) + "'",
                      .expected = "one of a name"});
    return;
  }
  label.is_placed = true;
  program_.place_label(label.label);
}

std::optional<NamedLabels::Label> NamedLabels::find_placed(const std::string& name) const {
  const auto found = labels_.find(name);
  if (found == labels_.end() || !found->second.is_placed) return std::nullopt;
  return found->second.label;
}

std::vector<std::string> NamedLabels::placed_names() const {
  std::vector<std::string> names;
  for (const auto& [name, label] : labels_) {
    if (label.is_placed) names.push_back(name);
  }
  return names;
}

void NamedLabels::check(const std::string& expected) const {
  for (const auto& [name, label] : labels_) {
    if (label.is_placed) continue;
    diagnostics_.add({.code = code::kUnknownLabel,
                      .place = *label.first_use,
                      .found = "a jump to '" + one_line(name) + "'",
                      .expected = expected,
                      .hint = did_you_mean(name, placed_names())});
  }
}

}  // namespace koboshi::simulation
