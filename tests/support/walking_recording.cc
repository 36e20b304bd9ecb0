#include "tests/support/walking_recording.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace koboshi::view {
namespace {

constexpr std::uint64_t kTick_us = 10'000;
constexpr double kSpeed_m_per_s = 0.1;
constexpr double kStep_s = 0.5;
constexpr double kHip_m = 0.04;  // lateral distance of a leg from the middle
constexpr double kWeight_N = 12.0;
constexpr std::uint8_t kFirstDrive = 16;

constexpr canopen::ValueName kStates[] = {{0, "boot"}, {4, "standing"}, {8, "walking"}};
constexpr canopen::ValueName kModes[] = {{1, "profile position"}, {8, "cyclic synchronous position"}};

// Deterministic numbers in [-1, 1): Knuth's linear congruential generator.
class Noise {
 public:
  double next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(static_cast<std::int32_t>(state_ >> 32)) * 0x1p-31;
  }

 private:
  std::uint64_t state_ = 1;
};

// A sphere of triangles.
Mesh sphere(double radius_m) {
  constexpr int kRings = 12;
  constexpr int kSectors = 20;
  Mesh mesh;
  for (int ring = 0; ring <= kRings; ++ring) {
    const double polar = std::numbers::pi * ring / kRings;
    for (int sector = 0; sector < kSectors; ++sector) {
      const double azimuth = 2.0 * std::numbers::pi * sector / kSectors;
      const Eigen::Vector3d p(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                              std::cos(polar));
      mesh.vertices_m.push_back((radius_m * p).cast<float>());
    }
  }
  const auto index = [](int ring, int sector) {
    return static_cast<std::uint32_t>(ring * kSectors + sector % kSectors);
  };
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < kSectors; ++sector) {
      mesh.triangles.push_back({index(ring, sector), index(ring + 1, sector), index(ring, sector + 1)});
      mesh.triangles.push_back(
          {index(ring, sector + 1), index(ring + 1, sector), index(ring + 1, sector + 1)});
    }
  }
  return mesh;
}

Shape box(const char* name, const Eigen::Vector3d& centre_m, const Eigen::Vector3d& size_m, Colour colour) {
  Shape shape{name, Eigen::Isometry3d::Identity(), Box{size_m}, colour};
  shape.X_LG.translation() = centre_m;
  return shape;
}

Link link(const char* name, int parent, double mass_kg, const Shape& visual) {
  Link result;
  result.name = name;
  result.parent = parent;
  result.mass_kg = mass_kg;
  result.visuals.push_back(visual);
  Shape collision = visual;
  if (std::holds_alternative<Mesh>(visual.geometry)) collision.geometry = Box{{0.07, 0.07, 0.07}};
  result.collisions.push_back(collision);
  return result;
}

Scene scene() {
  constexpr Colour kBlue{0.25F, 0.42F, 0.65F};
  constexpr Colour kGrey{0.75F, 0.77F, 0.8F};
  Scene scene;
  scene.robot = "sample";
  scene.links.push_back(link("trunk", -1, 0.7, box("trunk", {0, 0, 0.07}, {0.07, 0.1, 0.14}, kBlue)));
  Shape head{"head", Eigen::Isometry3d::Identity(), sphere(0.035), kGrey};
  head.X_LG.translation().z() = 0.185;
  scene.links.push_back(link("head", 0, 0.1, head));
  for (const char* name : {"left_leg", "right_leg"})
    scene.links.push_back(link(name, 0, 0.2, box(name, {0, 0, 0.1}, {0.045, 0.04, 0.18}, kGrey)));
  for (std::size_t side = 0; side < 2; ++side) {
    scene.links[2 + side].visuals.push_back(box("sole", {0.01, 0, 0.005}, {0.1, 0.06, 0.01}, kBlue));
    scene.soles_L[side] = {{-0.04, -0.03, 0}, {0.06, -0.03, 0}, {0.06, 0.03, 0}, {-0.04, 0.03, 0}};
    scene.sole_links[side] = static_cast<int>(2 + side);
  }
  scene.planes.emplace_back();
  scene.ground.push_back(box("kerb", {0.5, 0.3, 0.01}, {0.2, 0.1, 0.02}, {0.6F, 0.55F, 0.5F}));
  return scene;
}

std::vector<Signal> signals(int additional) {
  std::vector<Signal> list;
  Signal state{"state_name", "", {}};
  for (const canopen::ValueName& value : kStates) state.names.emplace_back(value.value, value.name);
  list.push_back(state);
  for (const char* name : {"true_com_x", "true_com_y", "true_com_z", "planned_zmp_x", "planned_zmp_y",
                           "zmp_x", "zmp_y", "true_zmp_x", "true_zmp_y"}) {
    list.push_back({name, "m", {}});
  }
  for (const char* name : {"true_pitch", "imu_pitch"}) list.push_back({name, "rad", {}});
  for (const char* name : {"true_left_load", "true_right_load"}) list.push_back({name, "N", {}});
  for (int i = 0; i < additional; ++i) list.push_back({"joint_" + std::to_string(i) + "_encoder", "rad", {}});
  return list;
}

// The walk at an instant.
class Gait {
 public:
  explicit Gait(double t_s)
      : t_s_(t_s), step_(static_cast<int>(t_s / kStep_s)), phase_(t_s / kStep_s - step_) {}

  std::size_t support() const { return step_ % 2 == 0 ? 0 : 1; }
  double trunk_x_m() const { return kSpeed_m_per_s * t_s_; }
  double sway_m() const { return 0.02 * std::sin(std::numbers::pi * t_s_ / kStep_s); }
  // Position of a sole's link, on the ground below the leg.
  Eigen::Vector3d foot_m(std::size_t side) const {
    const double length = kSpeed_m_per_s * kStep_s;
    const double y = side == 0 ? kHip_m : -kHip_m;
    if (side == support()) return {length * (step_ + 0.5), y, 0.0};
    const double eased = 0.5 - 0.5 * std::cos(std::numbers::pi * phase_);
    return {length * (step_ - 0.5 + 2.0 * eased), y, 0.03 * std::sin(std::numbers::pi * phase_)};
  }

 private:
  double t_s_;
  int step_;
  double phase_;
};

Pose pose(const Eigen::Vector3d& p_m, double pitch_rad) {
  return {p_m.cast<float>(),
          Eigen::Quaterniond(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY())).cast<float>()};
}

Sample sample(const Recording& recording, std::uint64_t time_us, bool stumbles, Noise& noise) {
  const double t_s = 1e-6 * static_cast<double>(time_us);
  const Gait gait(t_s);
  const double pitch_rad = 0.05 * std::sin(2.0 * t_s) + (stumbles ? 0.15 : 0.0);
  const Eigen::Vector3d trunk_m(gait.trunk_x_m(), gait.sway_m(), 0.17);
  Sample sample;
  sample.time_us = time_us;
  sample.links = {pose(trunk_m, pitch_rad), pose(trunk_m, pitch_rad), pose(gait.foot_m(0), 0.0),
                  pose(gait.foot_m(1), 0.0)};
  const std::size_t support = gait.support();
  for (const Eigen::Vector3d& corner : recording.scene.soles_L[support]) {
    sample.contacts.push_back({recording.scene.sole_links[support], -1,
                               (gait.foot_m(support) + corner).cast<float>(),
                               Eigen::Vector3f(0.2F, 0.0F, static_cast<float>(kWeight_N / 4.0))});
  }
  const Eigen::Vector3d zmp_m = gait.foot_m(support);
  const double state = t_s < 0.5 ? 0.0 : t_s < 1.0 ? 4.0 : 8.0;
  const double measured_m = t_s < 0.2 ? std::numeric_limits<double>::quiet_NaN() : zmp_m.x() + 0.004;
  for (const double value :
       {state, trunk_m.x(), trunk_m.y(), trunk_m.z() + 0.06, zmp_m.x(), 0.8 * zmp_m.y(), measured_m,
        0.7 * zmp_m.y(), zmp_m.x() + 0.008, 0.75 * zmp_m.y(), pitch_rad, pitch_rad + 0.003 * noise.next(),
        support == 0 ? kWeight_N : 0.0, support == 1 ? kWeight_N : 0.0}) {
    sample.values.push_back(static_cast<float>(value));
  }
  while (sample.values.size() < recording.signals.size()) {
    // 12 bits per turn, as an encoder.
    const double angle =
        0.5 * std::sin(t_s + static_cast<double>(sample.values.size())) + 0.002 * noise.next();
    sample.values.push_back(static_cast<float>(std::round(angle * 652.0) / 652.0));
  }
  return sample;
}

hal::CanFrame frame(std::uint16_t identifier, std::initializer_list<int> data) {
  hal::CanFrame frame{.identifier = identifier, .size = static_cast<std::uint8_t>(data.size())};
  std::size_t i = 0;
  for (const int byte : data) frame.data[i++] = static_cast<std::uint8_t>(byte);
  return frame;
}

void add_frames(Recording& recording, std::uint64_t tick_us, int drives, Noise& noise) {
  std::uint64_t end_us = tick_us - kTick_us;
  const auto add = [&](const hal::CanFrame& frame) { recording.frames.push_back({end_us += 110, frame}); };
  if (tick_us == kTick_us) {
    add(frame(0x000, {0x01, 0x00}));
    add(frame(0x610, {0x23, 0x16, 0x10, 0x01, 0xF4, 0x01, 0x01, 0x00}));
    add(frame(0x590, {0x60, 0x16, 0x10, 0x01, 0x00, 0x00, 0x00, 0x00}));
  }
  add(frame(0x080, {}));
  for (int drive = 0; drive < drives; ++drive) {
    const double t_s = 1e-6 * static_cast<double>(tick_us);
    const int position = static_cast<int>(2000.0 * std::sin(t_s + drive) + 2.0 * noise.next());
    const int torque = static_cast<int>(100.0 * noise.next());
    add(frame(static_cast<std::uint16_t>(0x180 + kFirstDrive + drive),
              {position & 0xFF, position >> 8 & 0xFF, position >> 16 & 0xFF, position >> 24 & 0xFF,
               torque & 0xFF, torque >> 8 & 0xFF, 8}));
  }
  if (tick_us % 500'000 == 0) add(frame(0x710, {0x05}));
  if (tick_us == 1'500'000) add(frame(0x090, {0x10, 0x81, 0x11, 0, 0, 0, 0, 0}));
}

}  // namespace

Recording walking_recording(const WalkingRecordingOptions& options) {
  Recording recording;
  recording.title = "sample </script><b>walk</b> & \"quotes\"";
  recording.scenario = "version: 1\n# </script><script>throw new Error('injected')</script>\n";
  recording.seed = std::numeric_limits<std::uint64_t>::max();
  recording.stepper = "world";
  recording.version = "0.1.0";
  recording.scene = scene();
  recording.signals = signals(options.signals);
  Noise noise;
  Noise bus_noise;
  const auto end_us = static_cast<std::uint64_t>(std::llround(1e6 * options.duration_s));
  for (std::uint64_t time_us = kTick_us; time_us <= end_us; time_us += kTick_us) {
    const bool stumbles =
        options.stumbles_at_s >= 0.0 && static_cast<double>(time_us) >= 1e6 * options.stumbles_at_s;
    recording.samples.push_back(sample(recording, time_us, stumbles, noise));
    add_frames(recording, time_us, options.drives, bus_noise);
  }
  recording.events = {{10'000, "command", "Command enable: obeyed."},
                      {500'000, "state", "Stands."},
                      {1'000'000, "command", "Command walk 0.10 m/s forward: </script> & obeyed."},
                      {1'500'000, "emergency", "EMCY of the left drive: heartbeat lost."},
                      {2'000'000, "push", "A push of 0.5 N s to the left."},
                      {end_us, "end", "walks; did not fall; 0 faults"}};
  recording.pushes = {{2'000'000, 2'100'000, 0, {0.0, 0.0, 0.07}, {0.0, 5.0, 0.0}}};
  return recording;
}

const bus::Network& walking_network() {
  static const bus::Network network = [] {
    bus::Network made{.nodes = {{1, "controller"}}, .messages = {}};
    for (int drive = 0; drive < 40; ++drive) {
      const std::string name = drive == 0   ? "left_drive"
                               : drive == 1 ? "right_drive"
                                            : "drive_" + std::to_string(drive);
      made.nodes.push_back({static_cast<std::uint8_t>(kFirstDrive + drive), name});
      bus::Message message;
      message.identifier = static_cast<std::uint16_t>(0x180 + kFirstDrive + drive);
      message.name = name + "_tpdo1";
      message.size_bytes = 7;
      message.sender = name;
      message.signals.push_back({.name = "position",
                                 .start_bit = 0,
                                 .size_bits = 32,
                                 .is_signed = true,
                                 .factor = 0.001,
                                 .unit = "rad"});
      message.signals.push_back({.name = "torque",
                                 .start_bit = 32,
                                 .size_bits = 16,
                                 .is_signed = true,
                                 .factor = 1.0,
                                 .unit = "permille"});
      message.signals.push_back({.name = "mode", .start_bit = 48, .size_bits = 8, .values = kModes});
      made.messages.push_back(message);
    }
    return made;
  }();
  return network;
}

}  // namespace koboshi::view
