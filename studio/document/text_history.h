#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

namespace koboshi::studio {

// The changes of a text that can be undone and redone. A change replaces one range of bytes: undoing all of
// them gives the first text to the byte.
class TextHistory {
 public:
  static constexpr std::size_t kDefaultBytes = std::size_t{64} << 20;

  // `max_bytes`: memory of the changes. The oldest changes are forgotten beyond it; the newest is always
  // kept.
  explicit TextHistory(std::size_t max_bytes = kDefaultBytes) : max_bytes_(max_bytes) {}

  // Adds the change from one text to the next and forgets what was undone. `label` names it in a menu. A
  // change with a `merge_key` that equals the last one's becomes part of it, until end_merge, undo, redo or
  // mark_saved. Equal texts are no change.
  void record(std::string_view before, std::string_view after, std::string_view label,
              std::string_view merge_key = {});
  void end_merge() { may_merge_ = false; }

  bool can_undo() const { return done_ > 0; }
  bool can_redo() const { return done_ < changes_.size(); }
  // Labels of the changes that undo and redo would apply; empty if there is none.
  std::string_view undo_label() const { return can_undo() ? changes_[done_ - 1].label : std::string_view(); }
  std::string_view redo_label() const { return can_redo() ? changes_[done_].label : std::string_view(); }
  // Apply the change to the text, which must be the one after the last record, undo or redo. Return whether
  // there was a change.
  bool undo(std::string& text);
  bool redo(std::string& text);

  // Declares the present text to be that of the file.
  void mark_saved();
  // Declares that no text of the history is that of the file.
  void forget_saved() { saved_.reset(); }
  bool is_saved() const { return saved_ == done_; }

  std::size_t bytes() const { return bytes_; }
  std::size_t undo_count() const { return done_; }

 private:
  // `removed` stands at `begin` before the change, `inserted` after it.
  struct Change {
    std::size_t begin = 0;
    std::string removed;
    std::string inserted;
    std::string label;
    std::string merge_key;

    std::size_t bytes() const;
  };

  static Change difference(std::string_view before, std::string_view after);
  void forget_undone();
  void forget_oldest();

  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::deque<Change> changes_;
  std::size_t done_ = 0;                  // changes that are not undone
  std::optional<std::size_t> saved_ = 0;  // `done_` of the file's text
  bool may_merge_ = false;
};

}  // namespace koboshi::studio
