#include "studio/model/model_document.h"

#include <algorithm>
#include <utility>

#include "base/text/error.h"
#include "sim_board/description/load.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

// Removes what the simulation does not read.
void strip_look(XmlPart& part) {
  std::erase_if(part.parts, [](const XmlPart& child) {
    return child.kind == XmlPart::Kind::kComment || child.name == "visual";
  });
  for (XmlPart& child : part.parts) strip_look(child);
}

}  // namespace

ModelDocument::ModelDocument(const fs::path& file, fs::path recovery_folder)
    : ModelDocument(file, read_file_with_state(file), std::move(recovery_folder)) {}

ModelDocument::ModelDocument(const fs::path& file, ReadFile read, fs::path recovery_folder)
    : TextDocument(fs::absolute(file), read.state),
      xml_(file, std::move(read.text)),
      autosave_(std::move(recovery_folder)) {
  static_cast<void>(robot());
}

std::unique_ptr<ModelDocument> ModelDocument::restore(const Recovery& recovery, fs::path recovery_folder) {
  auto document = std::make_unique<ModelDocument>(recovery.original, std::move(recovery_folder));
  document->replace_text(recovery.text);
  return document;
}

const sim_board::RobotDescription& ModelDocument::robot() const { return *report().robot; }

const tools::ModelReport& ModelDocument::report() const {
  if (!report_) report_ = checked(text());
  return *report_;
}

// Throws what the reader throws.
tools::ModelReport ModelDocument::checked(const std::string& text) const {
  return checker_.check(file(), text, sim_board::load_robot(file(), text));
}

std::vector<sim_board::ModelField> ModelDocument::fields(const std::string& element) const {
  for (const sim_board::ModelElement& one : elements())
    if (one.name == element) return sim_board::model_fields(xml_, one);
  return {};
}

std::string ModelDocument::element_at(int line) const {
  const auto all = elements();
  const auto parts = xml_.root().elements();
  const auto model = std::ranges::find(parts, "model", [](const XmlPart* part) { return part->name; });
  if (model == parts.end()) return {};
  const auto children = (*model)->elements();
  std::string found;
  for (const sim_board::ModelElement& element : all)
    if (children[element.number]->line <= line) found = element.name;
  return found;
}

void ModelDocument::set(const std::string& path, const std::string& typed, sim_board::Sides sides,
                        std::string_view drag) {
  XmlDocument edited = xml_;
  sim_board::edit_settings(edited, {{path, typed}}, sides);
  take(std::move(edited), "Set " + path, drag);
}

void ModelDocument::replace_text(const std::string& text) {
  take(XmlDocument(file(), text), "Edit text", {});
}

void ModelDocument::take(XmlDocument edited, const std::string& label, std::string_view drag) {
  if (edited.text() == text()) return;
  tools::ModelReport report = checked(edited.text());
  const std::string before = text();
  xml_ = std::move(edited);
  report_ = std::move(report);
  record(before, label, drag);
}

// The report of a text that has been loaded before is made when it is asked for.
void ModelDocument::take_text(std::string text) {
  xml_.replace_text(std::move(text));
  report_.reset();
}

bool same_physics(const XmlDocument& a, const XmlDocument& b) {
  XmlPart one = a.root();
  XmlPart other = b.root();
  strip_look(one);
  strip_look(other);
  return same_parts(one, other);
}

}  // namespace koboshi::studio
