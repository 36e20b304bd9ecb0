#include "tools/robot_file/check/draft_repair.h"

#include <algorithm>

namespace koboshi::tools {
namespace {

using Kind = DraftChange::Kind;

bool is_below(const XmlNode& node, const XmlNode& above) {
  for (auto parent = node.parent(); parent; parent = parent->parent())
    if (*parent == above) return true;
  return false;
}

void make_change(XmlDraft& draft, const DraftChange& change) {
  switch (change.kind) {
    case Kind::kText:
      draft.set_text(change.node, change.value);
      break;
    case Kind::kAttribute:
      draft.set_attribute(change.node, change.attribute, change.value);
      break;
    case Kind::kRename:
      draft.rename(change.node, change.value);
      break;
    case Kind::kErase:
      break;
    case Kind::kEraseAttribute:
      draft.erase_attribute(change.node, change.attribute);
      break;
    case Kind::kEraseTexts:
      draft.erase_texts(change.node);
      break;
  }
}

}  // namespace

void make_changes(XmlDraft& draft, const std::vector<DraftChange>& changes) {
  for (const DraftChange& change : changes) make_change(draft, change);
  std::vector<XmlNode> erased;
  for (const DraftChange& change : changes)
    if (change.kind == Kind::kErase && std::ranges::find(erased, change.node) == erased.end())
      erased.push_back(change.node);
  std::vector<XmlNode> outermost;
  for (const XmlNode& node : erased)
    if (std::ranges::none_of(erased, [&](const XmlNode& other) { return is_below(node, other); }))
      outermost.push_back(node);
  for (const XmlNode& node : outermost) draft.erase(node);
}

std::vector<ModelEdit> edits_of(const std::vector<DraftChange>& changes) {
  std::vector<ModelEdit> edits;
  for (const DraftChange& change : changes) {
    if (change.kind == Kind::kRename || change.kind == Kind::kEraseTexts) return {};
    ModelEdit edit{.place = change.node.place(), .attribute = change.attribute};
    if (change.kind == Kind::kText || change.kind == Kind::kAttribute) edit.value = change.value;
    edits.push_back(std::move(edit));
  }
  return edits;
}

}  // namespace koboshi::tools
