#include "studio/parameters/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text/user_units.h"

namespace koboshi::studio {
namespace {

constexpr std::uint64_t kMillisecond_us = 1000;
constexpr std::size_t kSamplesPerSecond = 100;
constexpr float kTint = 0.45F;  // share of the run's colour in that of a link
// Nobody rewinds these runs.
constexpr std::size_t kSnapshotBudget_bytes = std::size_t{4} << 20;

float mixed(float colour, float tint) { return (1.0F - kTint) * colour + kTint * tint; }

void tint(std::vector<view::Shape>& shapes, const view::Colour& colour) {
  for (view::Shape& shape : shapes)
    shape.colour = {mixed(shape.colour.red, colour.red), mixed(shape.colour.green, colour.green),
                    mixed(shape.colour.blue, colour.blue)};
}

double yaw_rad(const view::Pose& trunk) {
  const Eigen::Vector3f x_W = trunk.q_WL * Eigen::Vector3f::UnitX();
  return std::atan2(static_cast<double>(x_W.y()), static_cast<double>(x_W.x()));
}

// Displacement since the start: forward, and to the left of the heading there.
Eigen::Vector2d displacement_m(const view::Recording& recording, std::size_t sample) {
  const view::Pose& first = recording.samples.front().links.front();
  const view::Pose& now = recording.samples[sample].links.front();
  const Eigen::Vector2d moved_W = (now.p_WL_m - first.p_WL_m).head<2>().cast<double>();
  return Eigen::Rotation2Dd(-yaw_rad(first)) * moved_W;
}

}  // namespace

Comparison::Comparison(std::array<simulation::Scenario, kRuns> scenarios)
    : duration_us_(scenarios[0].duration_us) {
  scenarios[1].seed = scenarios[0].seed;
  for (std::size_t run = 0; run < kRuns; ++run) {
    runs_[run].session = std::make_unique<Session>(
        scenarios[run], Session::Options{.snapshot_budget_bytes = kSnapshotBudget_bytes});
    runs_[run].recording = runs_[run].session->head();
  }
}

void Comparison::advance(std::uint64_t milliseconds) {
  const std::uint64_t left = (std::max(duration_us_, target_us_) - target_us_) / kMillisecond_us;
  milliseconds = std::min(milliseconds, left);
  if (milliseconds == 0) return;
  target_us_ += milliseconds * kMillisecond_us;
  for (Run& run : runs_) run.session->step(milliseconds);
}

void Comparison::give(const Input& input) {
  for (Run& run : runs_) run.session->give(input);
}

bool Comparison::is_busy() const {
  return std::ranges::any_of(runs_, [this](const Run& run) {
    const SessionStatus status = run.session->status();
    return status.state != SessionStatus::State::kFailed && status.time_us < target_us_;
  });
}

void Comparison::wait() {
  for (Run& run : runs_) run.session->wait();
}

std::string Comparison::error() const {
  for (std::size_t run = 0; run < kRuns; ++run) {
    const SessionStatus status = this->status(run);
    if (status.state == SessionStatus::State::kFailed)
      return std::string(run == 0 ? "A: " : "B: ") + status.message;
  }
  return {};
}

bool Comparison::take() {
  bool grew = false;
  for (Run& run : runs_) {
    Batch batch = run.session->take();
    batch.frames.clear();  // nobody looks at them
    grew = grew || !batch.samples.empty() || batch.events.has_value();
    append(std::move(batch), run.recording);
  }
  return grew;
}

std::size_t Comparison::common_samples() const {
  return std::min(runs_[0].recording.samples.size(), runs_[1].recording.samples.size());
}

std::vector<ComparedResult> compare(const simulation::RunSummary& a, const simulation::RunSummary& b) {
  const auto of = [](const simulation::RunSummary& run, double simulation::WalkSummary::*member) {
    return run.walk ? (*run.walk).*member : std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<ComparedResult> results;
  const auto add = [&](const char* name, const char* unit, int decimals,
                       double simulation::WalkSummary::*member, double scale = 1.0) {
    results.push_back({name, unit, decimals, {scale * of(a, member), scale * of(b, member)}});
  };
  constexpr double kMillimetres = 1e3;
  add("Speed", "m/s", 3, &simulation::WalkSummary::speed_m_per_s);
  add("Distance", "m", 3, &simulation::WalkSummary::distance_m);
  add("Drift to the left", "m", 3, &simulation::WalkSummary::lateral_drift_m);
  add("Turn", "deg", 1, &simulation::WalkSummary::heading_drift_rad, kDegreesPerRad);
  add("ZMP error", "mm", 1, &simulation::WalkSummary::zmp_rms_error_m, kMillimetres);
  add("ZMP margin", "mm", 1, &simulation::WalkSummary::zmp_margin_p05_m, kMillimetres);
  add("Roll", "deg", 2, &simulation::WalkSummary::roll_rms_rad, kDegreesPerRad);
  add("Energy", "J", 1, &simulation::WalkSummary::energy_J);
  results.push_back({"Falls", "", 0, {static_cast<double>(a.falls), static_cast<double>(b.falls)}});
  return results;
}

double trunk_quantity(const view::Recording& recording, std::size_t sample, TrunkQuantity quantity) {
  const view::Pose& trunk = recording.samples[sample].links.front();
  const Eigen::Vector2d moved_m = displacement_m(recording, sample);
  switch (quantity) {
    case TrunkQuantity::kDistance:
      return moved_m.x();
    case TrunkQuantity::kDrift:
      return moved_m.y();
    case TrunkQuantity::kLean:
      return std::acos(
          std::clamp(static_cast<double>((trunk.q_WL * Eigen::Vector3f::UnitZ()).z()), -1.0, 1.0));
    case TrunkQuantity::kSpeed:
      break;
  }
  if (sample == 0) return 0.0;
  const std::size_t before = sample > kSamplesPerSecond ? sample - kSamplesPerSecond : 0;
  const double elapsed_s =
      1e-6 * static_cast<double>(recording.samples[sample].time_us - recording.samples[before].time_us);
  return (moved_m.x() - displacement_m(recording, before).x()) / elapsed_s;
}

view::Scene scene_of_both(const view::Scene& a, const view::Scene& b,
                          const std::array<view::Colour, Comparison::kRuns>& colours) {
  view::Scene scene = a;
  const auto count = static_cast<int>(a.links.size());
  for (view::Link& link : scene.links) tint(link.visuals, colours[0]);
  for (view::Link link : b.links) {
    if (link.parent >= 0) link.parent += count;
    tint(link.visuals, colours[1]);
    scene.links.push_back(std::move(link));
  }
  for (std::size_t i = 0; i < scene.links.size(); ++i)
    scene.links[i].name.insert(0, i < a.links.size() ? "A: " : "B: ");
  return scene;
}

std::vector<view::Pose> poses_of_both(const std::vector<view::Pose>& a, const std::vector<view::Pose>& b,
                                      double apart_m) {
  const auto half_m = static_cast<float>(0.5 * apart_m);
  std::vector<view::Pose> poses = a;
  for (view::Pose& pose : poses) pose.p_WL_m.y() += half_m;
  for (view::Pose pose : b) {
    pose.p_WL_m.y() -= half_m;
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace koboshi::studio
