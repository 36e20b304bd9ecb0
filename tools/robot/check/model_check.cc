#include "tools/robot/check/model_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "sim_board/engine/model_constants.h"
#include "sim_board/input/error.h"
#include "sim_board/input/user_units.h"
#include "sim_board/input/xml_reader.h"
#include "sim_board/robot/load.h"
#include "sim_board/robot/sdf_schema.h"
#include "sim_board/world/box_overlap.h"
#include "sim_board/world/link_tree.h"
#include "tools/motion/check/body.h"
#include "tools/motion/check/servo_curve.h"
#include "tools/robot/check/mesh_faults.h"
#include "tools/view/capture/scene.h"

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using sim::kDegreesPerRad;
using sim::kMmPerM;
using simulation::Severity;

// An inertia with respect to that of a uniform box around the link's shapes. Mass at the corners has three
// times as much; a servo within a wide bracket has a tenth. Set by hand (2026-11-24).
constexpr double kMostInertia = 3.3;
constexpr double kLeastInertia = 1.0 / 40.0;
// Left and right are compared in what a file with four digits can say.
constexpr double kSameLength_m = 2e-5;
constexpr double kSameShare = 1e-3;
constexpr double kSameAngle_rad = 2e-3;
constexpr double kTouching_m = 0.0005;      // boxes that overlap by less only touch, as in the motion check
constexpr double kLevel_m = 0.0005;         // between the corners of the soles
constexpr double kFarMesh = 8.0;            // sizes of the robot: a mesh in millimetres has a thousand
constexpr double kSmallMesh = 1.0 / 400.0;  // a mesh that is scaled twice
constexpr double kHighShare = 0.8;          // of a servo's torque, as in the motion check

// Lines of the named elements of a robot's file.
class Lines {
 public:
  Lines(const std::filesystem::path& file, const std::string& text) {
    const sim::XmlFile document(file, text, sim::sdf_rule());
    const sim::XmlNode model = document.root().child("model");
    for (const sim::XmlNode& link : model.children("link")) {
      lines_["link " + link.attribute("name")] = link.line();
      for (const char* shape : {"collision", "visual"})
        for (const sim::XmlNode& node : link.children(shape))
          lines_["link " + link.attribute("name") + " " + node.attribute("name")] = node.line();
      if (const auto inertial = link.find("inertial"))
        lines_["inertial " + link.attribute("name")] = inertial->line();
    }
    for (const sim::XmlNode& joint : model.children("joint"))
      lines_["joint " + joint.attribute("name")] = joint.line();
  }

  int of(const std::string& element) const {
    const auto found = lines_.find(element);
    return found == lines_.end() ? 0 : found->second;
  }

 private:
  std::map<std::string, int> lines_;
};

Vector3d mirrored(const Vector3d& p) { return {p.x(), -p.y(), p.z()}; }

Eigen::Matrix3d mirrored(const Eigen::Matrix3d& tensor) {
  const Vector3d flip(1.0, -1.0, 1.0);
  return flip.asDiagonal() * tensor * flip.asDiagonal();
}

bool same_share(double a, double b) {
  return std::abs(a - b) <= kSameShare * std::max(std::abs(a), std::abs(b));
}

std::string text_of(const Vector3d& p_m) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", kMmPerM * p_m.x(), kMmPerM * p_m.y(), kMmPerM * p_m.z());
}

class ModelJudge {
 public:
  ModelJudge(const Lines& lines, ModelReport& report)
      : lines_(lines),
        robot_(*report.robot),
        scene_(view::make_scene(robot_, sim::GroundDescription())),
        report_(report) {}

  void run() {
    measure();
    check_inertias();
    check_links_of_both_sides();
    check_joints_of_both_sides();
    check_meshes();
    check_overlaps();
    if (robot_.left_ankle && robot_.right_ankle) {
      check_soles();
      check_squat();
    }
    std::ranges::stable_sort(report_.findings, {}, &ModelFinding::line);
  }

 private:
  void add(std::string code, Severity severity, const std::string& element, std::string found,
           std::string expected, std::string repair = {}) {
    report_.findings.push_back({std::move(code), severity, lines_.of(element), std::move(found),
                                std::move(expected), std::move(repair)});
  }

  void measure() {
    double lowest_m = std::numeric_limits<double>::infinity();
    double highest_m = -lowest_m;
    for (const sim::LinkDescription& link : robot_.links) {
      report_.com_M_m += link.mass_kg * (link.X_ML * link.p_LCom_L);
      for (const sim::BoxDescription& box : link.collisions) {
        const Isometry3d X_MG = link.X_ML * box.X_LG;
        const double half_m = 0.5 * X_MG.linear().row(2).cwiseAbs().dot(box.size_m);
        lowest_m = std::min(lowest_m, X_MG.translation().z() - half_m);
        highest_m = std::max(highest_m, X_MG.translation().z() + half_m);
      }
    }
    report_.com_M_m /= robot_.total_mass_kg();
    report_.height_m = std::max(highest_m - lowest_m, 0.0);
    constexpr std::array<const char*, 2> kSides{"left_", "right_"};
    for (std::size_t side = 0; side < 2; ++side) {
      const std::string prefix = kSides[side];
      const auto hip = robot_.find_joint(prefix + "hip_pitch");
      const auto knee = robot_.find_joint(prefix + "knee");
      const auto ankle = robot_.find_joint(prefix + "ankle_pitch");
      if (hip && knee && ankle)
        report_.leg_m[side] = (anchor(*hip) - anchor(*knee)).norm() + (anchor(*knee) - anchor(*ankle)).norm();
    }
  }

  const Vector3d& anchor(int joint) const { return robot_.joints[static_cast<std::size_t>(joint)].p_MJ; }

  // The box around all shapes of a link, in its frame.
  Eigen::AlignedBox3d extent(std::size_t link) const {
    Eigen::AlignedBox3d box;
    for (const auto* shapes : {&scene_.links[link].visuals, &scene_.links[link].collisions})
      for (const view::Shape& shape : *shapes) extend(box, shape);
    return box;
  }

  static void extend(Eigen::AlignedBox3d& box, const view::Shape& shape) {
    if (const auto* cuboid = std::get_if<view::Box>(&shape.geometry)) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                            (corner & 4) != 0 ? 0.5 : -0.5);
        box.extend(shape.X_LG * sign.cwiseProduct(cuboid->size_m));
      }
    } else {
      for (const Eigen::Vector3f& vertex : std::get<view::Mesh>(shape.geometry).vertices_m)
        box.extend(shape.X_LG * vertex.cast<double>());
    }
  }

  void check_inertias() {
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const sim::LinkDescription& link = robot_.links[i];
      const Eigen::AlignedBox3d box = extent(i);
      if (box.isEmpty()) continue;
      const Vector3d size_m = box.sizes();
      for (int axis = 0; axis < 3; ++axis) {
        const double square_m2 = size_m.squaredNorm() - size_m(axis) * size_m(axis);
        const double uniform_kg_m2 = link.mass_kg * square_m2 / 12.0;
        const double share = link.I_LCom_L(axis, axis) / uniform_kg_m2;
        if (share <= kMostInertia && share >= kLeastInertia) continue;
        add("R002", Severity::kWarning, "inertial " + link.name,
            fmt::format(
                "an inertia of {} about its {} axis of {:.2g} kg m^2, {:.2g} times that of a uniform box "
                "around its shapes",
                link.name, "xyz"[axis], link.I_LCom_L(axis, axis), share),
            fmt::format("{:.3f} to {:.1f} times", kLeastInertia, kMostInertia),
            fmt::format("A uniform box has {:.3g} kg m^2.", uniform_kg_m2));
        break;
      }
    }
  }

  void differ(const std::string& element, const std::string& left, const std::string& right,
              const std::string& what, const std::string& found, const std::string& expected) {
    add("R003", Severity::kWarning, element, fmt::format("{} of {}: {}", what, right, found),
        fmt::format("{}, the mirror image of {}", expected, left),
        "Set both sides, or say why they differ in a comment.");
  }

  void check_links_of_both_sides() {
    for (const sim::LinkDescription& left : robot_.links) {
      if (!left.name.starts_with("left_")) continue;
      const std::string name = "right_" + left.name.substr(5);
      const auto index = robot_.find_link(name);
      if (!index) {
        add("R003", Severity::kWarning, "link " + left.name, "no " + name,
            "the mirror image of " + left.name);
        continue;
      }
      const sim::LinkDescription& right = robot_.links[static_cast<std::size_t>(*index)];
      const Vector3d origin_m = mirrored(Vector3d(left.X_ML.translation()));
      if ((right.X_ML.translation() - origin_m).norm() > kSameLength_m)
        differ("link " + name, left.name, name, "the position", text_of(right.X_ML.translation()),
               text_of(origin_m));
      if (!same_share(left.mass_kg, right.mass_kg))
        differ("inertial " + name, left.name, name, "the mass", fmt::format("{:.4g} kg", right.mass_kg),
               fmt::format("{:.4g} kg", left.mass_kg));
      // Centre of mass and inertia in the axes of the model.
      const Vector3d com_m = mirrored(Vector3d(left.X_ML * left.p_LCom_L));
      if ((right.X_ML * right.p_LCom_L - com_m).norm() > kSameLength_m)
        differ("inertial " + name, left.name, name, "the centre of mass",
               text_of(right.X_ML * right.p_LCom_L), text_of(com_m));
      const auto in_model = [](const sim::LinkDescription& link) -> Eigen::Matrix3d {
        return link.X_ML.linear() * link.I_LCom_L * link.X_ML.linear().transpose();
      };
      const Eigen::Matrix3d inertia = mirrored(in_model(left));
      if ((in_model(right) - inertia).norm() > kSameShare * inertia.norm())
        differ("inertial " + name, left.name, name, "the inertia",
               fmt::format("{:.3g} kg m^2 on the diagonal", right.I_LCom_L.trace()),
               fmt::format("{:.3g} kg m^2", left.I_LCom_L.trace()));
    }
  }

  void check_joints_of_both_sides() {
    for (const sim::JointDescription& left : robot_.joints) {
      if (!left.name.starts_with("left_")) continue;
      const std::string name = "right_" + left.name.substr(5);
      const auto index = robot_.find_joint(name);
      if (!index) {
        add("R003", Severity::kWarning, "joint " + left.name, "no " + name,
            "the mirror image of " + left.name);
        continue;
      }
      const sim::JointDescription& right = robot_.joints[static_cast<std::size_t>(*index)];
      const std::string element = "joint " + name;
      if ((right.p_MJ - mirrored(left.p_MJ)).norm() > kSameLength_m)
        differ(element, left.name, name, "the position", text_of(right.p_MJ), text_of(mirrored(left.p_MJ)));
      // A robot may have its right joints turn as the mirror image, or about the same axis.
      const Vector3d image = sim::mirrored_axis(left.axis_M);
      const bool same = (right.axis_M - image).norm() < kSameAngle_rad;
      const bool opposite = (right.axis_M + image).norm() < kSameAngle_rad;
      if (!same && !opposite) {
        differ(element, left.name, name, "the axis",
               fmt::format("({:.3g}, {:.3g}, {:.3g})", right.axis_M.x(), right.axis_M.y(), right.axis_M.z()),
               fmt::format("({:.3g}, {:.3g}, {:.3g})", image.x(), image.y(), image.z()));
        continue;
      }
      const double lower_rad = same ? left.lower_rad : -left.upper_rad;
      const double upper_rad = same ? left.upper_rad : -left.lower_rad;
      if (std::abs(right.lower_rad - lower_rad) > kSameAngle_rad ||
          std::abs(right.upper_rad - upper_rad) > kSameAngle_rad)
        differ(element, left.name, name, "the limits",
               fmt::format("{:.1f} to {:.1f} deg", kDegreesPerRad * right.lower_rad,
                           kDegreesPerRad * right.upper_rad),
               fmt::format("{:.1f} to {:.1f} deg", kDegreesPerRad * lower_rad, kDegreesPerRad * upper_rad));
    }
  }

  void check_meshes() {
    std::map<std::filesystem::path, MeshFaults> known;
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      for (const sim::MeshDescription& mesh : robot_.links[i].meshes) {
        const auto shape = std::ranges::find(scene_.links[i].visuals, mesh.name, &view::Shape::name);
        if (shape == scene_.links[i].visuals.end()) {
          add("R010", Severity::kWarning, "link " + robot_.links[i].name + " " + mesh.name,
              mesh.file.filename().string() + ", which cannot be shown", "a binary STL",
              "Export the mesh as a binary STL.");
          continue;
        }
        check_mesh(robot_.links[i], mesh, *shape, known);
      }
    }
  }

  void check_mesh(const sim::LinkDescription& link, const sim::MeshDescription& mesh,
                  const view::Shape& shape, std::map<std::filesystem::path, MeshFaults>& known) {
    const std::string element = "link " + link.name + " " + mesh.name;
    const std::string file = mesh.file.filename().string();
    const auto [faults, is_new] = known.try_emplace(mesh.file);
    if (is_new) {
      faults->second = find_mesh_faults(std::get<view::Mesh>(shape.geometry));
      if (faults->second.open_edges > 0)
        add("R004", Severity::kWarning, element,
            fmt::format("{} with {} open edges", file, faults->second.open_edges), "a closed surface",
            "Close the mesh in a modeller: shadows and pictures show its holes.");
      if (faults->second.inverted)
        add("R005", Severity::kWarning, element, fmt::format("{} with triangles that face inwards", file),
            "corners counter-clockwise as seen from outside", "Turn the normals of the mesh.");
    }
    Eigen::AlignedBox3d box;
    extend(box, shape);
    const double size_m = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
    if (report_.height_m <= 0.0) return;
    if (size_m > kFarMesh * report_.height_m || size_m < kSmallMesh * report_.height_m)
      add("R006", Severity::kWarning, element, fmt::format("{} with a size of {:.3g} m", file, size_m),
          fmt::format("{:.2g} to {:.2g} m on this robot", kSmallMesh * report_.height_m,
                      kFarMesh * report_.height_m),
          size_m > kFarMesh * report_.height_m
              ? "A mesh in millimetres needs <scale>0.001 0.001 0.001</scale>."
              : "A mesh in metres needs no scale.");
  }

  // Links with fewer joints between them may overlap: their boxes hold the same servo.
  void check_overlaps() {
    const sim::LinkTree tree(robot_);
    for (std::size_t a = 0; a < robot_.links.size(); ++a)
      for (std::size_t b = a + 1; b < robot_.links.size(); ++b) {
        if (tree.distance(static_cast<int>(a), static_cast<int>(b)) < sim::kMinJointsBetween) continue;
        const double depth_m = overlap_m(robot_.links[a], robot_.links[b]);
        if (depth_m <= kTouching_m) continue;
        add("R007", Severity::kWarning, "link " + robot_.links[b].name,
            fmt::format("{} and {} overlapping by {:.1f} mm at joint angles zero", robot_.links[a].name,
                        robot_.links[b].name, kMmPerM * depth_m),
            "collision boxes apart from each other",
            "Make a box smaller: the simulation leaves contacts of this pair out.");
      }
  }

  static double overlap_m(const sim::LinkDescription& a, const sim::LinkDescription& b) {
    double depth_m = 0.0;
    for (const sim::BoxDescription& one : a.collisions)
      for (const sim::BoxDescription& other : b.collisions)
        depth_m = std::max(depth_m, sim::box_overlap_m(a.X_ML * one.X_LG, 0.5 * one.size_m,
                                                       b.X_ML * other.X_LG, 0.5 * other.size_m));
    return depth_m;
  }

  void check_soles() {
    double lowest_m = std::numeric_limits<double>::infinity();
    double highest_m = -lowest_m;
    for (std::size_t side = 0; side < 2; ++side) {
      const sim::LinkDescription& foot = robot_.links[static_cast<std::size_t>(scene_.sole_links[side])];
      for (const Vector3d& corner_L : scene_.soles_L[side]) {
        const double height_m = (foot.X_ML * corner_L).z();
        lowest_m = std::min(lowest_m, height_m);
        highest_m = std::max(highest_m, height_m);
      }
    }
    if (highest_m - lowest_m <= kLevel_m) return;
    add("R008", Severity::kWarning,
        "link " + robot_.links[static_cast<std::size_t>(scene_.sole_links[0])].name,
        fmt::format("corners of the soles whose heights differ by {:.1f} mm at joint angles zero",
                    kMmPerM * (highest_m - lowest_m)),
        fmt::format("level soles at one height, to {:.1f} mm", kMmPerM * kLevel_m),
        "Set the feet's boxes, or where joint zero is.");
  }

  // The weight on two legs that are bent alike.
  void check_squat() {
    std::vector<double> angles_rad(robot_.joints.size(), 0.0);
    std::vector<std::size_t> legs;
    for (const char* name : {"hip_pitch", "knee", "ankle_pitch"}) {
      const std::vector<sim::MirroredJoint> joints = robot_.find_joints(name);
      if (joints.size() != 2) return;
      const bool is_knee = std::string_view(name) == "knee";
      for (const auto& [index, sign] : joints) {
        const auto joint = static_cast<std::size_t>(index);
        const auto knee = static_cast<std::size_t>(robot_.find_joints("knee").front().joint);
        const double bends = robot_.joints[knee].upper_rad > -robot_.joints[knee].lower_rad ? 1.0 : -1.0;
        angles_rad[joint] = sign * bends * (is_knee ? 0.5 : -0.25) * std::numbers::pi;
        const sim::JointDescription& limits = robot_.joints[joint];
        if (angles_rad[joint] < limits.lower_rad || angles_rad[joint] > limits.upper_rad) return;
        legs.push_back(joint);
      }
    }
    Body body(robot_);
    Stance stance;
    body.solve_at_rest(angles_rad, stance);
    Squat squat;
    for (const std::size_t joint : legs) {
      const sim::ServoDescription& servo = robot_.joints[joint].servo;
      const double share = torque_share(servo, stance.torques_Nm[joint], 0.0, lowest_supply_V(servo));
      if (share > squat.share) squat = {robot_.joints[joint].name, std::abs(stance.torques_Nm[joint]), share};
    }
    report_.squat = squat;
    if (squat.share <= kHighShare) return;
    const bool cannot = squat.share > 1.0;
    add("R009", cannot ? Severity::kError : Severity::kWarning, "joint " + squat.joint,
        fmt::format("{} taking {:.0f} % of its servo's torque in a squat with knees at 90 deg", squat.joint,
                    100.0 * squat.share),
        fmt::format("at most {:.0f} %", 100.0 * (cannot ? 1.0 : kHighShare)),
        "A stronger servo, shorter legs, or less weight.");
  }

  // The battery while six servos stall; without a battery, the servo's own supply.
  double lowest_supply_V(const sim::ServoDescription& servo) const {
    if (!robot_.battery) return servo.supply_V;
    constexpr double kStalled = 6.0;
    return robot_.battery->open_circuit_V /
           (1.0 + kStalled * robot_.battery->internal_resistance_ohm / servo.resistance_ohm);
  }

  const Lines& lines_;
  const sim::RobotDescription& robot_;
  const view::Scene scene_;
  ModelReport& report_;
};

}  // namespace

bool ModelReport::has_errors() const {
  return std::ranges::any_of(
      findings, [](const ModelFinding& finding) { return finding.severity == Severity::kError; });
}

ModelReport check_model(const std::filesystem::path& file) {
  return check_model(file, sim::read_text_file(file, "an XML file"));
}

ModelReport check_model(const std::filesystem::path& file, const std::string& text) {
  ModelReport report{.file = file};
  try {
    report.robot = sim::load_robot(file, text);
  } catch (const sim::InputError& error) {
    report.findings.push_back({"R001", Severity::kError, error.line(), error.found(), error.expected(), {}});
    return report;
  }
  const Lines lines(file, text);
  ModelJudge(lines, report).run();
  return report;
}

}  // namespace koboshi::tools
