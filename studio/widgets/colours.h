#pragma once

#include <QColor>
#include <QPalette>

#include "simulation/motion_language/parse/diagnostic.h"

namespace koboshi::studio {

// The colours of the motion editor on a light or dark palette.
struct Colours {
  QColor error, warning, note;
  QColor stable, close, unstable;  // bands of the stability margin
  QColor key, wait, arrow, jump;   // of the timeline
  QColor angle, speed, torque;     // curves
  QColor grid, dim, lane;

  const QColor& of(simulation::Severity severity) const;
};

[[nodiscard]] Colours colours_of(const QPalette& palette);
// The first colour with this share (0..1) of the other.
[[nodiscard]] QColor mixed(const QColor& one, const QColor& other, float share);

}  // namespace koboshi::studio
