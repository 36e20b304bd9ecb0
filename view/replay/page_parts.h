#pragma once

#include <string_view>

namespace koboshi::view {

// The files that a page consists of, embedded in the program by page_parts.cc.
struct PageParts {
  std::string_view html;     // page/page.html
  std::string_view style;    // page/style.css
  std::string_view three;    // three.js and its OrbitControls
  std::string_view scripts;  // page/*.js in their order
};
PageParts page_parts();

}  // namespace koboshi::view
