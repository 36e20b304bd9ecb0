#include "studio/document/text_history.h"

#include <algorithm>
#include <utility>

namespace koboshi::studio {

std::size_t TextHistory::Change::bytes() const {
  return sizeof(Change) + removed.size() + inserted.size() + label.size() + merge_key.size();
}

TextHistory::Change TextHistory::difference(std::string_view before, std::string_view after) {
  const auto start = static_cast<std::size_t>(std::ranges::mismatch(before, after).in1 - before.begin());
  const std::size_t most = std::min(before.size(), after.size()) - start;
  std::size_t end = 0;
  while (end < most && before[before.size() - 1 - end] == after[after.size() - 1 - end]) ++end;
  return {.begin = start,
          .removed = std::string(before.substr(start, before.size() - end - start)),
          .inserted = std::string(after.substr(start, after.size() - end - start)),
          .label = {},
          .merge_key = {}};
}

void TextHistory::record(std::string_view before, std::string_view after, std::string_view label,
                         std::string_view merge_key) {
  if (before == after) return;
  forget_undone();
  std::string first(before);
  const bool merges = may_merge_ && !merge_key.empty() && done_ > 0 && changes_.back().merge_key == merge_key;
  if (merges) {
    undo(first);
    forget_undone();
  }
  may_merge_ = !merge_key.empty();
  if (first == after) return;  // the drag is back where it began
  Change change = difference(first, after);
  change.label = label;
  change.merge_key = merge_key;
  bytes_ += change.bytes();
  changes_.push_back(std::move(change));
  ++done_;
  forget_oldest();
}

bool TextHistory::undo(std::string& text) {
  if (!can_undo()) return false;
  const Change& change = changes_[--done_];
  text.replace(change.begin, change.inserted.size(), change.removed);
  may_merge_ = false;
  return true;
}

bool TextHistory::redo(std::string& text) {
  if (!can_redo()) return false;
  const Change& change = changes_[done_++];
  text.replace(change.begin, change.removed.size(), change.inserted);
  may_merge_ = false;
  return true;
}

void TextHistory::mark_saved() {
  saved_ = done_;
  may_merge_ = false;
}

void TextHistory::forget_undone() {
  while (changes_.size() > done_) {
    bytes_ -= changes_.back().bytes();
    changes_.pop_back();
  }
  if (saved_ && *saved_ > done_) saved_.reset();
}

void TextHistory::forget_oldest() {
  while (bytes_ > max_bytes_ && changes_.size() > 1) {
    bytes_ -= changes_.front().bytes();
    changes_.pop_front();
    --done_;
    if (saved_ == 0) {
      saved_.reset();
    } else if (saved_) {
      --*saved_;
    }
  }
}

}  // namespace koboshi::studio
