#pragma once

namespace koboshi::studio {

enum class Theme { kLight, kDark };

// Colours all windows of the application.
void apply_theme(Theme theme);

}  // namespace koboshi::studio
