#include "tools/import/pipeline/exported_robot.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "sim_board/description/edit/robot_text.h"
#include "sim_board/description/load.h"
#include "tools/import/read/urdf_reader.h"
#include "tools/robot_file/urdf/export_urdf.h"
#include "tools/robot_file/urdf/urdf_text.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using sim_board::ModelSetting;

// Other programs write six significant digits.
constexpr double kSameShare = 1e-5;
constexpr double kSamePlace_m = 1e-6;
constexpr double kSameAngle_rad = 1e-5;

bool same_share(double a, double b) {
  return std::abs(a - b) <= kSameShare * std::max(std::abs(a), std::abs(b));
}

bool same_pose(const Isometry3d& a, const Isometry3d& b) {
  return (a.translation() - b.translation()).norm() <= kSamePlace_m &&
         Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() <= kSameAngle_rad;
}

bool same_shapes(const std::vector<ImportedShape>& a, const std::vector<ImportedShape>& b) {
  return std::ranges::equal(a, b, [](const ImportedShape& one, const ImportedShape& other) {
    return one.kind == other.kind && same_pose(one.X_LG, other.X_LG) &&
           (one.size_m - other.size_m).norm() <= kSamePlace_m && one.scale.isApprox(other.scale, kSameShare);
  });
}

// The robot's file as the reader of URDF sees it.
ImportedRobot as_urdf(const sim_board::RobotDescription& robot) {
  ImportReport ignored;
  return read_urdf(robot.file, urdf_text(robot, "", ""), ignored);
}

// Names a difference that changes of single values cannot express; empty if there is none.
std::string other_shape(const ImportedRobot& ours, const ImportedRobot& theirs) {
  if (ours.links.size() != theirs.links.size() || ours.joints.size() != theirs.joints.size())
    return "the number of links or joints";
  for (const ImportedLink& link : ours.links) {
    const auto other = std::ranges::find(theirs.links, link.name, &ImportedLink::name);
    if (other == theirs.links.end()) return "the name of link " + link.name;
    if (!same_shapes(link.collisions, other->collisions)) return "a box of link " + link.name;
    if (!same_shapes(link.visuals, other->visuals)) return "a visual of link " + link.name;
  }
  for (const ImportedJoint& joint : ours.joints) {
    const auto index = theirs.find_joint(joint.name);
    if (!index) return "the name of joint " + joint.name;
    const ImportedJoint& other = theirs.joints[static_cast<std::size_t>(*index)];
    const auto name = [](const ImportedRobot& robot, int link) {
      return robot.links[static_cast<std::size_t>(link)].name;
    };
    if (joint.kind != other.kind || name(ours, joint.parent) != name(theirs, other.parent) ||
        name(ours, joint.child) != name(theirs, other.child))
      return "the type or the links of joint " + joint.name;
    if (!same_pose(joint.X_PL, other.X_PL)) return "the origin of joint " + joint.name;
    if ((joint.axis_L - other.axis_L).norm() > kSameAngle_rad) return "the axis of joint " + joint.name;
  }
  return {};
}

// Files that the robot's file needs, but an import cannot take with it; empty: none.
std::string other_files(const sim_board::RobotDescription& robot, const std::string& text) {
  if (text.find("<koboshi:servo_types") != std::string::npos) return "a library of servos";
  for (const sim_board::LinkDescription& link : robot.links)
    for (const sim_board::MeshDescription& mesh : link.meshes)
      if (path_in_folder(mesh.file, robot.file.parent_path()).empty())
        return "a mesh outside of the folder: " + one_line(mesh.file.string());
  return {};
}

class ValueUpdate {
 public:
  ValueUpdate(const sim_board::RobotDescription& robot, const ImportedRobot& ours, ImportReport& report)
      : robot_(robot), ours_(ours), report_(report) {}

  std::vector<ModelSetting> settings(const ImportedRobot& theirs) {
    for (const ImportedLink& link : ours_.links)
      update_link(link, *std::ranges::find(theirs.links, link.name, &ImportedLink::name));
    for (const ImportedJoint& joint : ours_.joints)
      update_joint(joint, theirs.joints[static_cast<std::size_t>(theirs.find_joint(joint.name).value())]);
    return std::move(settings_);
  }

 private:
  void set(const std::string& path, const std::string& before, const std::string& after) {
    settings_.push_back({path, after});
    report_.normalised.push_back(
        fmt::format("{}: {} -> {}, because the URDF was changed after the export", path, before, after));
  }
  void set(const std::string& path, double before, double after) {
    set(path, number_text(before), number_text(after));
  }
  static std::string numbers(const Eigen::Vector3d& p) {
    return number_text(p.x()) + " " + number_text(p.y()) + " " + number_text(p.z());
  }

  void update_link(const ImportedLink& ours, const ImportedLink& theirs) {
    const auto& link = robot_.links[static_cast<std::size_t>(robot_.find_link(ours.name).value())];
    if (!same_share(ours.mass_kg, theirs.mass_kg)) set(ours.name + ".mass", ours.mass_kg, theirs.mass_kg);
    // The axes are those of the link; the origin may be another one.
    const Eigen::Vector3d shift_m = theirs.p_LCom_L - ours.p_LCom_L;
    if (shift_m.norm() > kSamePlace_m)
      set(ours.name + ".com", numbers(link.p_LCom_L), numbers(link.p_LCom_L + shift_m));
    const Eigen::Matrix3d& I = theirs.I_LCom_L;
    if ((I - ours.I_LCom_L).norm() <= kSameShare * I.norm()) return;
    // The moments in a robot's file have the axes of the inertial frame.
    settings_.push_back({ours.name + ".inertial.rotation", "0 0 0"});
    const char* const names[] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    constexpr int kRows[] = {0, 1, 2, 0, 0, 1};
    constexpr int kColumns[] = {0, 1, 2, 1, 2, 2};
    for (std::size_t i = 0; i < 6; ++i)
      set(ours.name + "." + names[i], ours.I_LCom_L(kRows[i], kColumns[i]), I(kRows[i], kColumns[i]));
  }

  void update_joint(const ImportedJoint& ours, const ImportedJoint& theirs) {
    const auto update = [&](const char* key, double before, double after) {
      if (std::abs(before - after) > kSameAngle_rad) set(ours.name + "." + key, before, after);
    };
    update("lower", ours.lower_rad.value_or(0.0), theirs.lower_rad.value_or(0.0));
    update("upper", ours.upper_rad.value_or(0.0), theirs.upper_rad.value_or(0.0));
    update("speed", ours.speed_rad_per_s, theirs.speed_rad_per_s);
    if (!same_share(ours.effort_Nm, theirs.effort_Nm))
      report_.ignored.push_back(fmt::format("effort of {}: {:.4g} N m, where its servo has {:.4g} N m",
                                            ours.name, theirs.effort_Nm, ours.effort_Nm));
  }

  const sim_board::RobotDescription& robot_;
  const ImportedRobot& ours_;
  ImportReport& report_;
  std::vector<ModelSetting> settings_;
};

}  // namespace

std::optional<ExportedRobot> find_exported_robot(const fs::path& file) {
  tinyxml2::XMLDocument document;
  const std::string text = with_line_feeds(read_text_file(file, "a URDF, SDF or MJCF file"));
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  const tinyxml2::XMLElement* const root = document.RootElement();
  const tinyxml2::XMLElement* const element = root != nullptr && std::string_view(root->Name()) == "robot"
                                                  ? root->FirstChildElement("koboshi")
                                                  : nullptr;
  if (element == nullptr) return std::nullopt;
  ExportedRobot exported{.line = element->GetLineNum()};
  for (const tinyxml2::XMLNode* part = element->FirstChild(); part != nullptr; part = part->NextSibling())
    if (part->ToText() != nullptr) exported.robot_file += part->Value();
  return exported;
}

std::optional<std::string> updated_robot_file(const fs::path& file, const ExportedRobot& exported,
                                              ImportReport& report) {
  ImportReport changes;
  const auto refuse = [&](const std::string& reason) {
    report.warnings.push_back(fmt::format(
        "line {}: the robot's file in <koboshi> is not used, because {}; the URDF is imported as any other",
        exported.line, reason));
    return std::nullopt;
  };
  const ImportedRobot theirs =
      read_urdf(file, with_line_feeds(read_text_file(file, "a URDF, SDF or MJCF file")), changes);
  // Paths of meshes are relative to the folder of the URDF.
  const fs::path source = file.parent_path() / "robot.sdf";
  try {
    const sim_board::RobotDescription robot = sim_board::load_robot(source, exported.robot_file);
    if (const std::string other = other_files(robot, exported.robot_file); !other.empty())
      return refuse("it needs " + other);
    const ImportedRobot ours = as_urdf(robot);
    if (const std::string other = other_shape(ours, theirs); !other.empty())
      return refuse(other + " differs in the URDF");
    const std::vector<ModelSetting> settings = ValueUpdate(robot, ours, changes).settings(theirs);
    XmlDocument document(source, exported.robot_file);
    if (!settings.empty()) sim_board::apply_settings(document, settings, sim_board::Sides::kOne);
    for (auto lines : {&ImportReport::normalised, &ImportReport::ignored})
      (report.*lines).insert((report.*lines).end(), (changes.*lines).begin(), (changes.*lines).end());
    return document.text();
  } catch (const InputError& error) {
    return refuse(fmt::format("it has {}, where {} is expected", error.found(), error.expected()));
  }
}

}  // namespace koboshi::tools
