#pragma once

#include <QIcon>
#include <QPalette>

#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::studio {

// A sign for the kind of a step.
[[nodiscard]] QIcon kind_icon(simulation::StepSource::Kind kind, const QPalette& palette);
// A round error, a triangular warning, a square note.
[[nodiscard]] QIcon severity_icon(simulation::Severity severity, const QPalette& palette);
// A tick: nothing is found.
[[nodiscard]] QIcon good_icon(const QPalette& palette);

}  // namespace koboshi::studio
