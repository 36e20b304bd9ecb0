#pragma once

#include <span>
#include <string>

#include "tools/dictionary/network.h"
#include "tools/dictionary/object_dictionary.h"

namespace koboshi::tools {

// docs/reference/object-dictionary.md: the objects of all kinds of nodes and the PDOs of a network, for
// people.
std::string page_text(std::span<const NodeKind> kinds, const Network& network);

}  // namespace koboshi::tools
