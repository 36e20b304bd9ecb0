#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "studio/document/recovery.h"
#include "studio/document/text_history.h"

namespace koboshi::studio {

// A text file that is being edited: its undo history and its state on disk. A kind of documents holds the
// text in a form of its own.
class TextDocument {
 public:
  virtual ~TextDocument() = default;

  const std::filesystem::path& file() const { return file_; }  // absolute; empty: never saved
  virtual const std::string& text() const = 0;
  // Grows with each change of the text, also by undo and redo.
  std::uint64_t revision() const { return revision_; }

  // Undo history.
  const TextHistory& history() const { return history_; }
  void end_drag() { history_.end_merge(); }
  bool undo();
  bool redo();
  // Whether the text differs from that of the file.
  bool is_modified() const { return !history_.is_saved(); }

  // Replaces the file atomically, even if another program has changed it: ask changed_on_disk() before.
  // Throws WriteError, and InputError without a file.
  void save();
  [[nodiscard]] DiskChange changed_on_disk() const;
  // Takes over the file's text as an edit that can be undone. Throws InputError.
  void reload();
  // Hash of the file's text as it was read or saved last; 0: never.
  std::uint64_t base_hash() const { return disk_.hash; }

 protected:
  // `disk`: of the file whose text the document begins with.
  TextDocument(std::filesystem::path file, const FileState& disk) : file_(std::move(file)), disk_(disk) {}
  TextDocument(const TextDocument&) = default;
  TextDocument& operator=(const TextDocument&) = default;
  TextDocument(TextDocument&&) = default;
  TextDocument& operator=(TextDocument&&) = default;

  // Throws InputError for a text of the file that the document cannot have.
  virtual void check(const std::string& text) const = 0;
  // Takes over another text: one that was checked, or that the document has had.
  virtual void take_text(std::string text) = 0;
  // Called when the file has got the text, or the text that of the file.
  virtual void match_file() = 0;

  // Takes over another text as one change of the history.
  void replace(std::string text, std::string_view label, std::string_view drag = {});
  // Adds a change to the text that the document has now.
  void record(std::string_view before, std::string_view label, std::string_view drag);
  // Writes the text to a file, which becomes that of the document.
  void write_to(const std::filesystem::path& file);
  // Takes over the present text anew.
  void renew();
  // The file has another text than any of the history.
  void forget_saved() { history_.forget_saved(); }

 private:
  bool travel(bool (TextHistory::*step)(std::string& text));
  void require_file() const;

  std::filesystem::path file_;
  FileState disk_;
  TextHistory history_;
  std::uint64_t revision_ = 1;
};

// Saves the changes of a document beside its file every now and then, for the time after a crash.
class Autosave {
 public:
  // `folder` of the recoveries; empty: none.
  explicit Autosave(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Writes the recovery if the document differs from its file and has changed since the last call. Returns
  // whether it wrote. Throws WriteError.
  bool write(const TextDocument& document, std::int64_t now_unix_s);
  // The document is saved, or has another file: `file`.
  void match_file(const std::filesystem::path& file);
  // Ends as a crash would: the recovery stays.
  void keep();

 private:
  std::filesystem::path folder_;
  std::filesystem::path file_;  // of the slot
  std::unique_ptr<RecoverySlot> slot_;
  std::uint64_t revision_ = 0;  // that was written last
};

}  // namespace koboshi::studio
