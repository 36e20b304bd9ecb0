#include "studio/model/field_labels.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace koboshi::studio {
namespace {

// Elements whose name says nothing beside that of the value.
bool is_wrapper(const std::string& tag) {
  constexpr std::array kWrappers = {"geometry", "mesh",   "box",          "surface",  "friction",
                                    "contact",  "bounce", "ode",          "material", "limit",
                                    "inertia",  "pose",   "force_torque", "xyz",      "axis"};
  return std::ranges::find(kWrappers, tag) != kWrappers.end();
}

}  // namespace

// A pose's own attributes keep its name.
std::string label_of(const sim_board::ModelField& field) {
  const std::size_t last =
      field.attribute != nullptr || field.part != sim_board::PosePart::kWhole ? 0 : 1;  // the value's own
  std::string label;
  for (std::size_t i = 2; i + last < field.steps.size(); ++i)
    if (const std::string tag = sim_board::plain_tag(field.steps[i].rule->name); !is_wrapper(tag))
      label += tag + " ";
  return label + sim_board::field_label(field);
}

bool has_inner_group(const sim_board::ModelField& field) {
  return field.steps.size() > 1 && field.steps[1].rule->content == XmlContent::kChildren;
}

std::string group_of(const sim_board::ModelField& field) {
  const sim_board::ModelField::Step& at = field.steps[has_inner_group(field) ? 1 : 0];
  return sim_board::plain_tag(at.rule->name) + (at.name.empty() ? "" : " " + at.name);
}

bool is_shown(const sim_board::ModelField& field) {
  if (field.part == sim_board::PosePart::kWhole && field.attribute == nullptr && field.numbers() == 6)
    return false;
  if (field.value) return true;
  const std::size_t holders = field.steps.size() - (field.attribute != nullptr ? 0 : 1);
  return std::all_of(field.steps.begin(), field.steps.begin() + static_cast<std::ptrdiff_t>(holders),
                     [](const auto& step) { return step.number.has_value(); });
}

}  // namespace koboshi::studio
