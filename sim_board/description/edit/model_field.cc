#include "sim_board/description/edit/model_field.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "sim_board/description/schema/sdf_schema.h"

namespace koboshi::sim_board {

namespace {

constexpr std::size_t kPoseNumbers = 6;

// Names and kinds of elements are no values: other parts of the file refer to them.
bool is_editable(const XmlRule& element, const std::string& attribute) {
  if (attribute == "type") return element.name == "koboshi:servo";
  return attribute != "name" && attribute != "version" && !attribute.starts_with("xmlns");
}

// Half of a text of six numbers.
std::optional<std::string> half(const std::optional<std::string>& pose, PosePart part) {
  if (!pose) return std::nullopt;
  std::istringstream words(*pose);
  std::vector<std::string> all;
  for (std::string word; words >> word;) all.push_back(word);
  if (all.size() != kPoseNumbers) return pose;
  const std::size_t first = part == PosePart::kPosition ? 0 : 3;
  return all[first] + " " + all[first + 1] + " " + all[first + 2];
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
}

class FieldFinder {
 public:
  std::vector<ModelField> run(const XmlRule& rule, const XmlPart& part, std::size_t number) {
    visit(rule, &part, number);
    return std::move(fields_);
  }

 private:
  void visit(const XmlRule& rule, const XmlPart* part, std::optional<std::size_t> number) {
    const std::string* name = part != nullptr ? part->attribute("name") : nullptr;
    steps_.push_back({&rule, number, name != nullptr ? *name : std::string()});
    for (const XmlAttributeRule& attribute : rule.attributes)
      if (is_editable(rule, attribute.name)) add_attribute(attribute, part);
    if (rule.content == XmlContent::kChildren) {
      for (const XmlRule& child : rule.children) visit_children(child, part);
    } else if (rule.content != XmlContent::kAnything) {
      add_text(rule, part);
    }
    steps_.pop_back();
  }

  void visit_children(const XmlRule& rule, const XmlPart* parent) {
    bool is_missing = true;
    if (parent != nullptr) {
      const auto elements = parent->elements();
      for (std::size_t i = 0; i < elements.size(); ++i) {
        if (elements[i]->name != rule.name) continue;
        is_missing = false;
        visit(rule, elements[i], i);
      }
    }
    if (is_missing && rule.count != XmlCount::kRepeated) visit(rule, nullptr, std::nullopt);
  }

  void add_attribute(const XmlAttributeRule& attribute, const XmlPart* part) {
    const std::string* value = part != nullptr ? part->attribute(attribute.name) : nullptr;
    fields_.push_back({.steps = steps_,
                       .attribute = &attribute,
                       .words = words_with(plain_tag(attribute.name)),
                       .value = value != nullptr ? std::optional(*value) : std::nullopt});
  }

  std::vector<std::string> words_with(const std::string& last = {}) const {
    std::vector<std::string> words;
    for (const ModelField::Step& step : steps_) {
      words.push_back(plain_tag(step.rule->name));
      if (!step.name.empty()) words.push_back(step.name);
    }
    if (!last.empty()) words.push_back(last);
    return words;
  }

  void add_text(const XmlRule& rule, const XmlPart* part) {
    ModelField field{.steps = steps_, .words = words_with()};
    if (part != nullptr) field.value = trimmed(part->content());
    fields_.push_back(field);
    if (rule.content != XmlContent::kNumbers || rule.numbers != kPoseNumbers) return;
    for (const PosePart pose_part : {PosePart::kPosition, PosePart::kRotation}) {
      ModelField& added = fields_.emplace_back(field);
      added.part = pose_part;
      added.words.push_back(pose_part == PosePart::kPosition ? "position" : "rotation");
      added.value = half(field.value, pose_part);
    }
  }

  std::vector<ModelField::Step> steps_;
  std::vector<ModelField> fields_;
};

const XmlRule& model_rule() { return sdf_rule().children.front(); }

std::size_t model_number(const XmlDocument& document) {
  const auto elements = document.root().elements();
  const auto found = std::ranges::find(elements, "model", [](const XmlPart* part) { return part->name; });
  return static_cast<std::size_t>(found - elements.begin());
}

// The shortest path with which find_field() finds this field among those of its element.
std::string shortest_path(const std::vector<ModelField>& fields, const ModelField& field) {
  const auto first = [](const ModelField::Step& step) {
    return step.name.empty() ? plain_tag(step.rule->name) : step.name;
  };
  std::vector<std::string> words{first(field.steps.front()), field.last_word()};
  if (match_field(fields, words) == &field) return words[0] + "." + words[1];
  std::string named = words[0];
  for (std::size_t i = 1; i < field.steps.size(); ++i)
    if (!field.steps[i].name.empty()) named += "." + field.steps[i].name;
  named += "." + words[1];
  if (match_field(fields, path_words(named)) == &field) return named;
  // With the element around it: gyro.bias.
  const std::size_t outer = field.steps.size() - (field.attribute != nullptr ? 1 : 2);
  const std::string within = words[0] + "." + first(field.steps[outer]) + "." + words[1];
  if (match_field(fields, path_words(within)) == &field) return within;
  return field.key();
}

}  // namespace

std::string plain_tag(const std::string& tag) {
  const std::size_t colon = tag.find(':');
  return colon == std::string::npos ? tag : tag.substr(colon + 1);
}

bool ModelField::is_required() const {
  return attribute != nullptr ? attribute->required : rule().count == XmlCount::kRequired;
}

std::size_t ModelField::numbers() const {
  if (content() != XmlContent::kNumbers) return 0;
  if (attribute != nullptr) return 1;
  return part == PosePart::kWhole ? rule().numbers : kPoseNumbers / 2;
}

std::string ModelField::unit() const {
  if (part == PosePart::kPosition) return "m";
  if (part == PosePart::kRotation) return "rad";
  return note().unit;
}

std::string ModelField::fallback() const {
  return part == PosePart::kWhole ? note().fallback : half(note().fallback, part).value_or("");
}

const std::vector<std::string>& ModelField::choices() const {
  return attribute != nullptr ? attribute->choices : rule().choices;
}

std::string ModelField::expected() const {
  const std::string text = describe_values(content(), numbers(), range(), choices());
  const std::string quantity = content() == XmlContent::kText ? "" : unit();
  return quantity.empty() || quantity == "1" ? text : text + " in " + quantity;
}

std::string ModelField::key() const {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ".") + word;
  return text;
}

std::optional<XmlPath> ModelField::element_path(const XmlDocument& document) const {
  XmlPath path{model_number(document)};
  for (const Step& step : steps) {
    if (!step.number) return std::nullopt;
    path.push_back(*step.number);
  }
  return path;
}

std::vector<ModelElement> model_elements(const XmlDocument& document) {
  std::vector<ModelElement> all;
  const XmlPart* model = document.find({model_number(document)});
  if (model == nullptr) return all;
  const auto elements = model->elements();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto rule = std::ranges::find(model_rule().children, elements[i]->name, &XmlRule::name);
    if (rule == model_rule().children.end()) continue;
    const std::string* name = elements[i]->attribute("name");
    all.push_back({&*rule, i, name != nullptr ? *name : plain_tag(rule->name)});
  }
  return all;
}

std::vector<ModelField> model_fields(const XmlDocument& document, const ModelElement& element) {
  const XmlPart& part = *document.find({model_number(document), element.number});
  std::vector<ModelField> fields = FieldFinder().run(*element.rule, part, element.number);
  for (ModelField& field : fields) field.path = shortest_path(fields, field);
  return fields;
}

}  // namespace koboshi::sim_board
