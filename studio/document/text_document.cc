#include "studio/document/text_document.h"

#include <utility>

#include "base/file/output_file.h"
#include "base/text/error.h"

namespace koboshi::studio {

namespace fs = std::filesystem;

// --- Text

void TextDocument::record(std::string_view before, std::string_view label, std::string_view drag) {
  history_.record(before, text(), label, drag);
  ++revision_;
}

void TextDocument::renew() {
  take_text(text());
  ++revision_;
}

void TextDocument::replace(std::string text, std::string_view label, std::string_view drag) {
  const std::string before = this->text();
  if (text == before) return;
  take_text(std::move(text));
  record(before, label, drag);
}

bool TextDocument::travel(bool (TextHistory::*step)(std::string& text)) {
  std::string other = text();
  if (!(history_.*step)(other)) return false;
  take_text(std::move(other));
  ++revision_;
  return true;
}

bool TextDocument::undo() { return travel(&TextHistory::undo); }
bool TextDocument::redo() { return travel(&TextHistory::redo); }

// --- File

void TextDocument::require_file() const {
  if (file_.empty()) throw InputError("untitled", 0, "a document without a file", "one that was saved");
}

void TextDocument::write_to(const fs::path& file) {
  write_whole_file(file, text());
  file_ = file;
  disk_ = {.size = text().size(), .time = fs::last_write_time(file_), .hash = hash_text(text())};
  history_.mark_saved();
  match_file();
}

void TextDocument::save() {
  require_file();
  if (!is_modified() && changed_on_disk() == DiskChange::kNone) return;
  write_to(file_);
}

DiskChange TextDocument::changed_on_disk() const {
  return file_.empty() ? DiskChange::kNone : compare_with_disk(file_, disk_);
}

void TextDocument::reload() {
  require_file();
  ReadFile read = read_file_with_state(file_);
  check(read.text);
  replace(std::move(read.text), "Reload");
  disk_ = read.state;
  history_.mark_saved();
  match_file();
}

// --- Recovery

bool Autosave::write(const TextDocument& document, std::int64_t now_unix_s) {
  if (folder_.empty() || revision_ == document.revision()) return false;
  if (!document.is_modified()) {
    if (slot_) slot_->remove();
    return false;
  }
  if (!slot_) slot_ = std::make_unique<RecoverySlot>(folder_, document.file());
  file_ = document.file();
  slot_->write(document.text(), document.base_hash(), now_unix_s);
  revision_ = document.revision();
  return true;
}

void Autosave::match_file(const fs::path& file) {
  if (slot_) slot_->remove();
  if (file != file_) slot_.reset();
}

void Autosave::keep() {
  if (slot_) slot_->keep();
}

}  // namespace koboshi::studio
