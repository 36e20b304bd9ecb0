#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/walk/velocity.h"
#include "simulation/scenario/object_access.h"

namespace koboshi::studio {

// Asks a controller on a bus for its velocity limits and the names of its motions, by SDO. It asks
// again after a time-out or a disturbed transfer: the robot may be slow, or just start.
class ControllerInquiry {
 public:
  // Numbers of its requests, above those of LiveParameters and WalkAgain.
  static constexpr std::uint64_t kFirstNumber = std::uint64_t{8} << 40;
  // From a failure to the next attempt. Set by hand (2026-11-25): other accesses find the channel free.
  static constexpr std::uint64_t kRetry_us = 500'000;

  // kMotions: it does not ask for the limits.
  enum class Scope : std::uint8_t { kAll, kMotions };
  explicit ControllerInquiry(Scope scope = Scope::kAll);
  bool asks_limits() const { return scope_ == Scope::kAll; }

  // Returns the requests to send now. Times never decrease.
  [[nodiscard]] std::vector<simulation::ObjectRequest> due(std::uint64_t now_us);
  // Returns whether the answer is to one of its requests.
  bool take(const simulation::ObjectAnswer& answer, std::uint64_t now_us);

  // Limits that are not answered yet, or that the controller does not have, are 0.
  const walk::VelocityLimits& limits() const { return limits_; }
  // Whether all questions have been answered.
  bool complete() const { return answered_ == questions_.size(); }
  // Numbers and names of the motions that the robot can play, in the order of their numbers.
  std::vector<std::pair<std::uint16_t, std::string>> motions() const;

 private:
  enum class Kind : std::uint8_t { kLimit, kMask, kName };
  struct Question {
    Kind kind;
    std::uint16_t number = 0;  // of the limit, the mask, or the motion
    bool under_way = false;
    bool answered = false;
    std::uint64_t due_us = 0;
    std::string name{};  // of the motion; empty: none
  };

  void accept(const Question& question, const std::vector<std::uint8_t>& data);

  const Scope scope_;
  std::vector<Question> questions_;
  std::size_t answered_ = 0;
  walk::VelocityLimits limits_;
};

}  // namespace koboshi::studio
