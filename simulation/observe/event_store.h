#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "simulation/record/summary.h"

namespace koboshi::simulation {

// A bounded store of events. A flood of events of one cause hides no event of another one: of each cause it
// keeps the first and the last event and counts those that it leaves out.
class EventStore {
 public:
  // Stored events of one cause.
  static constexpr std::size_t kMaxOfCause = 100;
  // Beyond this number, only the first event of each cause is stored.
  static constexpr std::size_t kMaxEvents = 2000;
  // Causes of one kind of event. Further ones count as one cause.
  static constexpr std::size_t kMaxCauses = 1000;

  // Adds an event. `cause` distinguishes the causes of one kind. Returns the event's index, or nothing if the
  // event is only counted.
  std::optional<std::size_t> add(const RunEvent& event, const std::string& cause);

  // The stored events, in the order in which they were added.
  std::span<const RunEvent> stored() const { return stored_; }
  RunEvent& operator[](std::size_t index) { return stored_[index]; }
  // Returns the stored events, and for each cause with events that are left out their count and the last
  // event.
  std::vector<RunEvent> all() const;

 private:
  struct Cause {
    std::size_t stored = 0;
    std::size_t left_out = 0;
    RunEvent last{};  // of those left out
  };

  std::vector<RunEvent> stored_;
  std::map<std::string, std::map<std::string, Cause>> causes_;  // by kind
};

}  // namespace koboshi::simulation
