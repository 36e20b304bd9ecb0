#include "tools/robot_file/check/reader_findings.h"

#include <algorithm>

#include "sim_board/description/load.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tools/robot_file/check/draft_repair.h"

namespace koboshi::tools {
namespace {

constexpr std::size_t kChildOfModel = 3;  // sdf, model, the child

ModelFinding finding_of(const InputError& error) {
  return {.code = "R001",
          .severity = simulation::Severity::kError,
          .line = error.line(),
          .found = error.found(),
          .expected = error.expected()};
}

// Repairs a draft as far as that is possible, and remembers what is left.
class DraftDoctor {
 public:
  DraftDoctor(XmlDraft& draft, std::vector<ModelFinding>& findings) : draft_(draft), findings_(findings) {}

  // A renamed element is looked into in the next round.
  void treat_schema() {
    constexpr int kMaxRounds = 4;
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<DraftChange> changes = treat_once();
      if (changes.empty()) return;
      make_changes(draft_, changes);
      is_changed_ = true;
    }
    for (const XmlFault& fault : find_xml_faults(draft_.root(), sim_board::sdf_rule())) leave(fault.node);
  }

  void treat_model(const std::filesystem::path& folder) {
    const auto model = draft_.root().find("model");
    if (!model) return;
    std::vector<DraftChange> changes;
    for (const sim_board::RobotFault& fault : sim_board::find_robot_faults(*model, folder, broken_)) {
      const Repair repair = repair_of(fault, folder);
      findings_.push_back(repair.finding);
      if (repair.changes.empty()) is_curable_ = false;
      changes.insert(changes.end(), repair.changes.begin(), repair.changes.end());
    }
    if (changes.empty()) return;
    make_changes(draft_, changes);
    is_changed_ = true;
  }

  bool is_sound() const { return is_curable_ && broken_.empty(); }
  bool is_changed() const { return is_changed_; }

 private:
  // Reports the violations of the schema and returns their repairs.
  std::vector<DraftChange> treat_once() {
    const std::vector<XmlFault> faults = find_xml_faults(draft_.root(), sim_board::sdf_rule());
    std::vector<Repair> repairs;
    std::vector<DraftChange> changes;
    for (const XmlFault& fault : faults) {
      repairs.push_back(repair_of(fault));
      changes.insert(changes.end(), repairs.back().changes.begin(), repairs.back().changes.end());
    }
    for (std::size_t i = 0; i < faults.size(); ++i) {
      if (repairs[i].changes.empty()) {
        if (is_provided(faults[i], changes) || is_known(repairs[i].finding)) continue;
        leave(faults[i].node);
      }
      findings_.push_back(repairs[i].finding);
    }
    return changes;
  }

  // Whether something is only missing because its name is misspelt.
  static bool is_provided(const XmlFault& fault, const std::vector<DraftChange>& changes) {
    return std::ranges::any_of(changes, [&](const DraftChange& change) {
      if (change.kind == DraftChange::Kind::kRename)
        return fault.kind == XmlFaultKind::kMissingElement && change.value == fault.name &&
               change.node.parent() == fault.node;
      return fault.kind == XmlFaultKind::kMissingAttribute && change.kind == DraftChange::Kind::kAttribute &&
             change.attribute == fault.name && change.node == fault.node;
    });
  }

  // Whether an earlier round has reported it.
  bool is_known(const ModelFinding& finding) const {
    return std::ranges::any_of(findings_, [&](const ModelFinding& other) {
      return other.line == finding.line && other.found == finding.found;
    });
  }

  // Leaves out the child of <model> around the node.
  void leave(const XmlNode& node) {
    const std::size_t depth = node.path().size();
    if (depth < kChildOfModel) {
      is_curable_ = false;
      return;
    }
    XmlNode child = node;
    for (std::size_t i = depth; i > kChildOfModel; --i) child = *child.parent();
    if (std::ranges::find(broken_, child) == broken_.end()) broken_.push_back(child);
  }

  XmlDraft& draft_;
  std::vector<ModelFinding>& findings_;
  std::vector<XmlNode> broken_;
  bool is_curable_ = true;
  bool is_changed_ = false;
};

}  // namespace

ReaderFindings find_reader_findings(const std::filesystem::path& file, const std::string& text) {
  ReaderFindings result;
  bool is_changed = false;
  try {
    XmlDraft draft(file, text, sim_board::sdf_rule());
    result.places.emplace(draft.root());
    DraftDoctor doctor(draft, result.findings);
    doctor.treat_schema();
    doctor.treat_model(file.parent_path());
    is_changed = doctor.is_changed();
    if (doctor.is_sound()) result.robot = sim_board::load_robot(file, is_changed ? draft.text() : text);
  } catch (const InputError& error) {
    result.findings.push_back(finding_of(sim_board::with_import_advice(error)));
    if (is_changed) result.findings.back().line = 0;  // that of the repaired text
  }
  return result;
}

}  // namespace koboshi::tools
