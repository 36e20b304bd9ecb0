#include "simulation/observe/event_store.h"

#include "simulation/observe/event_words.h"

namespace koboshi::simulation {

std::optional<std::size_t> EventStore::add(const RunEvent& event, const std::string& cause) {
  auto& of_kind = causes_[event.kind];
  const bool is_known = of_kind.contains(cause) || of_kind.size() < kMaxCauses;
  Cause& same = of_kind[is_known ? cause : std::string()];
  if (same.stored == 0 || (same.stored < kMaxOfCause && stored_.size() < kMaxEvents)) {
    ++same.stored;
    stored_.push_back(event);
    return stored_.size() - 1;
  }
  ++same.left_out;
  same.last = event;
  return std::nullopt;
}

std::vector<RunEvent> EventStore::all() const {
  std::vector<RunEvent> events = stored_;
  for (const auto& [kind, causes] : causes_) {
    for (const auto& [cause, same] : causes) {
      if (same.left_out > 1) {
        const std::size_t count = same.left_out - 1;
        events.push_back({same.last.time_us,
                          "left_out",
                          count_text(count, "more event") + " like the next, not listed.",
                          {{"count", count}, {"kind", kind}}});
      }
      if (same.left_out > 0) events.push_back(same.last);
    }
  }
  return events;
}

}  // namespace koboshi::simulation
