#include "studio/document/motion_document.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/motion_language/parse/parse.h"
#include "studio/document/edit_support.h"
#include "tools/motion_edit/format.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 24;
constexpr double kStandTime_s = 1.5;

bool is_printable(char letter) { return letter >= ' ' && letter <= '~'; }

void check_name(const std::string& name, const fs::path& file, int line) {
  if (name.empty() || name.size() > kMaxName || !std::ranges::all_of(name, is_printable))
    throw InputError(file, line, "the name '" + one_line(name) + "'", "1 to 24 printable ASCII letters");
}

// The name of a motion in this file, as far as it can have that name.
std::string name_of_file(const fs::path& file) {
  std::string name = file.stem().string().substr(0, kMaxName);
  std::ranges::replace_if(name, std::not_fn(is_printable), '_');
  return name;
}

std::string new_motion(const MotionRobot& robot, const std::string& name) {
  check_name(name, name, 0);
  const auto all = static_cast<std::uint32_t>((std::uint64_t{1} << robot.model.joint_names.size()) - 1);
  return "version: 2\nrobot: " + yaml_scalar(robot.model.robot) + "\nname: " + yaml_scalar(name) +
         "\nposes:\n  stand: " + pose_text(robot, robot.standing_rad, all, name) +
         "\nsteps:\n  - {pose: stand, time_s: " + koboshi::number_text(kStandTime_s) + "}\n";
}

}  // namespace

MotionDocument::MotionDocument(std::shared_ptr<const MotionRobot> robot, Start start,
                               fs::path recovery_folder)
    : TextDocument(std::move(start.file), start.disk),
      robot_(std::move(robot)),
      autosave_(std::move(recovery_folder)) {
  take_text(std::move(start.text));
}

MotionDocument::MotionDocument(std::shared_ptr<const MotionRobot> robot, const fs::path& file,
                               fs::path recovery_folder)
    : MotionDocument(
          std::move(robot),
          [&] {
            ReadFile read = read_file_with_state(file);
            return Start{fs::absolute(file), std::move(read.text), read.state};
          }(),
          std::move(recovery_folder)) {}

std::unique_ptr<MotionDocument> MotionDocument::begin(std::shared_ptr<const MotionRobot> robot,
                                                      const std::string& name, fs::path recovery_folder) {
  Start start{{}, new_motion(*robot, name), {}};
  std::unique_ptr<MotionDocument> document(
      new MotionDocument(std::move(robot), std::move(start), std::move(recovery_folder)));
  document->forget_saved();
  return document;
}

std::unique_ptr<MotionDocument> MotionDocument::restore(std::shared_ptr<const MotionRobot> robot,
                                                        const Recovery& recovery, fs::path recovery_folder) {
  if (!recovery.original.empty() && fs::exists(recovery.original)) {
    auto document =
        std::make_unique<MotionDocument>(std::move(robot), recovery.original, std::move(recovery_folder));
    document->replace(recovery.text, "Restore");
    return document;
  }
  Start start{recovery.original, recovery.text, {}};
  std::unique_ptr<MotionDocument> document(
      new MotionDocument(std::move(robot), std::move(start), std::move(recovery_folder)));
  document->forget_saved();
  return document;
}

const YamlNode* MotionDocument::tree() const { return yaml_ ? &yaml_->tree() : nullptr; }
const simulation::MotionSource* MotionDocument::source() const { return source_ ? &*source_ : nullptr; }
const simulation::CompiledMotion* MotionDocument::compiled() const {
  return compiled_ ? &*compiled_ : nullptr;
}

fs::path MotionDocument::source_name() const { return file().empty() ? fs::path("untitled.yaml") : file(); }

const YamlDocument& MotionDocument::yaml() const {
  if (yaml_) return *yaml_;
  const int line = diagnostics_.empty() ? 0 : diagnostics_.front().place.line;
  throw InputError(source_name(), line, "a text that is no YAML", "its errors corrected first");
}

const MotionRow& MotionDocument::row(std::size_t row) const {
  static_cast<void>(yaml());
  const std::size_t selected[]{row};
  static_cast<void>(runs_of(rows_, selected, source_name()));
  return rows_.rows[row];
}

void MotionDocument::require_version_2(const std::string& construct) const {
  const YamlNode& tree = yaml().tree();
  if (version_of(tree) >= 2) return;
  const YamlNode* version = tree.find("version");
  throw InputError(source_name(), version != nullptr ? version->line : 0, "version 1",
                   "version 2 for " + construct + ": upgrade the motion");
}

// --- Text

void MotionDocument::edit(std::string_view label, std::string_view drag,
                          const std::function<void(YamlDocument&)>& change) {
  static_cast<void>(yaml());
  try {
    change(*yaml_);
  } catch (...) {
    if (yaml_->text() != text_) yaml_.emplace(source_name(), text_);
    throw;
  }
  if (yaml_->text() == text_) return;
  const std::string before = std::exchange(text_, yaml_->text());
  record(before, label, drag);
  analyse();
}

void MotionDocument::take_text(std::string text) {
  text_ = std::move(text);
  try {
    if (yaml_) {
      yaml_->replace_text(text_);
    } else {
      yaml_.emplace(source_name(), text_);
      static_cast<void>(yaml_->places());
    }
  } catch (const InputError&) {
    yaml_.reset();  // analyse reports it
  }
  analyse();
}

void MotionDocument::analyse() {
  source_.reset();
  compiled_.reset();
  rows_ = {};
  simulation::Diagnostics diagnostics(source_name(), text_);
  try {
    if (!yaml_) {
      static_cast<void>(simulation::read_motion_text(source_name(), text_));
      // Only libfyaml refuses it.
      static_cast<void>(YamlDocument(source_name(), text_).places());
    }
    source_ = simulation::parse_motion(source_name(), yaml_->tree(), robot_->model, diagnostics);
    if (!diagnostics.has_errors()) {
      simulation::CompiledMotion compiled = simulation::compile_motion(*source_, robot_->model, diagnostics);
      if (!diagnostics.has_errors()) compiled_ = std::move(compiled);
    }
    diagnostics_ = diagnostics.all();
  } catch (const simulation::MotionError& error) {
    diagnostics_ = error.diagnostics();
  } catch (const InputError& error) {
    diagnostics.add({.code = "M001",
                     .place = {.line = error.line()},
                     .found = error.found(),
                     .expected = error.expected()});
    diagnostics_ = diagnostics.all();
  }
  if (yaml_) rows_ = make_rows(yaml_->tree(), source(), diagnostics_, *robot_);
}

void MotionDocument::replace_text(std::string text, std::string_view drag) {
  replace(std::move(text), "Edit text", drag);
}

void MotionDocument::upgrade() { replace(tools::upgrade_motion(source_name(), text_), "Upgrade"); }

std::string MotionDocument::name() const {
  const YamlNode* name = tree() != nullptr ? tree()->find("name") : nullptr;
  return name != nullptr ? name->scalar : std::string();
}

void MotionDocument::set_name(const std::string& name) {
  const YamlNode* present = yaml().tree().find("name");
  check_name(name, source_name(), present != nullptr ? present->line : 0);
  if (name == this->name()) return;
  edit("Rename the motion", {}, [&](YamlDocument& yaml) { yaml.set(YamlPath({"name"}), yaml_scalar(name)); });
}

void MotionDocument::follow_name_of(const fs::path& file) {
  const std::string present = name();
  if (present == kNewName || (!this->file().empty() && present == name_of_file(this->file())))
    set_name(name_of_file(file));
}

// Messages name the new file.
void MotionDocument::save_as(const fs::path& file) {
  const fs::path absolute = fs::absolute(file);
  const bool is_other = absolute != this->file();
  if (is_other) follow_name_of(absolute);
  write_to(absolute);
  if (!is_other) return;
  yaml_.reset();
  renew();
}

}  // namespace koboshi::studio
