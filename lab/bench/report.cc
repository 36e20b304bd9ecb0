#include "lab/bench/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "base/table/table.h"

namespace koboshi::lab {
namespace {

using Json = nlohmann::ordered_json;

Json shares_json(const sim_board::TimeShares& shares) {
  const double parts =
      shares.physics_s + shares.bus_s + shares.drives_s + shares.firmware_s + shares.sensors_s;
  return {{"physics", shares.physics_s},   {"bus", shares.bus_s},         {"drives", shares.drives_s},
          {"firmware", shares.firmware_s}, {"sensors", shares.sensors_s}, {"rest", 1.0 - parts}};
}

// Null without the second engine.
const BenchResult* find(const std::vector<BenchResult>& results, const std::string& name) {
  const auto found =
      std::ranges::find_if(results, [&](const BenchResult& r) { return r.stepper.name == name; });
  return found == results.end() ? nullptr : &*found;
}

Json result_json(const BenchResult& result, const BenchResult* mujoco) {
  Json json{{"closed_loop_real_time_factor", result.walk.real_time_factor},
            {"closed_loop_real_time_factor_squat", result.squat.real_time_factor},
            {"physics_steps_per_s", result.walk.physics_steps_per_s},
            {"physics_steps_per_s_standing", result.stand.physics_steps_per_s},
            {"physics_steps_per_s_lying", result.lie.physics_steps_per_s},
            {"physics_speed_vs_mujoco", nullptr},
            {"physics_speed_vs_mujoco_standing", nullptr},
            {"physics_speed_vs_mujoco_lying", nullptr},
            {"squat_base_height_rms_m", result.squat_base_height_rms_m},
            {"squat_foot_slip_m", result.squat_foot_slip_m},
            {"walk_fell", result.walk.fell},
            {"squat_fell", result.squat.fell},
            {"accurate", result.accurate()},
            {"memory_bytes_per_world", result.memory_bytes},
            {"two_worlds_speedup", result.two_worlds_speedup},
            {"shares", shares_json(result.walk.shares)}};
  if (mujoco != nullptr) {
    json["physics_speed_vs_mujoco"] = result.walk.physics_steps_per_s / mujoco->walk.physics_steps_per_s;
    json["physics_speed_vs_mujoco_standing"] =
        result.stand.physics_steps_per_s / mujoco->stand.physics_steps_per_s;
    json["physics_speed_vs_mujoco_lying"] = result.lie.physics_steps_per_s / mujoco->lie.physics_steps_per_s;
  }
  return json;
}

}  // namespace

std::string bench_table(const std::vector<BenchResult>& results) {
  std::vector<Row> rows;
  for (const BenchResult& result : results) {
    const int falls = (result.walk.fell ? 1 : 0) + (result.squat.fell ? 1 : 0);
    rows.push_back({result.stepper.name, fmt::format("{:.2f}", result.walk.real_time_factor),
                    fmt::format("{:.2f}", result.squat.real_time_factor),
                    fmt::format("{:.0f}", result.walk.physics_steps_per_s),
                    fmt::format("{:.0f}", result.stand.physics_steps_per_s),
                    fmt::format("{:.0f}", result.lie.physics_steps_per_s),
                    fmt::format("{:.0f}", 100.0 * result.walk.shares.physics_s),
                    fmt::format("{:.4f}", 1e3 * result.squat_base_height_rms_m),
                    fmt::format("{:.4f}", 1e3 * result.squat_foot_slip_m), std::to_string(falls),
                    fmt::format("{:.1f}", 1e-6 * result.memory_bytes),
                    fmt::format("{:.2f}", result.two_worlds_speedup), result.accurate() ? "yes" : "no"});
  }
  return table_text(
      {"stepper", "walk [x real]", "squat [x real]", "steps/s", "standing", "lying", "physics [%]",
       "height RMS [mm]", "slip [mm]", "falls", "memory [MB]", "2 cores [x]", "accurate"},
      rows, TableStyle::kTerminal);
}

nlohmann::ordered_json bench_json(const std::vector<BenchResult>& results) {
  const BenchResult* mujoco = find(results, "mujoco");
  Json json = Json::object();
  if (const BenchResult* best = fastest_accurate(results)) {
    json = result_json(*best, mujoco);
    json["stepper"] = best->stepper.name;
  } else {
    json["stepper"] = nullptr;
  }
  json["steppers"] = Json::object();
  for (const BenchResult& result : results)
    json["steppers"][result.stepper.name] = result_json(result, mujoco);
  return json;
}

}  // namespace koboshi::lab
