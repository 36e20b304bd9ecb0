#pragma once

#include <string>

#include "tools/dictionary/object_dictionary.h"

namespace koboshi::tools {

// The electronic data sheet of a kind of node, CiA 306-1. It knows no date of its own: the same table gives
// the same bytes.
std::string eds_text(const NodeKind& kind);

}  // namespace koboshi::tools
