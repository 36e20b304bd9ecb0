// The report of `koboshi model check` as a text and as JSON.

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "simulation/model/bus_load.h"
#include "tools/robot_file/check/model_check.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

constexpr std::array<const char*, 2> kSides{"left", "right"};

std::string_view name_of(Severity severity) {
  switch (severity) {
    case Severity::kError:
      return "error";
    case Severity::kWarning:
      return "warning";
    case Severity::kNote:
      return "note";
  }
  return {};
}

// The joint that carries a link; null for the base.
const sim_board::JointDescription* carrier(const sim_board::RobotDescription& robot, std::size_t link) {
  for (std::size_t i = 0; i < robot.hinge_count(); ++i)
    if (robot.hinge(i).child == static_cast<int>(link)) return &robot.hinge(i);
  return nullptr;
}

// Links in the order of a walk through the tree, with their depth. The reader has checked that it is a tree.
std::vector<std::pair<std::size_t, int>> walk(const sim_board::RobotDescription& robot) {
  std::vector<std::pair<std::size_t, int>> order{{0, 0}};
  for (std::size_t next = 0; next < order.size(); ++next) {
    const auto [link, depth] = order[next];
    std::size_t place = next + 1;
    for (std::size_t i = 0; i < robot.hinge_count(); ++i)
      if (robot.hinge(i).parent == static_cast<int>(link))
        order.insert(order.begin() + static_cast<std::ptrdiff_t>(place++),
                     {static_cast<std::size_t>(robot.hinge(i).child), depth + 1});
  }
  return order;
}

std::string tree_text(const sim_board::RobotDescription& robot) {
  std::string text;
  for (const auto& [link, depth] : walk(robot)) {
    const sim_board::JointDescription* joint = carrier(robot, link);
    const std::string name = std::string(2 * static_cast<std::size_t>(depth), ' ') + robot.links[link].name;
    text += fmt::format("{:<30} {:>7.1f} g", name, 1e3 * robot.links[link].mass_kg);
    if (joint != nullptr)
      text +=
          fmt::format("   {} {:.0f} to {:.0f} deg, node {}", joint->name, kDegreesPerRad * joint->lower_rad,
                      kDegreesPerRad * joint->upper_rad, joint->drive.node_id);
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json finding_json(const ModelFinding& finding) {
  nlohmann::ordered_json json{{"code", finding.code},         {"severity", name_of(finding.severity)},
                              {"line", finding.line},         {"found", finding.found},
                              {"expected", finding.expected}, {"repair", finding.repair},
                              {"element", finding.element},   {"key", finding.key},
                              {"place", finding.place}};
  if (!finding.file.empty()) json["file"] = finding.file.string();
  json["edits"] = nlohmann::ordered_json::array();
  for (const ModelEdit& edit : finding.edits) {
    nlohmann::ordered_json& one = json["edits"].emplace_back();
    one["place"] = edit.place;
    if (!edit.attribute.empty()) one["attribute"] = edit.attribute;
    if (edit.value) one["value"] = *edit.value;
  }
  return json;
}

}  // namespace

std::string model_report_text(const ModelReport& report) {
  std::string text;
  if (report.robot) {
    const sim_board::RobotDescription& robot = *report.robot;
    text += tree_text(robot);
    text +=
        fmt::format("\n{}: {} links, {} joints, {:.3f} kg, {:.0f} mm high\n", robot.name, robot.links.size(),
                    robot.joints.size(), robot.total_mass_kg(), kMmPerM * report.height_m);
    text +=
        fmt::format("centre of mass at joint angles zero: ({:.1f}, {:.1f}, {:.1f}) mm in the model's frame\n",
                    kMmPerM * report.com_M_m.x(), kMmPerM * report.com_M_m.y(), kMmPerM * report.com_M_m.z());
    for (std::size_t side = 0; side < 2; ++side)
      if (report.leg_m[side])
        text += fmt::format("reach of the {} leg, hip to ankle: {:.1f} mm\n", kSides[side],
                            kMmPerM * *report.leg_m[side]);
    if (report.squat)
      text += fmt::format(
          "squat with knees at 90 deg: {} takes {:.2f} N m, {:.0f} % of its servo at the lowest supply\n",
          report.squat->joint, report.squat->torque_Nm, 100.0 * report.squat->share);
    const simulation::BusLoad own = simulation::bus_load(robot.joints.size(), false);
    const simulation::BusLoad shared = simulation::bus_load(robot.joints.size(), true);
    text += fmt::format(
        "bus load of {}: {:.1f} to {:.1f} %, with the sensors as nodes {:.1f} to {:.1f} %; at most {:.0f} "
        "%\n",
        count_text(robot.joints.size(), "drive"), 100.0 * own.shortest, 100.0 * own.longest,
        100.0 * shared.shortest, 100.0 * shared.longest, 100.0 * simulation::kMaxBusLoad);
    if (report.is_repaired)
      text += "The reader refuses this file. The values above are those after the repairs below.\n";
    text += "\n";
  }
  for (const ModelFinding& finding : report.findings) {
    const std::string line = finding.line > 0 ? ":" + std::to_string(finding.line) : std::string();
    const std::filesystem::path& file = finding.file.empty() ? report.file : finding.file;
    text += fmt::format("{}{}: {}[{}]: found {}, expected {}\n", file.string(), line,
                        name_of(finding.severity), finding.code, finding.found, finding.expected);
    if (!finding.repair.empty()) text += fmt::format("  = {}\n", finding.repair);
  }
  text += report.findings.empty() ? "no findings\n" : count_text(report.findings.size(), "finding") + "\n";
  return text;
}

std::string model_report_json(const ModelReport& report) {
  nlohmann::ordered_json json;
  json["file"] = report.file.string();
  json["repaired"] = report.is_repaired;
  if (report.robot) {
    const sim_board::RobotDescription& robot = *report.robot;
    json["robot"] = robot.name;
    json["mass_kg"] = robot.total_mass_kg();
    json["com_m"] = {report.com_M_m.x(), report.com_M_m.y(), report.com_M_m.z()};
    json["height_m"] = report.height_m;
    for (std::size_t side = 0; side < 2; ++side)
      if (report.leg_m[side]) json[std::string(kSides[side]) + "_leg_m"] = *report.leg_m[side];
    if (report.squat)
      json["squat"] = {{"joint", report.squat->joint},
                       {"torque_Nm", report.squat->torque_Nm},
                       {"share", report.squat->share}};
    json["bus_load"] = simulation::bus_load(robot.joints.size(), false).longest;
    json["bus_load_with_sensors"] = simulation::bus_load(robot.joints.size(), true).longest;
    json["links"] = nlohmann::ordered_json::array();
    for (const auto& [link, depth] : walk(robot)) {
      const sim_board::JointDescription* joint = carrier(robot, link);
      nlohmann::ordered_json& one = json["links"].emplace_back();
      one["name"] = robot.links[link].name;
      one["mass_kg"] = robot.links[link].mass_kg;
      if (joint != nullptr) {
        one["joint"] = joint->name;
        one["parent"] = robot.links[static_cast<std::size_t>(joint->parent)].name;
      }
    }
  }
  json["findings"] = nlohmann::ordered_json::array();
  for (const ModelFinding& finding : report.findings) json["findings"].push_back(finding_json(finding));
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace koboshi::tools
