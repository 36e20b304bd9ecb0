#pragma once

#include <vector>

#include "base/xml/xml_check.h"
#include "base/xml/xml_draft.h"
#include "sim_board/description/robot_faults.h"
#include "tools/robot_file/check/finding.h"

namespace koboshi::tools {

// A change of a draft.
struct DraftChange {
  enum class Kind { kText, kAttribute, kRename, kErase, kEraseAttribute, kEraseTexts };

  Kind kind = Kind::kText;
  XmlNode node;
  std::string attribute{};
  std::string value{};
};

// A fault as a finding, and the changes after which the other checks can go on.
struct Repair {
  ModelFinding finding{};
  std::vector<DraftChange> changes{};  // empty: people must choose
};

// Finding and repair of a violation of the schema.
[[nodiscard]] Repair repair_of(const XmlFault& fault);
// Finding and repair of another fault. `folder`: of the robot's file.
[[nodiscard]] Repair repair_of(const sim_board::RobotFault& fault, const std::filesystem::path& folder);

// Makes changes: values first, so that no change meets an element that another has erased.
void make_changes(XmlDraft& draft, const std::vector<DraftChange>& changes);

// The changes that a text editor makes: all of a repair but renaming and texts between elements.
[[nodiscard]] std::vector<ModelEdit> edits_of(const std::vector<DraftChange>& changes);

}  // namespace koboshi::tools
