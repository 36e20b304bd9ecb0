#include "tools/teleop/page_keys.h"

#include <string>
#include <string_view>

namespace koboshi::tools {

view::PageKeys page_keys(KeyQueue& queue) {
  using Answer = view::PageKeys::Answer;
  view::PageKeys keys;
  for (const KeyHelp& row : key_help()) keys.rows.push_back({row.browser_keys, std::string(row.name)});
  keys.press = [&queue](std::string_view name) {
    const auto key = key_of_browser(name);
    if (!key) return Answer::kUnknown;
    return queue.push(*key) ? Answer::kTaken : Answer::kBusy;
  };
  return keys;
}

}  // namespace koboshi::tools
