#include "tools/lab/plot/legend.h"

namespace koboshi::tools {
namespace {

enum PaletteColour { kBlue, kOrange, kGreen, kPurple, kYellow, kLightBlue, kBlack, kGrey };

}  // namespace

int colour_of(Role role) {
  switch (role) {
    case Role::kPlanned:
      return kOrange;
    case Role::kMeasured:
      return kBlue;
    case Role::kTrue:
      return kBlack;
    case Role::kTheory:
    case Role::kThird:
      return kGrey;
    case Role::kLeft:
      return kGreen;
    case Role::kRight:
      return kPurple;
    case Role::kFirst:
      return kLightBlue;
    case Role::kSecond:
      return kYellow;
  }
  return kBlack;
}

LineStyle style_of(Role role) {
  return role == Role::kPlanned || role == Role::kTheory ? LineStyle::kDashed : LineStyle::kSolid;
}

Series series(Role role, const std::string& column, const std::string& label, double factor) {
  return {
      .column = column, .label = label, .style = style_of(role), .colour = colour_of(role), .factor = factor};
}

Series planned_series(Role side, const std::string& column, const std::string& label, double factor) {
  Series made = series(side, column, label, factor);
  made.style = LineStyle::kDashed;
  return made;
}

}  // namespace koboshi::tools
