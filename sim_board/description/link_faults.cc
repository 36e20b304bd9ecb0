#include <Eigen/Core>

#include "base/text/text.h"
#include "mechanics/axes.h"
#include "sim_board/description/fault_list.h"
#include "sim_board/description/load_parts.h"

namespace koboshi::sim_board {
namespace {

// The principal moments of a rigid body are positive, and none exceeds the sum of the others. A thin plate
// equals the sum exactly, so the margin allows for rounding in the file.
void find_inertia_faults(const XmlNode& link, FaultList& faults) {
  constexpr double kMargin = 1e-4;
  const XmlNode node = link.child("inertial").child("inertia");
  const Eigen::Vector3d moments = mechanics::principal_inertia(inertia_matrix(node)).moments;
  const std::string found = "principal moments " + number_text(moments[0]) + ", " + number_text(moments[1]) +
                            " and " + number_text(moments[2]) + " kg m^2 in link " + link.attribute("name");
  if (moments[0] < 1e-12) {
    faults.add(RobotFaultKind::kInertia, node, found, "positive ones");
  } else if (moments[2] > (moments[0] + moments[1]) * (1 + kMargin)) {
    faults.add(RobotFaultKind::kInertia, node, found, "none greater than the sum of the others");
  }
}

void find_collision_faults(const XmlNode& collision, FaultList& faults) {
  const auto direction = collision.child("surface").child("friction").child("ode").find("fdir1");
  if (!direction) return;
  const std::vector<double> values = direction->numbers();
  if (Eigen::Vector3d(values[0], values[1], values[2]).norm() >= 1e-4) return;
  faults.add(RobotFaultKind::kShape, *direction, "<fdir1> = " + one_line(direction->text()),
             "a direction, any but zero");
}

void find_visual_faults(const XmlNode& visual, const std::filesystem::path& folder, FaultList& faults) {
  const XmlNode geometry = visual.child("geometry");
  const auto mesh = geometry.find("mesh");
  if (geometry.find("box").has_value() == mesh.has_value()) {
    faults.add(RobotFaultKind::kShape, geometry,
               "<geometry> of visual " + visual.attribute("name") + " with none or several",
               "one box or one mesh");
  }
  if (!mesh) return;
  const XmlNode uri = mesh->child("uri");
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder / uri.text(), ignored)) {
    faults.add(RobotFaultKind::kMesh, uri, "<uri> = " + one_line(uri.text()),
               "a mesh file that exists, relative to this file's folder");
  }
}

}  // namespace

void find_link_faults(const XmlNode& link, const std::filesystem::path& folder, FaultList& faults) {
  find_inertia_faults(link, faults);
  for (const XmlNode& collision : link.children("collision")) find_collision_faults(collision, faults);
  for (const XmlNode& visual : link.children("visual")) find_visual_faults(visual, folder, faults);
  for (const XmlNode& sensor : link.children("sensor")) find_sensor_faults(sensor, faults);
}

}  // namespace koboshi::sim_board
