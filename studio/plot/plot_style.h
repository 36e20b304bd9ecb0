#pragma once

#include <QColor>
#include <QPalette>
#include <QString>
#include <span>

#include "view/recording/recording.h"

namespace koboshi::studio {

// Colours of plots for a palette. Traces and states have the colours of the replay page (format.js); a test
// compares them.
struct PlotStyle {
  explicit PlotStyle(const QPalette& palette);

  QColor trace(int index) const;

  bool dark;
  QColor background;
  QColor ink;
  QColor dim;   // labels of axes
  QColor rule;  // grid
  QColor zero;  // grid at zero, and events
  QColor cursor;
  QColor warning;
};

// The traces' colours after Okabe and Ito: distinguishable with any colour vision.
std::span<const QRgb> trace_colours(bool dark);
// The colour of a state: states that mean the same look the same in every run; others have colours by their
// index.
QColor state_colour(const QString& name, int index);
// Black or white, whichever is easier to read on a colour.
QColor ink_on(const QColor& colour);

// The factor and the unit in which values of a recorded unit are shown.
struct ShownUnit {
  double factor = 1.0;
  QString text{};
};
// Radians are shown in degrees, and metres in millimetres if no value exceeds half a metre.
ShownUnit shown_unit(const std::string& unit, double max_magnitude);

// Returns 1, 2 or 5 times a power of ten, so that `range` has at most `count` steps.
double nice_step(double range, double count);
// Returns the number of decimals that multiples of a step need.
int decimals_of(double step);
// A number with a typographic minus; a dash if it is not finite.
QString number_text(double value, int decimals);
// The name of an integer signal's value, or the value with its unit.
QString value_text(const view::Signal& signal, float value, const ShownUnit& unit, int decimals);

}  // namespace koboshi::studio
