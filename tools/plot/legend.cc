#include "tools/plot/legend.h"

#include <cstddef>

namespace koboshi::tools {
namespace {

enum PaletteColour { kBlue, kOrange, kGreen, kPurple, kYellow, kLightBlue, kBlack, kGrey };

// By Role.
constexpr PaletteColour kColours[] = {kOrange, kBlue,      kBlack,  kGrey, kGreen,
                                      kPurple, kLightBlue, kYellow, kGrey};

}  // namespace

int colour_of(Role role) { return kColours[static_cast<std::size_t>(role)]; }

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
