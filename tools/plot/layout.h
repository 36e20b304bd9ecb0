#pragma once

namespace koboshi::tools {

// The layout that all figures share, in pixels.
inline constexpr int kWidth_px = 1000;
inline constexpr int kTitle_px = 22;  // from the top to the title's base line
inline constexpr int kFoot_px = 60;   // tick labels and label of the abscissa
inline constexpr int kLeft_px = 90;
inline constexpr int kRight_px = 25;
inline constexpr int kNote_px = 42;    // from the top to the note's base line
inline constexpr int kKeyRow_px = 18;  // a row of the key

// Mean widths of letters.
inline constexpr double kSmallGlyph_px = 6.2;  // of marks and notes
inline constexpr double kKeyGlyph_px = 8.5;

}  // namespace koboshi::tools
