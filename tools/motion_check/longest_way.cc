#include "tools/motion_check/longest_way.h"

#include <algorithm>

namespace koboshi::tools {
namespace {

class LongestWay {
 public:
  LongestWay(const std::vector<Leg>& legs, std::size_t visits) : legs_(legs), rest_(visits), open_(visits) {}

  std::size_t ticks() {
    std::size_t longest = 0;
    for (const Leg& leg : legs_) longest = std::max(longest, leg.ticks + rest_of(leg));
    return longest;
  }

 private:
  std::size_t rest_of(const Leg& leg) { return leg.merged_into ? rest_from(*leg.merged_into) : 0; }

  std::size_t rest_from(std::size_t visit) {
    if (rest_[visit]) return *rest_[visit];
    if (open_[visit]) return 0;
    open_[visit] = true;
    std::size_t longest = 0;
    for (const Leg& leg : legs_) {
      const auto passed = leg.passed.find(visit);
      if (passed != leg.passed.end()) longest = std::max(longest, leg.ticks - passed->second + rest_of(leg));
    }
    open_[visit] = false;
    rest_[visit] = longest;
    return longest;
  }

  const std::vector<Leg>& legs_;
  std::vector<std::optional<std::size_t>> rest_;
  std::vector<bool> open_;
};

}  // namespace

std::size_t longest_way(const std::vector<Leg>& legs, std::size_t visits) {
  return LongestWay(legs, visits).ticks();
}

}  // namespace koboshi::tools
