#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "base/xml/xml_draft.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// More links than any robot has; a bound of the time that a file of 16 MiB takes.
inline constexpr std::size_t kMaxImportedLinks = 400;

// Parts that the readers of URDF and SDF share.

// Throws the first violation of the rule. An element that the rule does not list becomes a line of `ignored`
// instead, once for each name, because such files carry the data of many other programs.
void require_rule(const XmlDraft& draft, const XmlRule& rule, ImportReport& report);

// Returns `count` finite numbers of magnitude below 1e6 in an attribute or a text; `what` names them in the
// error. Throws InputError with the node's line.
[[nodiscard]] std::vector<double> numbers_in(const XmlNode& node, const std::string& text, std::size_t count,
                                             const std::string& what);
[[nodiscard]] double number_in(const XmlNode& node, const std::string& text, const std::string& what);
[[nodiscard]] Eigen::Vector3d vector_in(const XmlNode& node, const std::string& text,
                                        const std::string& what);

// Returns a unit vector. Throws InputError for the zero vector.
[[nodiscard]] Eigen::Vector3d unit_vector_in(const XmlNode& node, const std::string& text,
                                             const std::string& what);

// Returns a symmetric matrix of moments and products of inertia.
[[nodiscard]] Eigen::Matrix3d inertia_from(double ixx, double iyy, double izz, double ixy, double ixz,
                                           double iyz);

// Returns a pose from a position and rotations about the fixed axes x, y and z, in this order.
[[nodiscard]] Eigen::Isometry3d pose_from(const Eigen::Vector3d& position_m,
                                          const Eigen::Vector3d& angles_rad);

}  // namespace koboshi::tools
