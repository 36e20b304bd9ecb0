#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "lab/validate/inertial_zmp.h"
#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "sim_board/sensor/ankle_zmp.h"
#include "sim_board/world/foot.h"
#include "sim_board/world/ground_truth.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/statistics.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

// The ZMP of the contact forces of the ground, on z = 0 up to the contacts' depth.
Vector2d by_contacts_m(const sim_board::World& world) {
  double load_N = 0.0;
  Vector2d moment = Vector2d::Zero();
  for (const sim_board::Contact& contact : world.contacts()) {
    if (contact.other_link != -1) continue;
    load_N += contact.f_W.z();
    moment += contact.f_W.z() * contact.p_W.head<2>();
  }
  return load_N > 0.0 ? Vector2d(moment / load_N) : Vector2d::Constant(kNotANumber);
}

// The ankle sensors' ZMP of both feet, weighted with their loads, in the world.
class SensorZmp {
 public:
  SensorZmp(const simulation::Simulation& simulation, double noise_scale)
      : simulation_(simulation), feet_(sim_board::feet_of(simulation.robot())) {
    const sim_board::SensorErrors errors{.seed = simulation.scenario().seed, .scale = noise_scale};
    const sim_board::RobotDescription& robot = simulation.robot();
    if (robot.left_ankle) sensors_[0].emplace(*robot.left_ankle, robot, kGravity_m_per_s2, errors);
    if (robot.right_ankle) sensors_[1].emplace(*robot.right_ankle, robot, kGravity_m_per_s2, errors);
  }

  Vector2d read_m() {
    double load_N = 0.0;
    Vector2d moment = Vector2d::Zero();
    for (std::size_t side = 0; side < sensors_.size(); ++side) {
      const sim_board::AnkleSensor* sensor =
          simulation_.board().electronics().ankle_sensor(static_cast<hal::Side>(side));
      if (!sensors_[side] || sensor == nullptr) continue;
      const sim_board::AnkleZmp::Reading reading = sensors_[side]->read(sensor->wrench_S());
      const Eigen::Isometry3d X_WSole =
          sim_board::pose_before_step(simulation_.robot(), simulation_.board().world(), feet_[side]->link) *
          feet_[side]->X_LSole;
      load_N += reading.load_N;
      moment +=
          reading.load_N * (X_WSole * Vector3d(reading.zmp_S_m.x(), reading.zmp_S_m.y(), 0.0)).head<2>();
    }
    return load_N > 0.0 ? Vector2d(moment / load_N) : Vector2d::Constant(kNotANumber);
  }

 private:
  const simulation::Simulation& simulation_;
  std::array<std::optional<sim_board::Foot>, 2> feet_;
  std::array<std::optional<sim_board::AnkleZmp>, 2> sensors_;
};

// Compares the three ZMPs after every step. Replaces the scenario's player, which has released the stand by
// then and applies no pushes.
class Comparison final : public sim_board::StepListener {
 public:
  explicit Comparison(const simulation::Simulation& simulation)
      : exact_(simulation, 0.0), noisy_(simulation, 1.0), inertial_(simulation.robot(), kGravity_m_per_s2) {}

  void before_step(sim_board::World& world, std::uint64_t start_us, std::uint64_t) override {
    const std::optional<Vector2d> inertial_m = inertial_.observe(world);
    if (!inertial_m) return;
    const Vector2d contacts_m = by_contacts_m(world), exact_m = exact_.read_m(), noisy_m = noisy_.read_m();
    inertial_rms_.add((*inertial_m - contacts_m).squaredNorm());
    exact_rms_.add((exact_m - contacts_m).squaredNorm());
    noisy_rms_.add((noisy_m - contacts_m).squaredNorm());
    if (start_us % 1000 != 0) return;
    const std::array values{1e-6 * static_cast<double>(start_us),
                            1e3 * contacts_m.x(),
                            1e3 * inertial_m->x(),
                            1e3 * noisy_m.x(),
                            1e6 * (*inertial_m - contacts_m).x(),
                            1e6 * (exact_m - contacts_m).x()};
    for (std::size_t i = 0; i < values.size(); ++i) columns_[i].second.push_back(values[i]);
  }

  double inertial_rms_m() const { return inertial_rms_.value(); }
  double exact_rms_m() const { return exact_rms_.value(); }
  double noisy_rms_m() const { return noisy_rms_.value(); }
  std::vector<std::pair<std::string, std::vector<double>>> columns() const {
    return {columns_.begin(), columns_.end()};
  }

 private:
  SensorZmp exact_;  // without noise and bias
  SensorZmp noisy_;
  InertialZmp inertial_;
  simulation::RootMeanSquare inertial_rms_, exact_rms_, noisy_rms_;
  std::array<std::pair<std::string, std::vector<double>>, 6> columns_{{{"time_s", {}},
                                                                       {"contacts_x_mm", {}},
                                                                       {"inertial_x_mm", {}},
                                                                       {"sensors_x_mm", {}},
                                                                       {"inertial_error_um", {}},
                                                                       {"resolution_error_um", {}}}};
};

// Error of one foot's torque about an axis in the sole, from errors of its force and its torque: tau + d f +
// p f, with p up to half the sole's length.
double moment_Nm(const sim_board::AnkleSensorDescription& ankle, double force_N, double torque_Nm) {
  constexpr double kHalfSole_m = 0.05;
  return std::hypot(torque_Nm, force_N * std::hypot(ankle.height_above_sole_m, kHalfSole_m));
}

// In the middle of the way down.
constexpr tools::Span kShown_s{3.9, 4.1};

Plot figure(const Comparison& comparison) {
  return {
      .name = "zmp",
      .caption =
          "Three ways to the same ZMP, on the way down; it jumps by up to 3 mm from one millisecond to the "
          "next. "
          "The sensors are off by their bias and noise; below, what remains without them: their resolution, "
          "and "
          "nearly nothing between contact forces and the motion of all links.",
      .columns = comparison.columns(),
      .figure = {
          .title = "ZMP of the robot in squats, forward",
          .panels = {{.y_label = "ZMP x [mm]",
                      .series = {tools::series(tools::Role::kMeasured, "sensors_x_mm", "ankle sensors"),
                                 tools::series(tools::Role::kTrue, "contacts_x_mm", "contact forces (true)"),
                                 tools::series(tools::Role::kTheory, "inertial_x_mm",
                                               "by the motion of all links")}},
                     {.y_label = "against contact forces [um]",
                      .series = {tools::series(tools::Role::kMeasured, "resolution_error_um",
                                               "sensors without noise and bias"),
                                 tools::series(tools::Role::kTheory, "inertial_error_um",
                                               "by the motion of all links")}}},
          .x_span = kShown_s}};
}

Findings run_zmp_comparison(const ValidationSetup& setup) {
  simulation::Scenario scenario = squat_scenario(setup);
  simulation::Simulation simulation(scenario);
  Comparison comparison(simulation);
  while (simulation.board().now_us() < kSquatBegins_us) simulation.advance();
  simulation.board().set_step_listener(&comparison);
  const std::uint64_t end_us = kSquatBegins_us + (setup.short_form ? 1'000'000 : 4'000'000);
  while (simulation.board().now_us() < end_us) simulation.advance();
  simulation.board().set_step_listener(nullptr);

  const sim_board::AnkleSensorDescription& ankle = simulation.robot().left_ankle.value();
  const double weight_N = simulation.robot().total_mass_kg() * kGravity_m_per_s2;
  // Both feet, both axes, independent: twice the root of one.
  const double resolution_m =
      2.0 * moment_Nm(ankle, ankle.force.resolution, ankle.torque.resolution) / std::sqrt(12.0) / weight_N;
  const double noise_N = ankle.force.noise_density * std::sqrt(500.0);  // white up to half the sampling rate
  const double noise_Nm = ankle.torque.noise_density * std::sqrt(500.0);
  const double errors_m =
      2.0 *
      std::hypot(moment_Nm(ankle, ankle.force.bias, ankle.torque.bias), moment_Nm(ankle, noise_N, noise_Nm)) /
      weight_N;
  // The depth of the contacts: the sole rests on four springs of this stiffness each. Friction forces act at
  // this depth, which shifts the ZMP.
  const sim_board::SurfaceDescription& sole =
      simulation.robot()
          .links[static_cast<std::size_t>(sim_board::feet_of(simulation.robot())[0]->link)]
          .collisions.front()
          .surface;
  const double stiffness_N_per_m =
      sole.error_reduction / (sole.reference_step_s * sole.constraint_force_mixing) / 2.0;
  const double depth_m = weight_N / (4.0 * stiffness_N_per_m);
  return {.checks = {{"motion of all links against contact forces, RMS", "m", 0.0,
                      comparison.inertial_rms_m(), sole.friction * depth_m},
                     {"sensors without noise and bias, RMS", "m", resolution_m, comparison.exact_rms_m(),
                      (std::sqrt(3.0) - 1.0) * resolution_m},
                     {"sensors with noise and bias, RMS", "m", 0.0, comparison.noisy_rms_m(), errors_m}},
          .plots = {figure(comparison)}};
}

}  // namespace

Validation zmp_comparison() {
  return {
      .name = "zmp",
      .title = "ZMP in three ways",
      .theory =
          "The whole robot in squats (`scenarios/squat.yaml`, firmware and all electronics). The ZMP is the "
          "mean of the contact points, weighted with their vertical forces; by the motion of all links, x = "
          "(sum m (x (z'' + g) - z x'') - sum dL_y/dt) / sum m (z'' + g) (Vukobratovic and Borovac, 2004); "
          "and by the two ankle sensors, the paper's equation 1. All three in every step.",
      .tolerances =
          "Motion of all links: friction times the depth of the contact points, which do not lie on z "
          "= 0. Sensors: a quantiser errs by its resolution over root 12, root 3 times that at most; "
          "then the largest bias, and white noise up to half the sampling rate.",
      .run = run_zmp_comparison};
}

}  // namespace koboshi::lab
