// Checks each row of the table in docs/reference/faults.md against a simulation.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "firmware/app/controller_objects.h"
#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

constexpr std::uint64_t kFault_us = 2'000'000;
constexpr std::uint64_t kEnd_us = kFault_us + 1'200'000;
const std::filesystem::path kPage = KOBOSHI_SOURCE_DIR "/docs/reference/faults.md";

struct Row {
  int line;
  std::string faults;  // items of a scenario's list of faults, without their times
  std::string emergencies;
  std::string controller;
  std::string drives;
};

// Prints a failing row in googletest's messages.
void PrintTo(const Row& row, std::ostream* out) { *out << kPage.string() << ":" << row.line; }

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" `");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" `") - first + 1);
}

// Returns the rows whose first cell is a fault. The test ignores the second cell, which describes the fault
// in words.
std::vector<Row> read_rows() {
  std::vector<Row> rows;
  std::ifstream page(kPage);
  std::string text;
  for (int line = 1; std::getline(page, text); ++line) {
    if (!text.starts_with("| `{")) continue;
    std::vector<std::string> cells;
    for (std::size_t begin = 1; begin < text.size();) {
      const std::size_t end = std::min(text.find('|', begin), text.size());
      cells.push_back(trimmed(text.substr(begin, end - begin)));
      begin = end + 1;
    }
    cells.resize(5);
    rows.push_back({line, cells[0], cells[2], cells[3], cells[4]});
  }
  return rows;
}

std::vector<simulation::Fault> read_faults(const Row& row) {
  const std::string at = fmt::format("{{at_s: {}, ", 1e-6 * kFault_us);
  std::string items;
  for (const char c : row.faults) {
    if (c == '{') items += at;
    if (c != '{' && c != '`') items += c;
  }
  const std::vector<Override> overrides{{"faults", "[" + items + "]"}};
  return simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml", overrides).faults;
}

std::string name_of(std::span<const canopen::ValueName> names, auto value) {
  const auto found = std::ranges::find(names, static_cast<std::int32_t>(value), &canopen::ValueName::value);
  return std::string(found->name);
}

// Runs the fault of one row and collects the reported codes, events and states.
class FaultRun {
 public:
  explicit FaultRun(const Row& row) : run_(scenario(row)), target_(read_faults(row).at(0).target.text) {
    run_.run_until_us(kEnd_us);
  }

  RobotRun& run() { return run_; }

  std::string emergencies() const {
    std::map<std::uint8_t, std::vector<std::string>> codes;  // keyed by node id
    for (const RobotRun::Frame& frame : run_.frames()) {
      const auto emergency = canopen::decode_emergency(frame.frame);
      if (!emergency || frame.start_us < kFault_us || emergency->code == canopen::error_code::kNoError)
        continue;
      auto& of_node = codes[emergency->node_id];
      const std::string code = fmt::format("0x{:04X}", emergency->code);
      if (std::ranges::find(of_node, code) == of_node.end()) of_node.push_back(code);
    }
    std::vector<std::string> words;
    if (codes.contains(kController))
      words.push_back(fmt::format("controller {}", fmt::join(codes[kController], ", ")));
    const auto of_drives = by_drive([&](std::size_t joint) {
      return fmt::format("{}", fmt::join(codes[run_.robot().joints[joint].drive.node_id], ", "));
    });
    if (!of_drives.empty()) words.push_back(of_drives);
    return words.empty() ? "none" : fmt::format("{}", fmt::join(words, "; "));
  }

  std::string controller() const {
    const auto& behaviour = run_.behaviour();
    if (run_.board().electronics().watchdog_bitten()) return "dead";
    const std::string state = name_of(app::kStateNames, behaviour.state);
    if (behaviour.state != behaviour::State::kFault) return state;
    const std::string reason = name_of(app::kReasonNames, behaviour.reason);
    if (behaviour.reason != behaviour::Reason::kDriveFault) return fmt::format("{}: {}", state, reason);
    const std::string code =
        behaviour.drive_error_code == 0 ? "" : fmt::format(" 0x{:04X}", behaviour.drive_error_code);
    return fmt::format("{}: {} {}{}", state, run_.robot().joints[behaviour.faulty_joint].name,
                       name_of(app::kDriveFaultNames, behaviour.drive_fault), code);
  }

  std::string drives() const {
    return by_drive([&](std::size_t joint) -> std::string {
      const sim_board::Drive& drive = run_.board().electronics().drive(joint);
      if (!drive.listens()) return "dead";
      return std::string(canopen::cia402::kStateNames[static_cast<std::size_t>(drive.state())]);
    });
  }

 private:
  static simulation::Scenario scenario(const Row& row) {
    simulation::Scenario scenario = hanging_squat();
    scenario.physics.stepper = sim_board::Stepper::kLumped;
    scenario.faults = read_faults(row);
    return scenario;
  }

  // Returns the value of `tell` for each drive, with equal values grouped. Drives without a value are
  // omitted.
  std::string by_drive(const std::function<std::string(std::size_t)>& tell) const {
    std::map<std::string, std::vector<std::string>> joints;
    for (std::size_t i = 0; i < run_.robot().joints.size(); ++i)
      joints[tell(i)].push_back(run_.robot().joints[i].name);
    std::vector<std::string> words;
    for (const bool one : {true, false}) {  // the faulty drive first
      for (const auto& [told, names] : joints) {
        if ((names == std::vector{target_}) != one || told.empty()) continue;
        words.push_back(group(names) + " " + told);
      }
    }
    return fmt::format("{}", fmt::join(words, "; "));
  }

  std::string group(const std::vector<std::string>& names) const {
    const std::size_t all = run_.robot().joints.size();
    const bool has_target = std::ranges::find(names, target_) != names.end();
    if (names.size() == all) return "all";
    if (names.size() + 1 == all && !has_target && run_.robot().find_joint(target_)) return "others";
    if (names.size() > 2) return std::to_string(names.size());
    return fmt::format("{}", fmt::join(names, ", "));
  }

  RobotRun run_;
  std::string target_;
};

class FaultMatrix : public testing::TestWithParam<Row> {};

TEST_P(FaultMatrix, MatchesTheReferencePage) {
  FaultRun fault(GetParam());
  EXPECT_EQ(fault.emergencies(), GetParam().emergencies);
  EXPECT_EQ(fault.controller(), GetParam().controller);
  EXPECT_EQ(fault.drives(), GetParam().drives);
  RobotRun& run = fault.run();
  // "Stopped" means no torque on any drive; otherwise the whole robot must work as before.
  const bool stopped =
      !behaviour::kTorque.contains(run.behaviour().state) || run.board().electronics().watchdog_bitten();
  EXPECT_EQ(run.torque_count(), stopped ? 0 : 20);
  EXPECT_EQ(run.board().electronics().drive_enable_line(), !stopped);
}

std::string test_name(const testing::TestParamInfo<Row>& info) {
  std::string name;
  for (const char c : info.param.faults) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
    if (c == '.') name += 'p';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Page, FaultMatrix, testing::ValuesIn(read_rows()), test_name);

TEST(FaultMatrixPage, ListsEveryKindOfFault) {
  std::set<simulation::Fault::Kind> kinds;
  for (const Row& row : read_rows()) {
    for (const simulation::Fault& fault : read_faults(row)) kinds.insert(fault.kind);
  }
  EXPECT_EQ(kinds.size(), simulation::Fault::kind_names().size());
}

}  // namespace

}  // namespace koboshi::test
