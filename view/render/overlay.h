#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/recording/recording.h"
#include "view/render/footprints.h"
#include "view/render/looks.h"
#include "view/render/marks.h"
#include "view/render/playback.h"

namespace koboshi::view {

// The parts of a picture besides robot and ground.
enum class Overlay {
  kTime,        // time, title and state
  kEvents,      // the latest event
  kZmp,         // zero moment point: planned, measured, true
  kCom,         // centre of mass and its projection
  kContacts,    // contact forces
  kPushes,      // pushes while they act
  kFootprints,  // soles that stood still, of the last seconds
  kSupport,     // support polygon
  kLegend,      // meaning of the marks, and the scales
};
inline constexpr std::array<std::string_view, 9> kOverlayNames{
    "time", "events", "zmp", "com", "contacts", "pushes", "footprints", "support", "legend"};

class Overlays {
 public:
  bool has(Overlay overlay) const { return (bits_ & bit(overlay)) != 0; }
  void add(Overlay overlay) { bits_ |= bit(overlay); }

 private:
  static unsigned bit(Overlay overlay) { return 1U << static_cast<unsigned>(overlay); }
  unsigned bits_ = 0;
};

inline constexpr double kForceScale_m_per_N = 0.008;  // length of arrows; the legend shows it

// A zero moment point of a recording: the signals NAME_x and NAME_y. Rings in each other, so that coincident
// points look like a target.
struct ZmpMark {
  std::string_view signal;
  std::string_view text;  // in the legend
  Colour colour;
  double radius_m;
  double inner_radius_m;
};
inline constexpr std::array<ZmpMark, 3> kZmpMarks{{{"planned_zmp", "planned", kPlannedColour, 0.0120, 0.0090},
                                                   {"zmp", "measured", kMeasuredColour, 0.0080, 0.0052},
                                                   {"true_zmp", "true", kTrueColour, 0.0040, 0.0}}};

// The support polygon: the convex hull of the points at which the ground carries the robot and, on a plane,
// the corners of the soles that carry and touch it (sim_board::kTouching_m): solvers leave some corners of a
// sole at rest without force. Seen from above, counter-clockwise. Fewer than three corners: the robot has
// none.
std::vector<Eigen::Vector2d> support_polygon_W_m(const Scene& scene, const Sample& sample);

// A zero moment point of kZmpMarks whose signals a recording has.
struct ZmpSignals {
  std::array<std::size_t, 2> signals;  // x and y in the ground plane, world
  const ZmpMark* mark;

  // NaN where the sample has none.
  Eigen::Vector2d at(const Sample& sample) const;
};
std::vector<ZmpSignals> zmp_signals(const Recording& recording);

// The marks of a recording at each time.
class OverlayMarks {
 public:
  // The recording must outlive this.
  OverlayMarks(const Recording& recording, const Overlays& overlays);
  Marks at(std::uint64_t time_us) const;
  // The recording has other samples from this index on.
  void follow(std::size_t first_sample);

 private:
  void add_footprints_at(Marks& marks, std::uint64_t time_us) const;
  void add_support(Marks& marks, const Sample& sample) const;
  void add_zmp(Marks& marks, const Sample& sample) const;
  void add_com(Marks& marks, std::uint64_t time_us, const Sample& sample) const;
  void add_contacts(Marks& marks, const Sample& sample) const;
  void add_pushes(Marks& marks, std::uint64_t time_us) const;
  double ground_m(const Sample& sample, const Eigen::Vector2d& p_W_m) const;

  const Recording& recording_;
  Overlays overlays_;
  Footprints footprints_;
  std::vector<ZmpSignals> zmps_;
};

}  // namespace koboshi::view
