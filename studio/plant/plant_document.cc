#include "studio/plant/plant_document.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "base/text/error.h"
#include "base/yaml/yaml_reader.h"
#include "sim_board/description/edit/field_value.h"
#include "sim_board/description/load.h"
#include "simulation/assembly/plant.h"
#include "simulation/scenario/events_text.h"
#include "simulation/scenario/reader.h"
#include "studio/document/edit_support.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKey = "plant";

// Writes a key or a value without quotes where YAML reads the same text: left_shank.mass: 0 0 -66 mm.
std::string plain_scalar(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-^/ ";
  constexpr std::array<std::string_view, 6> kWords{"true", "false", "null", "yes", "no", "on"};
  const bool is_plain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos &&
                        text.front() != ' ' && text.back() != ' ' && !text.starts_with("- ") && text != "-";
  return is_plain && std::ranges::find(kWords, text) == kWords.end() ? text : yaml_scalar(text);
}

// The settings of a document, whose errors name the key alone: the text that the user edits has no lines.
std::vector<simulation::PlantSetting> settings_in(const YamlNode& tree) {
  const YamlFile file(kKey, tree);
  std::vector<simulation::PlantSetting> settings = simulation::read_plant_settings(file.root());
  for (simulation::PlantSetting& setting : settings) {
    setting.field.source = kKey;
    setting.field.line = 0;
  }
  return settings;
}

// The key of a value, or of the pose of which it is a half.
std::string whole_key(const sim_board::ModelField& field) {
  if (field.part == sim_board::PosePart::kWhole) return field.key();
  return field.key().substr(0, field.key().rfind('.'));
}

// The name of a value of the other side that is like the one of this side: right_shank.com for
// left_shank.com.
std::string path_beside(const std::string& path, const sim_board::ModelField& field,
                        const sim_board::ModelField& other) {
  const std::string& name = field.steps.front().name;
  const bool is_named = path.starts_with(name + ".") && path.find('.') == path.rfind('.');
  return is_named ? other.steps.front().name + path.substr(name.size()) : other.path;
}

// Where an entry stands: "plant", "trunk", "com" for trunk.com.
struct EntryPlace {
  Steps steps;
  std::string path;
};

void add_places(const YamlNode& map, const EntryPlace& parent, std::vector<EntryPlace>& places) {
  for (const YamlNode& item : map.items) {
    EntryPlace place = parent;
    place.steps.push_back(item.key);
    place.path += (place.path.empty() ? "" : ".") + item.key;
    if (item.kind == YamlNode::Kind::kMap)
      add_places(item, place, places);
    else
      places.push_back(std::move(place));
  }
}

// In the order of settings_in().
std::vector<EntryPlace> places_in(const YamlNode& tree) {
  std::vector<EntryPlace> places;
  if (const YamlNode* map = tree.find(kKey)) add_places(*map, {{kKey}, {}}, places);
  return places;
}

// Adds the edits that give a document the scalars of another one with the same keys.
void add_differences(const YamlNode& from, const YamlNode& to, const Steps& steps,
                     std::vector<YamlEdit>& edits) {
  if (from.kind == YamlNode::Kind::kScalar && from.scalar != to.scalar)
    edits.push_back({YamlEdit::Kind::kSet, YamlPath(steps), plain_scalar(to.scalar)});
  for (std::size_t i = 0; i < from.items.size(); ++i) {
    Steps inner = steps;
    inner.push_back(from.kind == YamlNode::Kind::kList ? std::to_string(i) : from.items[i].key);
    add_differences(from.items[i], to.items[i], inner, edits);
  }
}

// Removes an entry, with the maps that would be empty without it.
void erase_place(YamlDocument& yaml, const EntryPlace& place) {
  Steps steps = place.steps;
  while (steps.size() > 1) {
    const Steps parent(steps.begin(), steps.end() - 1);
    if (find_node(yaml.tree(), YamlPath(parent))->items.size() > 1) break;
    steps = parent;
  }
  yaml.erase(YamlPath(steps));
}

// Adds an entry; the key stands behind the robot that it changes.
void add_entry(YamlDocument& yaml, const std::string& path, const std::string& typed) {
  const YamlNode* map = yaml.tree().find(kKey);
  if (map != nullptr && map->kind == YamlNode::Kind::kMap && !map->items.empty())
    return yaml.set(YamlPath(Steps{kKey, path}), plain_scalar(typed));
  if (map != nullptr) yaml.erase(kKey);
  const auto& items = yaml.tree().items;
  const auto robot = std::ranges::find(items, "robot", &YamlNode::key);
  const auto index = static_cast<std::size_t>(robot - items.begin()) + (robot == items.end() ? 0 : 1);
  yaml.insert_items(YamlPath(), index,
                    std::string(kKey) + ":\n  " + plain_scalar(path) + ": " + plain_scalar(typed) + "\n");
}

}  // namespace

PlantDocument::Opened PlantDocument::open(const fs::path& scenario) {
  ReadFile read = read_file_with_state(scenario);
  YamlDocument yaml(scenario, read.text);
  static_cast<void>(yaml.places());  // refuses what cannot be edited
  return {std::move(read), std::move(yaml)};
}

PlantDocument::PlantDocument(const fs::path& scenario, const fs::path& robot, fs::path recovery_folder)
    : PlantDocument(fs::absolute(scenario), open(scenario), robot, std::move(recovery_folder)) {}

PlantDocument::PlantDocument(fs::path scenario, Opened opened, const fs::path& robot,
                             fs::path recovery_folder)
    : TextDocument(std::move(scenario), opened.read.state),
      yaml_(std::move(opened.yaml)),
      model_(robot),
      plant_(model_),
      autosave_(std::move(recovery_folder)) {
  follow_text();
}

void PlantDocument::set_robot(const fs::path& robot) {
  XmlDocument model(robot);
  if (model.source() == model_.source() && model.text() == model_.text()) return;
  model_ = std::move(model);
  fields_.clear();
  follow_text();
}

// --- The text and its meaning

XmlDocument PlantDocument::plant_of(const std::vector<simulation::PlantSetting>& settings) const {
  XmlDocument plant = model_;
  simulation::apply_plant(plant, settings);
  try {
    static_cast<void>(sim_board::load_robot(plant.source(), plant.text()));
  } catch (const InputError& error) {
    // The lines are those of a text that nobody sees.
    throw InputError(kKey, 0, error.found(), error.expected());
  }
  return plant;
}

void PlantDocument::follow_text() {
  settings_.clear();
  plant_ = model_;
  problem_.clear();
  try {
    settings_ = settings_in(yaml_.tree());
    plant_ = plant_of(settings_);
  } catch (const InputError& error) {
    problem_ = error.what();
  }
}

void PlantDocument::check(const std::string& text) const {
  const YamlDocument yaml(file(), text);
  static_cast<void>(yaml.places());
  static_cast<void>(settings_in(yaml.tree()));
}

void PlantDocument::take_text(std::string text) {
  yaml_.replace_text(std::move(text));
  follow_text();
}

void PlantDocument::take(YamlDocument edited, const std::string& label, std::string_view drag) {
  if (edited.text() == text()) return;
  std::vector<simulation::PlantSetting> settings = settings_in(edited.tree());
  XmlDocument plant = plant_of(settings);
  const std::string before = text();
  yaml_ = std::move(edited);
  settings_ = std::move(settings);
  plant_ = std::move(plant);
  problem_.clear();
  record(before, label, drag);
}

void PlantDocument::replace_text(const std::string& text) {
  check(text);
  replace(text, "Restore");
}

std::string PlantDocument::text_for(const fs::path& folder) const {
  std::vector<YamlEdit> edits;
  add_differences(yaml_.tree(), simulation::with_moved_files(yaml_.tree(), file().parent_path(), folder), {},
                  edits);
  YamlDocument moved = yaml_;
  moved.edit(edits);
  return moved.text();
}

Override PlantDocument::override_value() const {
  std::string map;
  for (const simulation::PlantSetting& setting : settings_)
    map += (map.empty() ? "" : ", ") + plain_scalar(setting.field.text) + ": " + plain_scalar(setting.value);
  return {kKey, "{" + map + "}", kKey};
}

// --- Entries

const sim_board::ModelField& PlantDocument::field_at(const std::string& path) const {
  const auto known = fields_.find(path);
  if (known != fields_.end()) return known->second;
  try {
    return fields_.emplace(path, sim_board::find_field(model_, path)).first->second;
  } catch (const InputError& error) {
    throw InputError(kKey, 0, error.found(), error.expected());
  }
}

const sim_board::ModelField* PlantDocument::find_field_at(const std::string& path) const {
  try {
    return &field_at(path);
  } catch (const InputError&) {
    return nullptr;
  }
}

std::vector<PlantDocument::Entry> PlantDocument::entries() const { return entries_of(settings_); }

std::vector<PlantDocument::Entry> PlantDocument::entries_of(
    const std::vector<simulation::PlantSetting>& settings) const {
  std::vector<Entry> entries;
  for (const simulation::PlantSetting& setting : settings) {
    Entry& entry = entries.emplace_back(Entry{.path = setting.field.text, .value = setting.value});
    const sim_board::ModelField* field = find_field_at(entry.path);
    entry.shown = entry.value;
    if (field == nullptr) continue;
    entry.shown = shown_typed(model_, *field, entry.value);
    entry.key = field->key();
    entry.model = shown_value(*field);
  }
  return entries;
}

std::string PlantDocument::text_of(const Entry& entry) {
  return entry.path + " = " + entry.shown + (entry.model.empty() ? "" : " (model: " + entry.model + ")");
}

// --- Edits

// Whether the simulated robot of a document has this value.
bool PlantDocument::has_value(const YamlDocument& yaml, const sim_board::ModelField& field,
                              const std::string& value) const {
  XmlDocument plant = model_;
  simulation::apply_plant(plant, settings_in(yaml.tree()));
  const sim_board::ModelField now = sim_board::find_field(plant, field.key());
  return same_value(value, now.value.value_or(now.fallback()));
}

// The last entry of a value stays in its place, unless a later one of a value around it, such as a pose,
// would replace it.
void PlantDocument::set_one(YamlDocument& yaml, const std::string& path, const std::string& typed) const {
  const sim_board::ModelField& field = field_at(path);
  if (typed.empty()) throw InputError(kKey, 0, path + " without a value", field.expected());
  const std::string value = file_text_of(field, typed);
  YamlDocument without = yaml;
  std::optional<EntryPlace> last;
  bool is_alone = true;  // no entry sets a part of the value, or more than it
  for (const EntryPlace& place : places_in(yaml.tree())) {
    const sim_board::ModelField* other = find_field_at(place.path);
    if (other == nullptr || whole_key(*other) != whole_key(field)) continue;
    is_alone = is_alone && other->key() == field.key();
    if (other->key() != field.key()) continue;
    erase_place(without, place);
    last = place;
  }
  const bool is_of_model =
      is_alone ? same_value(value, field.value.value_or(field.fallback())) : has_value(without, field, value);
  if (last && !is_of_model) {
    YamlDocument edited = yaml;
    edited.set(YamlPath(last->steps), plain_scalar(typed));
    if (is_alone || has_value(edited, field, value)) {
      yaml = std::move(edited);
      return;
    }
  }
  yaml = std::move(without);
  if (!is_of_model) add_entry(yaml, path, typed);
}

std::string PlantDocument::file_text_of(const sim_board::ModelField& field, const std::string& typed) const {
  try {
    return sim_board::file_text(model_, field, typed);
  } catch (const InputError& error) {
    throw InputError(kKey, 0, error.found(), error.expected());
  }
}

void PlantDocument::set(const std::vector<sim_board::ModelSetting>& typed, sim_board::Sides sides,
                        std::string_view drag) {
  YamlDocument edited = yaml_;
  for (const auto& [path, value] : typed) {
    set_one(edited, path, value);
    const sim_board::ModelField& field = field_at(path);
    if (sides == sim_board::Sides::kOne || !sim_board::has_other_side(model_, field)) continue;
    const sim_board::MirroredValue other =
        sim_board::mirrored_value(model_, field, sim_board::file_text(model_, field, value));
    const bool is_same = sim_board::file_text(model_, other.field, value) == other.value;
    const std::string beside = path_beside(path, field, other.field);
    const sim_board::ModelField* named = find_field_at(beside);
    const bool is_named = named != nullptr && named->key() == other.field.key();
    set_one(edited, is_named ? beside : other.field.path, is_same ? value : other.value);
  }
  take(std::move(edited), "Set " + (typed.empty() ? std::string("nothing") : typed.front().path), drag);
}

void PlantDocument::set(const PlantQuantity& quantity, double value, sim_board::Sides sides,
                        std::string_view drag) {
  set({{quantity.path, typed_value(quantity, model_, value)}}, sides, drag);
}

std::vector<std::string> PlantDocument::both_sides(const std::string& key, sim_board::Sides sides) const {
  std::vector<std::string> keys{key};
  const sim_board::ModelField& field = field_at(key);
  if (sides == sim_board::Sides::kBoth && field.value && sim_board::has_other_side(model_, field))
    keys.push_back(sim_board::mirrored_value(model_, field, *field.value).field.key());
  return keys;
}

void PlantDocument::erase(const std::string& key, sim_board::Sides sides) {
  YamlDocument edited = yaml_;
  for (const std::string& one : both_sides(key, sides))
    for (const EntryPlace& place : places_in(yaml_.tree()))
      if (const auto* field = find_field_at(place.path); field != nullptr && field->key() == one)
        erase_place(edited, place);
  take(std::move(edited), "Model's value of " + field_at(key).path);
}

void PlantDocument::erase_entry(std::size_t index) {
  const auto places = places_in(yaml_.tree());
  if (index >= places.size()) return;
  YamlDocument edited = yaml_;
  erase_place(edited, places[index]);
  take(std::move(edited), "Model's value of " + places[index].path);
}

void PlantDocument::erase_all() {
  if (yaml_.tree().find(kKey) == nullptr) return;
  YamlDocument edited = yaml_;
  edited.erase(kKey);
  take(std::move(edited), "The model's values");
}

}  // namespace koboshi::studio
