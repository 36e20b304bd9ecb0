// The grammar of the paths that name a field.

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/edit/model_field.h"

namespace koboshi::sim_board {
namespace {

// Words of people for keys of SDF.
struct Alias {
  std::string_view word;
  std::string_view element;    // the tag
  std::string_view attribute;  // empty: the element's text
};
constexpr std::array kAliases = {
    Alias{"axis", "xyz", ""},
    Alias{"zoom", "scale", ""},
    Alias{"stl", "uri", ""},
    Alias{"friction", "mu", ""},
    Alias{"erp", "soft_erp", ""},
    Alias{"cfm", "soft_cfm", ""},
    Alias{"bounce", "restitution_coefficient", ""},
    Alias{"colour", "diffuse", ""},
    Alias{"speed", "velocity", ""},
    Alias{"servo", "koboshi:servo", "type"},
};

const Alias* alias_of(const ModelField& field) {
  const auto found = std::ranges::find_if(kAliases, [&](const Alias& alias) {
    return alias.element == field.rule().name && field.part == PosePart::kWhole &&
           alias.attribute == (field.attribute != nullptr ? field.attribute->name : std::string());
  });
  return found == kAliases.end() ? nullptr : &*found;
}

bool is_com(const ModelField& field) {
  return field.part == PosePart::kPosition && field.steps.size() > 1 &&
         field.steps[field.steps.size() - 2].rule->name == "inertial";
}

bool is_last_word(const ModelField& field, const std::string& word) {
  if (word == field.last_word() || (word == "com" && is_com(field))) return true;
  const Alias* alias = alias_of(field);
  return alias != nullptr && alias->word == word;
}

bool names_step(const ModelField::Step& step, const std::string& word) {
  return word == plain_tag(step.rule->name) || (!step.name.empty() && word == step.name);
}

// Whether the words name the first element, then some of those within, in their order, and the value.
bool matches(const ModelField& field, const std::vector<std::string>& words) {
  if (words.size() < 2 || !is_last_word(field, words.back())) return false;
  if (!names_step(field.steps.front(), words.front())) return false;
  const std::vector<std::string>& inner = field.words;
  const std::size_t last = inner.size() - 1;
  std::size_t at = words.front() == inner.front() ? 1 : 2;
  for (std::size_t i = 1; i + 1 < words.size(); ++i) {
    while (at < last && inner[at] != words[i]) ++at;
    if (at++ >= last) return false;
  }
  return true;
}

// The nearest field has the fewest elements around it; one that the file has comes before one that it lacks.
std::pair<std::size_t, bool> distance(const ModelField& field) {
  return {field.steps.size() + (field.attribute != nullptr ? 1 : 0), !field.value};
}

std::vector<const ModelField*> nearest_matches(const std::vector<ModelField>& fields,
                                               const std::vector<std::string>& words) {
  std::vector<const ModelField*> found;
  for (const ModelField& field : fields) {
    if (!matches(field, words)) continue;
    if (!found.empty() && distance(field) < distance(*found.front())) found.clear();
    if (found.empty() || distance(field) == distance(*found.front())) found.push_back(&field);
  }
  return found;
}

std::string alternatives(const std::vector<const ModelField*>& fields) {
  constexpr std::size_t kShown = 3;
  std::vector<std::string> paths;
  for (const ModelField* field : fields)
    if (paths.size() < kShown) paths.push_back(field->path);
  return (fields.size() > kShown ? "one of " + std::to_string(fields.size()) + ", such as " : "") +
         join_alternatives(paths);
}

}  // namespace

std::string field_label(const ModelField& field) {
  if (is_com(field)) return "centre of mass";
  const Alias* alias = alias_of(field);
  return alias != nullptr ? std::string(alias->word) : field.last_word();
}

std::vector<std::string> path_words(const std::string& path) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    words.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

const ModelField* match_field(const std::vector<ModelField>& fields, const std::vector<std::string>& words) {
  const auto found = nearest_matches(fields, words);
  return found.size() == 1 ? found.front() : nullptr;
}

ModelField find_field(const XmlDocument& document, const std::string& path) {
  const std::vector<std::string> words = path_words(path);
  const std::string shown = one_line(path);
  std::vector<ModelField> fields;
  std::set<std::string> names;
  for (const ModelElement& element : model_elements(document)) {
    names.insert(element.name);
    if (element.name != words.front() && plain_tag(element.rule->name) != words.front()) continue;
    const auto more = model_fields(document, element);
    fields.insert(fields.end(), more.begin(), more.end());
  }
  if (fields.empty()) {
    const std::vector<std::string> all(names.begin(), names.end());
    throw InputError(document.source(), 0, shown,
                     expected_names(words.front(), all) + ", then a value: left_shank.mass");
  }
  const auto found = nearest_matches(fields, words);
  if (found.size() == 1) return *found.front();
  if (found.size() > 1)
    throw InputError(document.source(), 0, "several values named " + shown, alternatives(found));
  std::vector<std::string> last;
  for (const ModelField& field : fields)
    if (std::ranges::find(last, field.last_word()) == last.end()) last.push_back(field.last_word());
  throw InputError(document.source(), 0, shown, "a value of it: " + expected_names(words.back(), last));
}

}  // namespace koboshi::sim_board
