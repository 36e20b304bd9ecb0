#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim_board/description/description.h"
#include "sim_board/description/edit/robot_text.h"
#include "studio/document/text_document.h"
#include "tools/robot_file/check/model_check.h"

namespace koboshi::studio {

// A robot's file that is being edited: its text, the robot that it describes, and the edits of a model
// editor.
//
// The text always loads: an edit after which it would not throws InputError and changes nothing. Every
// edit is one step of the undo history and changes the bytes of its values alone.
class ModelDocument final : public TextDocument {
 public:
  // Opens a file. `recovery_folder`: for autosave; empty: none. Throws InputError if the file cannot be
  // read or does not load.
  explicit ModelDocument(const std::filesystem::path& file, std::filesystem::path recovery_folder = {});
  // Opens a recovery as a changed document of its original file.
  [[nodiscard]] static std::unique_ptr<ModelDocument> restore(const Recovery& recovery,
                                                              std::filesystem::path recovery_folder = {});

  const std::string& text() const override { return xml_.text(); }
  const XmlDocument& xml() const { return xml_; }

  // The meaning of the present text, with its findings. References are valid until the next change.
  const sim_board::RobotDescription& robot() const;
  const tools::ModelReport& report() const;
  std::vector<sim_board::ModelElement> elements() const { return sim_board::model_elements(xml_); }
  // Everything that can be edited in the element with this name; empty: there is none.
  std::vector<sim_board::ModelField> fields(const std::string& element) const;

  // Name of the child of <model> in which a line of the text is; empty: none.
  std::string element_at(int line) const;

  // Sets a value, found by its path or key, to what the user has typed; empty removes an optional value.
  void set(const std::string& path, const std::string& typed, sim_board::Sides sides,
           std::string_view drag = {});
  // Replaces the whole text.
  void replace_text(const std::string& text);

  // As Autosave.
  bool autosave(std::int64_t now_unix_s) { return autosave_.write(*this, now_unix_s); }
  void keep_recovery() { autosave_.keep(); }

 private:
  ModelDocument(const std::filesystem::path& file, ReadFile read, std::filesystem::path recovery_folder);

  tools::ModelReport checked(const std::string& text) const;
  void take(XmlDocument edited, const std::string& label, std::string_view drag);
  void check(const std::string& text) const override { static_cast<void>(checked(text)); }
  void take_text(std::string text) override;
  void match_file() override { autosave_.match_file(file()); }

  XmlDocument xml_;
  mutable tools::ModelChecker checker_;  // keeps the meshes that it has read
  mutable std::optional<tools::ModelReport> report_;
  Autosave autosave_;
};

// Whether two texts describe the same robot but for its visuals, so that the same simulation follows.
[[nodiscard]] bool same_physics(const XmlDocument& a, const XmlDocument& b);

}  // namespace koboshi::studio
