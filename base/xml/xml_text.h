#pragma once

#include <string>
#include <string_view>

namespace koboshi {

// Returns a text as it may stand between tags, or in an attribute in double quotes.
std::string xml_escaped(std::string_view text);

}  // namespace koboshi
