#pragma once

#include <array>
#include <string_view>

#include "view/recording/recording.h"

namespace koboshi::view {

// The looks that studio, films and replay page share: the colours of marks, the directions to look
// from and the keys for them. The page has them as JSON (view/replay/replay_page.cc).

// Colours of the marks, those of the figures (tools/plot/legend.h): after Okabe and Ito 2008, told apart
// with any colour vision. Left is green and right purple. They are not the red and green of ships' lights,
// because red means a fault, and because many people cannot tell these two apart.
inline constexpr Colour kPlannedColour{0.835F, 0.369F, 0.0F};
inline constexpr Colour kMeasuredColour{0.0F, 0.447F, 0.698F};
inline constexpr Colour kTrueColour{0.08F, 0.08F, 0.09F};
inline constexpr Colour kComColour{0.902F, 0.624F, 0.0F};
inline constexpr Colour kContactColour{0.0F, 0.62F, 0.451F};
inline constexpr Colour kPushColour{0.80F, 0.12F, 0.16F};
inline constexpr std::array<Colour, 2> kSideColours{{{0.0F, 0.62F, 0.451F}, {0.8F, 0.475F, 0.655F}}};

// A direction to look from: azimuth 0 from ahead (+x) and 90 from the robot's left, elevation above the
// horizon.
struct NamedView {
  char key;
  std::string_view option;  // of `koboshi render --view`
  std::string_view name;    // on a button
  double azimuth_deg;
  double elevation_deg;
};
inline constexpr std::array<NamedView, 4> kNamedViews{{{'1', "front", "front", 0.0, 6.0},
                                                       {'2', "side", "left", 90.0, 6.0},
                                                       {'3', "top", "top", 180.0, 90.0},
                                                       {'4', "iso", "3/4", 50.0, 14.0}}};

// A key that means the same in the studio and in the page, as far as both have it; as a browser names it: "F"
// is Shift and F.
struct SharedKey {
  std::string_view action;
  std::string_view key;
};
inline constexpr std::array<SharedKey, 7> kSharedKeys{{{"play", " "},
                                                       {"tick", "."},
                                                       {"tick_back", ","},
                                                       {"begin", "Home"},
                                                       {"end", "End"},
                                                       {"look", "f"},
                                                       {"follow", "F"}}};

}  // namespace koboshi::view
