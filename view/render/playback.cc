#include "view/render/playback.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace koboshi::view {
namespace {

Eigen::Isometry3d X_WL(const Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = pose.q_WL.cast<double>().toRotationMatrix();
  result.translation() = pose.p_WL_m.cast<double>();
  return result;
}

}  // namespace

std::size_t sample_at(const Recording& recording, std::uint64_t time_us) {
  const auto after = std::ranges::upper_bound(recording.samples, time_us, {}, &Sample::time_us);
  const auto index = std::distance(recording.samples.begin(), after);
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(index - 1, 0));
}

std::vector<Pose> poses_at(const Recording& recording, std::uint64_t time_us) {
  const std::size_t index = sample_at(recording, time_us);
  const Sample& before = recording.samples[index];
  if (index + 1 == recording.samples.size() || time_us <= before.time_us) return before.links;
  const Sample& after = recording.samples[index + 1];
  const float share =
      static_cast<float>(time_us - before.time_us) / static_cast<float>(after.time_us - before.time_us);
  std::vector<Pose> poses(before.links.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].p_WL_m = (1.0F - share) * before.links[i].p_WL_m + share * after.links[i].p_WL_m;
    poses[i].q_WL = before.links[i].q_WL.slerp(share, after.links[i].q_WL);
  }
  return poses;
}

std::optional<std::size_t> find_signal(const Recording& recording, std::string_view name) {
  const auto found = std::ranges::find(recording.signals, name, &Signal::name);
  if (found == recording.signals.end()) return std::nullopt;
  return static_cast<std::size_t>(found - recording.signals.begin());
}

std::string name_of_value(const Recording& recording, std::size_t signal, std::size_t sample) {
  const float value = recording.samples[sample].values[signal];
  if (std::isnan(value)) return {};
  const auto number = static_cast<std::int64_t>(std::lround(value));
  const auto& names = recording.signals[signal].names;
  const auto found = std::ranges::find(names, number, [](const auto& entry) { return entry.first; });
  return found == names.end() ? std::string() : found->second;
}

Eigen::Vector3d centre_of_mass_W_m(const Scene& scene, const std::vector<Pose>& links) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double mass_kg = 0.0;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    moment += scene.links[i].mass_kg * (X_WL(links[i]) * scene.links[i].p_LCom_L);
    mass_kg += scene.links[i].mass_kg;
  }
  return mass_kg > 0.0 ? Eigen::Vector3d(moment / mass_kg) : moment;
}

}  // namespace koboshi::view
