#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/motion/motion.h"
#include "simulation/motion_language/parse/diagnostic.h"

namespace koboshi::simulation {

// Collects the steps of an image. A jump names a label, which may be placed later; `set_targets` then fills
// in the steps' numbers.
class ProgramWriter {
 public:
  using Label = std::size_t;

  explicit ProgramWriter(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  // Adds a step that was made from the source at `place`. Reports the first step beyond motion::kMaxSteps.
  void add(const motion::Step& step, const Place& place);
  // Adds a step whose operand is the label's position.
  void add_to(Label label, const motion::Step& step, const Place& place);
  void add_jump(Label label, const Place& place);

  [[nodiscard]] Label new_label();
  // Puts the label before the next step.
  void place_label(Label label) { positions_[label] = position(); }
  // Returns the position of a placed label.
  [[nodiscard]] std::uint16_t position_of(Label label) const { return positions_[label].value(); }
  // Whether a label is placed before the next step.
  [[nodiscard]] bool has_label_here() const;
  // Fills in the targets of all jumps to placed labels.
  void set_targets();

  [[nodiscard]] std::uint16_t position() const { return static_cast<std::uint16_t>(steps_.size()); }
  [[nodiscard]] const std::vector<motion::Step>& steps() const { return steps_; }
  [[nodiscard]] std::vector<motion::Step> take_steps() { return std::move(steps_); }
  [[nodiscard]] std::vector<Place> take_places() { return std::move(places_); }

 private:
  Diagnostics& diagnostics_;
  std::vector<motion::Step> steps_;
  std::vector<Place> places_;  // by step
  bool is_full_ = false;
  std::vector<std::optional<std::uint16_t>> positions_;  // by label
  std::vector<std::pair<std::size_t, Label>> jumps_;     // steps whose operand is a label's position
};

}  // namespace koboshi::simulation
