#include "tools/servo/servo_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/servo/dry_friction.h"
#include "tools/plot/figure.h"
#include "tools/plot/legend.h"
#include "tools/servo/rig.h"

namespace koboshi::tools {
namespace {

constexpr int kDigits = 6;  // of the numbers in the CSV files

class ServoFigures {
 public:
  ServoFigures(const std::string& name, const sim_board::ServoDescription& servo,
               const std::filesystem::path& folder)
      : name_(name), servo_(servo), friction_(servo), folder_(folder) {}

  void draw_all() {
    draw_torque_speed();
    draw_step();
    draw_sine();
    draw_friction_over_speed();
    draw_friction_over_load();
    draw_backlash();
  }

 private:
  // Stall torque without friction, at the largest duty and within the current limit.
  double stall_Nm() const {
    const double current_A = servo_.max_duty * servo_.supply_V / servo_.resistance_ohm;
    return servo_.torque_constant_Nm_per_A * std::min(current_A, servo_.current_limit_A);
  }
  double no_load_rad_per_s() const {
    return servo_.max_duty * servo_.supply_V / servo_.torque_constant_Nm_per_A;
  }
  // Inertia of the load, similar to the rotor's.
  double inertia_kg_m2() const { return std::max(servo_.rotor_inertia_kg_m2, 1e-4); }

  void finish(const std::string& what, const Columns& table, Figure figure) {
    figure.title = fmt::format("{} at {:.3g} V: {}", name_, servo_.supply_V, figure.title);
    draw_with_csv(figure, table, folder_ / what, kDigits);
  }

  void draw_torque_speed() {
    constexpr int kLoads = 40;
    constexpr int kSettle_ms = 800;
    constexpr int kHalvings = 8;
    Columns table = make_columns(
        {"load_Nm", "speed_rad_per_s", "ideal_rad_per_s", "current_A", "electrical_W", "mechanical_W"});
    // Adds the steady speed under a load. Returns false if the load stops the servo or drives it back.
    double last_Nm = 0.0;
    const auto add = [&](double load_Nm) {
      ServoRig rig(servo_, {.inertia_kg_m2 = inertia_kg_m2()});
      // Starts without load: the figure shows the load that a turning servo can carry.
      for (int ms = 0; ms < kSettle_ms; ++ms) rig.drive_fully(0.0);
      for (int ms = 0; ms < kSettle_ms && rig.speed_rad_per_s() > 0.0; ++ms) rig.drive_fully(-load_Nm);
      if (rig.speed_rad_per_s() <= 1e-6) return false;
      const double current_A = rig.servo().current_A();
      const double voltage_V = rig.servo().winding().resistance_ohm() * current_A +
                               servo_.torque_constant_Nm_per_A * rig.speed_rad_per_s();
      add_row(table,
              {load_Nm, rig.speed_rad_per_s(), no_load_rad_per_s() * (1.0 - load_Nm / ideal_stall_Nm()),
               current_A, voltage_V * current_A, load_Nm * rig.speed_rad_per_s()});
      last_Nm = load_Nm;
      return true;
    };
    double stopped_Nm = stall_Nm();
    for (int i = 0; i <= kLoads; ++i) {
      const double load_Nm = stall_Nm() * i / kLoads;
      if (add(load_Nm)) continue;
      stopped_Nm = load_Nm;
      break;
    }
    // The stall point lies between the last two loads.
    for (int i = 0; i < kHalvings && stopped_Nm > last_Nm; ++i) {
      const double middle_Nm = 0.5 * (last_Nm + stopped_Nm);
      if (!add(middle_Nm)) stopped_Nm = middle_Nm;
    }
    finish(
        "torque_speed", table,
        {.title = "speed over load, at the full duty",
         .panels = {{.y_label = "speed [rad/s]",
                     .series = {series(Role::kTheory, "ideal_rad_per_s", "motor without friction or limits"),
                                series(Role::kTrue, "speed_rad_per_s", "simulated")}},
                    {.y_label = "current [A]", .series = {series(Role::kTrue, "current_A", "")}},
                    {.y_label = "power [W]",
                     .series = {series(Role::kFirst, "electrical_W", "taken"),
                                series(Role::kSecond, "mechanical_W", "given to the load")}}},
         .marks = {{last_Nm, fmt::format("stall, simulated: {:.3g} N m", last_Nm)},
                   {ideal_stall_Nm(),
                    fmt::format("stall of the motor: {:.3g} N m, {:.3g} A", ideal_stall_Nm(),
                                servo_.max_duty * servo_.supply_V / servo_.resistance_ohm)}},
         .x_column = "load_Nm",
         .x_label = "load [N m]",
         .x_span = Span{0.0, 1.03 * std::max(last_Nm, ideal_stall_Nm())}});
  }
  double ideal_stall_Nm() const {
    return servo_.torque_constant_Nm_per_A * servo_.max_duty * servo_.supply_V / servo_.resistance_ohm;
  }

  // Draws the response to a target.
  void draw_motion(const std::string& what, const std::string& title, const RigLoad& load, int duration_ms,
                   const std::function<double(double)>& target_rad) {
    Columns table = make_columns({"time_s", "target_rad", "position_rad", "error_rad", "speed_rad_per_s",
                                  "motor_Nm", "output_Nm", "friction_Nm"});
    ServoRig rig(servo_, load);
    for (int ms = 0; ms < duration_ms; ++ms) {
      const double time_s = 0.001 * ms;
      const double target = target_rad(time_s);
      const double position_rad = rig.position_rad();
      const double speed_rad_per_s = rig.speed_rad_per_s();
      const double output_Nm = rig.output_Nm();
      rig.drive_to(target, 0.0);
      const double motor_Nm = rig.servo().torque_Nm();
      add_row(table, {time_s, target, position_rad, target - position_rad, speed_rad_per_s, motor_Nm,
                      output_Nm, friction_.bound_Nm(motor_Nm, -output_Nm, speed_rad_per_s)});
    }
    finish(
        what, table,
        {.title = title,
         .panels = {{.y_label = "angle [deg]",
                     .series = {series(Role::kPlanned, "target_rad", "target", kDegreesPerRad),
                                series(Role::kTrue, "position_rad", "shaft", kDegreesPerRad)}},
                    {.y_label = "error [deg]", .series = {{.column = "error_rad", .factor = kDegreesPerRad}}},
                    {.y_label = "speed [rad/s]", .series = {{.column = "speed_rad_per_s"}}},
                    {.y_label = "torque [N m]",
                     .series = {series(Role::kFirst, "motor_Nm", "motor"),
                                series(Role::kSecond, "output_Nm", "on the arm"),
                                series(Role::kTheory, "friction_Nm", "bound of dry friction")}}}});
  }

  void draw_step() {
    const RigLoad load{.inertia_kg_m2 = inertia_kg_m2()};
    draw_motion("step",
                fmt::format("a step of its target, with {:.2g} kg m^2 on the shaft", load.inertia_kg_m2),
                load, 1000, [](double time_s) { return time_s < 0.1 || time_s >= 0.6 ? 0.0 : 0.5; });
  }

  void draw_sine() {
    const RigLoad load{.inertia_kg_m2 = inertia_kg_m2(), .weight_Nm = 0.2 * stall_Nm()};
    draw_motion("sine", fmt::format("a sine of its target, lifting and lowering {:.2g} N m", load.weight_Nm),
                load, 4000,
                [](double time_s) { return 0.5 * std::sin(2.0 * std::numbers::pi * 0.5 * time_s); });
  }

  void draw_friction_over_speed() {
    constexpr std::array kLoads{0.0, 0.25, 0.5, 0.75};  // of the stall torque
    constexpr int kSpeeds = 400;
    std::vector<std::string> columns{"speed_rad_per_s"};
    Panel panel{.y_label = "bound of dry friction [N m]", .smallest_span = 2.0 * servo_.coulomb_friction_Nm};
    for (const double load : kLoads) {
      columns.push_back(fmt::format("load_{:.0f}_percent_Nm", 100.0 * load));
      panel.series.push_back(
          {.column = columns.back(), .label = fmt::format("{:.2g} N m", load * stall_Nm())});
    }
    Columns table = make_columns(columns);
    for (int i = -kSpeeds; i <= kSpeeds; ++i) {
      const double speed_rad_per_s = no_load_rad_per_s() * i / kSpeeds;
      std::vector<double> row{speed_rad_per_s};
      for (const double load : kLoads) {
        row.push_back(friction_.bound_Nm(load * stall_Nm(), -load * stall_Nm(), speed_rad_per_s));
      }
      add_row(table, row);
    }
    finish("friction_speed", table,
           {.title = "dry friction over speed, where motor and load are in balance",
            .panels = {panel},
            .x_column = "speed_rad_per_s",
            .x_label = "speed [rad/s]"});
  }

  // Returns the limit of the loads that friction holds at rest: with `direction` 1 the largest that does not
  // drive the motor back, with -1 the largest that the motor cannot yet lift. NaN if friction grows as fast
  // as the load.
  double holding_limit_Nm(double motor_Nm, double direction) const {
    const auto holds = [&](double load_Nm) {
      return std::abs(load_Nm - motor_Nm) <= friction_.bound_Nm(motor_Nm, -load_Nm, 0.0);
    };
    double inside_Nm = motor_Nm;
    double outside_Nm = motor_Nm + direction * 10.0 * stall_Nm();
    if (holds(outside_Nm)) return std::nan("");
    for (int i = 0; i < 60; ++i) {
      const double middle_Nm = 0.5 * (inside_Nm + outside_Nm);
      (holds(middle_Nm) ? inside_Nm : outside_Nm) = middle_Nm;
    }
    return inside_Nm;
  }

  void draw_friction_over_load() {
    constexpr int kTorques = 200;
    Columns table =
        make_columns({"motor_Nm", "at_rest_Nm", "moving_Nm", "balance_Nm", "lifts_Nm", "driven_back_Nm"});
    for (int i = 0; i <= kTorques; ++i) {
      const double motor_Nm = stall_Nm() * i / kTorques;
      add_row(table, {motor_Nm, friction_.bound_Nm(motor_Nm, -motor_Nm, 0.0),
                      friction_.bound_Nm(motor_Nm, -motor_Nm, 0.5 * no_load_rad_per_s()), motor_Nm,
                      holding_limit_Nm(motor_Nm, -1.0), holding_limit_Nm(motor_Nm, 1.0)});
    }
    finish("friction_load", table,
           {.title = "dry friction over load",
            .panels = {{.y_label = "bound in balance [N m]",
                        .series = {{.column = "at_rest_Nm", .label = "at rest"},
                                   {.column = "moving_Nm", .label = "at half its no-load speed"}},
                        .smallest_span = 2.0 * servo_.coulomb_friction_Nm},
                       {.y_label = "load [N m]",
                        .series = {series(Role::kFirst, "driven_back_Nm", "just drives it back"),
                                   series(Role::kTheory, "balance_Nm", "balances the motor"),
                                   series(Role::kSecond, "lifts_Nm", "is just lifted")}}},
            .x_column = "motor_Nm",
            .x_label = "torque of the motor [N m]"});
  }

  void draw_backlash() {
    constexpr int kPeriod_ms = 4000;
    const double largest_Nm = 0.3 * stall_Nm();
    Columns table = make_columns({"outer_Nm", "position_rad", "rotor_rad"});
    ServoRig rig(servo_, {.inertia_kg_m2 = inertia_kg_m2()});
    // One period and a quarter: the first quarter leads into the loop.
    for (int ms = 0; ms <= kPeriod_ms + kPeriod_ms / 4; ++ms) {
      const double phase = 2.0 * std::numbers::pi * ms / kPeriod_ms;
      const double outer_Nm = largest_Nm * 2.0 / std::numbers::pi * std::asin(std::sin(phase));
      rig.drive_to(0.0, outer_Nm);
      add_row(table, {outer_Nm, rig.position_rad(), rig.position_rad() + rig.servo().backlash().lead_rad()});
    }
    finish("backlash", table,
           {.title = "holding its position under a torque from outside",
            .panels = {{.y_label = "angle [deg]",
                        .series = {series(Role::kTrue, "position_rad", "shaft", kDegreesPerRad),
                                   series(Role::kFirst, "rotor_rad", "rotor, geared", kDegreesPerRad)}}},
            .x_column = "outer_Nm",
            .x_label = "torque from outside [N m]"});
  }

  std::string name_;
  sim_board::ServoDescription servo_;
  sim_board::DryFriction friction_;
  std::filesystem::path folder_;
};

}  // namespace

void draw_servo(const std::string& name, const sim_board::ServoDescription& servo,
                const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  ServoFigures(name, servo, folder).draw_all();
}

}  // namespace koboshi::tools
