#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/edit/xml_document.h"
#include "base/edit/yaml_document.h"
#include "sim_board/description/edit/robot_text.h"
#include "simulation/scenario/scenario.h"
#include "studio/document/text_document.h"
#include "studio/plant/plant_quantity.h"

namespace koboshi::studio {

// A scenario's file of which the key `plant` is edited: the values of the simulated robot that the firmware's
// model does not have.
//
// Every edit is one step of the undo history and changes the bytes of its values alone. Keys and values are
// those of the reader (simulation/assembly/plant.h), and afterwards the simulated robot loads; an edit
// without these throws InputError, which names `plant`, and changes nothing.
class PlantDocument final : public TextDocument {
 public:
  // An entry of the key as it stands in the file.
  struct Entry {
    std::string path{};   // left_shank.mass
    std::string value{};  // 80 g
    std::string shown{};  // the value in the unit of people
    std::string key{};    // of the field, as ModelField::key(); empty: the robot does not have it
    std::string model{};  // value of the model, 50 g; empty: it has none
  };

  // Opens a scenario and the file of its robot, which is the firmware's model. `recovery_folder`: for
  // autosave; empty: none. Throws InputError if one of them cannot be read.
  PlantDocument(const std::filesystem::path& scenario, const std::filesystem::path& robot,
                std::filesystem::path recovery_folder = {});

  const std::string& text() const override { return yaml_.text(); }
  const XmlDocument& model() const { return model_; }
  // The text of the simulated robot; that of the model while there is a problem().
  const XmlDocument& plant() const { return plant_; }
  // The scenario begins with another robot from now on. Throws InputError if it cannot be read.
  void set_robot(const std::filesystem::path& robot);
  // Why the entries do not fit the robot; empty: they do.
  const std::string& problem() const { return problem_; }

  // In the order of the file, in which they take effect.
  const std::vector<simulation::PlantSetting>& settings() const { return settings_; }
  std::vector<Entry> entries() const;
  // The simulated robot's values in words: "left_shank.mass = 80 g (model: 50 g)".
  static std::string text_of(const Entry& entry);
  // The entries that these settings of a scenario would be.
  std::vector<Entry> entries_of(const std::vector<simulation::PlantSetting>& settings) const;

  // Sets values, found by their paths, to what the user has typed, as one edit. A value that becomes that of
  // the model leaves the file. Edits with one non-empty `drag` merge into one step until end_drag().
  void set(const std::vector<sim_board::ModelSetting>& typed, sim_board::Sides sides,
           std::string_view drag = {});
  void set(const PlantQuantity& quantity, double value, sim_board::Sides sides, std::string_view drag = {});
  // Removes the entries of a field, by its key; of both sides of the robot if asked for.
  void erase(const std::string& key, sim_board::Sides sides);
  // Removes one entry.
  void erase_entry(std::size_t index);
  void erase_all();
  // Replaces the whole text.
  void replace_text(const std::string& text);

  // The present text for a file in another folder: names of files lead to those that they name now.
  std::string text_for(const std::filesystem::path& folder) const;
  // The key of the present text as an override of the file's.
  Override override_value() const;

  // As Autosave.
  bool autosave(std::int64_t now_unix_s) { return autosave_.write(*this, now_unix_s); }
  void keep_recovery() { autosave_.keep(); }

 private:
  struct Opened {
    ReadFile read;
    YamlDocument yaml;
  };
  PlantDocument(std::filesystem::path scenario, Opened opened, const std::filesystem::path& robot,
                std::filesystem::path recovery_folder);
  static Opened open(const std::filesystem::path& scenario);

  void check(const std::string& text) const override;
  void take_text(std::string text) override;
  void match_file() override { autosave_.match_file(file()); }
  XmlDocument plant_of(const std::vector<simulation::PlantSetting>& settings) const;
  const sim_board::ModelField& field_at(const std::string& path) const;
  const sim_board::ModelField* find_field_at(const std::string& path) const;  // nullptr: there is none
  bool has_value(const YamlDocument& yaml, const sim_board::ModelField& field,
                 const std::string& value) const;
  void set_one(YamlDocument& yaml, const std::string& path, const std::string& typed) const;
  std::string file_text_of(const sim_board::ModelField& field, const std::string& typed) const;
  std::vector<std::string> both_sides(const std::string& key, sim_board::Sides sides) const;
  void take(YamlDocument edited, const std::string& label, std::string_view drag = {});
  void follow_text();

  YamlDocument yaml_;
  XmlDocument model_;
  XmlDocument plant_;
  std::vector<simulation::PlantSetting> settings_;
  std::string problem_;
  mutable std::map<std::string, sim_board::ModelField> fields_;  // of the model, found before; by path
  Autosave autosave_;
};

}  // namespace koboshi::studio
