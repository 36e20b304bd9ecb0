#pragma once

#include "tools/import/decide/decisions.h"
#include "tools/import/robot/imported_robot.h"
#include "tools/import/robot/report.h"

namespace koboshi::tools {

// Repairs masses and inertias that no such body has, link by link of the source: an inertia out of proportion
// to mass and size, a centre of mass outside of the shape, links without a shape that have the inertia of
// another. The surfaces must be loaded.
void repair_links(ImportedRobot& robot, Interview& interview, ImportReport& report);

// Repairs what only the links of the final tree show: no mass.
void repair_masses(ImportedRobot& robot, Interview& interview, ImportReport& report);

// Adds a repair to the report and to the decisions. Returns whether the value is to be replaced.
[[nodiscard]] bool take_repair(ImportRepair repair, Interview& interview, ImportReport& report);

}  // namespace koboshi::tools
