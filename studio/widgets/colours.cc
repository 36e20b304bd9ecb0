#include "studio/widgets/colours.h"

namespace koboshi::studio {

QColor mixed(const QColor& one, const QColor& other, float share) {
  const auto mix = [share](float a, float b) { return a * (1.0F - share) + b * share; };
  return QColor::fromRgbF(mix(one.redF(), other.redF()), mix(one.greenF(), other.greenF()),
                          mix(one.blueF(), other.blueF()));
}

const QColor& Colours::of(simulation::Severity severity) const {
  if (severity == simulation::Severity::kError) return error;
  return severity == simulation::Severity::kWarning ? warning : note;
}

Colours colours_of(const QPalette& palette) {
  const QColor base = palette.color(QPalette::Base);
  const QColor text = palette.color(QPalette::Text);
  const bool dark = base.lightness() < 128;
  // Okabe and Ito 2008: told apart with any colour vision. Lighter variants on a dark ground.
  Colours colours;
  colours.error = dark ? QColor(255, 110, 90) : QColor(200, 50, 20);
  colours.warning = dark ? QColor(240, 180, 60) : QColor(190, 120, 0);
  colours.note = dark ? QColor(110, 190, 240) : QColor(0, 100, 170);
  colours.stable = dark ? QColor(40, 180, 135) : QColor(0, 158, 115);
  colours.close = dark ? QColor(240, 180, 60) : QColor(230, 159, 0);
  colours.unstable = dark ? QColor(240, 110, 60) : QColor(213, 94, 0);
  colours.key = dark ? QColor(90, 170, 230) : QColor(0, 114, 178);
  colours.wait = mixed(base, text, 0.35F);
  colours.arrow = mixed(base, text, 0.65F);
  colours.jump = dark ? QColor(220, 150, 190) : QColor(180, 90, 140);
  colours.angle = colours.key;
  colours.speed = colours.close;
  colours.torque = colours.jump;
  colours.grid = mixed(base, text, 0.12F);
  colours.dim = mixed(base, text, 0.55F);
  colours.lane = mixed(base, text, 0.04F);
  return colours;
}

}  // namespace koboshi::studio
