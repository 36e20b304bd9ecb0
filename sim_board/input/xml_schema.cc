#include "sim_board/input/xml_schema.h"

namespace koboshi::sim {

std::string describe_values(XmlContent content, std::size_t numbers, const NumberRange& range,
                            const std::vector<std::string>& choices) {
  if (!choices.empty()) return join_alternatives(choices);
  switch (content) {
    case XmlContent::kText:
      return "a text";
    case XmlContent::kNumbers:
      return numbers == 1 ? describe(range) : std::to_string(numbers) + " times " + describe(range);
    case XmlContent::kInteger:
      return "a whole number" + describe(range).substr(std::string("a number").size());
    case XmlContent::kChildren:
    case XmlContent::kAnything:
      break;
  }
  return {};
}

}  // namespace koboshi::sim
