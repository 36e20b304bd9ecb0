#include "tools/studio/model/model_document.h"

#include <algorithm>
#include <utility>

#include "sim_board/input/error.h"
#include "sim_board/record/output_file.h"
#include "sim_board/robot/load.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

// Removes what the simulation does not read.
void strip_look(tools::XmlPart& part) {
  std::erase_if(part.parts, [](const tools::XmlPart& child) {
    return child.kind == tools::XmlPart::Kind::kComment || child.name == "visual";
  });
  for (tools::XmlPart& child : part.parts) strip_look(child);
}

}  // namespace

ModelDocument::ModelDocument(const fs::path& file, fs::path recovery_folder)
    : ModelDocument(file, read_file_with_state(file), std::move(recovery_folder)) {}

ModelDocument::ModelDocument(const fs::path& file, ReadFile read, fs::path recovery_folder)
    : file_(fs::absolute(file)),
      recovery_folder_(std::move(recovery_folder)),
      disk_(read.state),
      xml_(file, std::move(read.text)) {
  static_cast<void>(robot());
}

std::unique_ptr<ModelDocument> ModelDocument::restore(const Recovery& recovery, fs::path recovery_folder) {
  auto document = std::make_unique<ModelDocument>(recovery.original, std::move(recovery_folder));
  document->replace_text(recovery.text);
  return document;
}

const sim::RobotDescription& ModelDocument::robot() const { return *report().robot; }

const tools::ModelReport& ModelDocument::report() const {
  if (!report_) report_ = checked(text());
  return *report_;
}

// Throws what the reader throws.
tools::ModelReport ModelDocument::checked(const std::string& text) const {
  return checker_.check(file_, text, sim::load_robot(file_, text));
}

std::vector<tools::ModelField> ModelDocument::fields(const std::string& element) const {
  for (const tools::ModelElement& one : elements())
    if (one.name == element) return tools::model_fields(xml_, one);
  return {};
}

std::string ModelDocument::element_at(int line) const {
  const auto all = elements();
  const auto parts = xml_.root().elements();
  const auto model = std::ranges::find(parts, "model", [](const tools::XmlPart* part) { return part->name; });
  if (model == parts.end()) return {};
  const auto children = (*model)->elements();
  std::string found;
  for (const tools::ModelElement& element : all)
    if (children[element.number]->line <= line) found = element.name;
  return found;
}

void ModelDocument::set(const std::string& path, const std::string& typed, tools::Sides sides,
                        std::string_view drag) {
  tools::XmlDocument edited = xml_;
  tools::edit_settings(edited, {{path, typed}}, sides);
  take(std::move(edited), "Set " + path, drag);
}

void ModelDocument::replace_text(const std::string& text) {
  take(tools::XmlDocument(file_, text), "Edit text", {});
}

void ModelDocument::take(tools::XmlDocument edited, const std::string& label, std::string_view drag) {
  if (edited.text() == text()) return;
  tools::ModelReport report = checked(edited.text());
  history_.record(text(), edited.text(), label, drag);
  xml_ = std::move(edited);
  report_ = std::move(report);
  ++revision_;
}

// The texts of the history have been loaded before.
void ModelDocument::return_to(const std::string& text) {
  xml_.replace_text(text);
  report_.reset();
  ++revision_;
}

bool ModelDocument::undo() {
  std::string text = xml_.text();
  if (!history_.undo(text)) return false;
  return_to(text);
  return true;
}

bool ModelDocument::redo() {
  std::string text = xml_.text();
  if (!history_.redo(text)) return false;
  return_to(text);
  return true;
}

void ModelDocument::save() {
  if (!is_modified() && changed_on_disk() == DiskChange::kNone) return;
  sim::write_whole_file(file_, text());
  disk_ = {.size = text().size(), .time = fs::last_write_time(file_), .hash = hash_text(text())};
  history_.mark_saved();
  if (slot_) slot_->remove();
}

DiskChange ModelDocument::changed_on_disk() const { return compare_with_disk(file_, disk_); }

void ModelDocument::reload() {
  const ReadFile read = read_file_with_state(file_);
  replace_text(read.text);
  disk_ = read.state;
  history_.mark_saved();
}

bool ModelDocument::autosave(std::int64_t now_unix_s) {
  if (recovery_folder_.empty() || autosaved_revision_ == revision_) return false;
  if (!is_modified()) {
    if (slot_) slot_->remove();
    return false;
  }
  if (!slot_) slot_ = std::make_unique<RecoverySlot>(recovery_folder_, file_);
  slot_->write(text(), disk_.hash, now_unix_s);
  autosaved_revision_ = revision_;
  return true;
}

void ModelDocument::keep_recovery() {
  if (slot_) slot_->keep();
}

bool same_physics(const tools::XmlDocument& a, const tools::XmlDocument& b) {
  tools::XmlPart one = a.root();
  tools::XmlPart other = b.root();
  strip_look(one);
  strip_look(other);
  return tools::same_parts(one, other);
}

}  // namespace koboshi::studio
