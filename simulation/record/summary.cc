#include "simulation/record/summary.h"

#include "base/file/output_file.h"

namespace koboshi::simulation {

nlohmann::ordered_json to_json(const RunSummary& summary) {
  nlohmann::ordered_json document{{"fell", summary.fell},
                                  {"verdict", summary.verdict},
                                  {"falls", summary.falls},
                                  {"stands", summary.stands},
                                  {"duration_s", summary.duration_s},
                                  {"can_bus_load", summary.can_bus_load},
                                  {"state_hash", summary.state_hash},
                                  {"faults", summary.faults},
                                  {"solver_warnings", summary.solver_warnings},
                                  {"stepper", summary.stepper},
                                  {"base_height_error_max_m", summary.base_height_error_max_m},
                                  {"foot_slip_max_m", summary.foot_slip_max_m},
                                  {"lost_abilities", summary.lost_abilities}};
  if (summary.walk) {
    const WalkSummary& walk = *summary.walk;
    document.update({{"distance_m", walk.distance_m},
                     {"speed_m_per_s", walk.speed_m_per_s},
                     {"lateral_drift_m", walk.lateral_drift_m},
                     {"heading_drift_rad", walk.heading_drift_rad},
                     {"energy_J", walk.energy_J},
                     {"zmp_rms_error_m", walk.zmp_rms_error_m},
                     {"zmp_lag_s", walk.zmp_lag_s},
                     {"zmp_margin_p05_m", walk.zmp_margin_p05_m},
                     {"zmp_sensor_vs_truth_rms_m", walk.zmp_sensor_vs_truth_rms_m},
                     {"roll_rms_rad", walk.roll_rms_rad},
                     {"foot_lift_m", walk.foot_lift_m}});
  }
  nlohmann::ordered_json& events = document["events"] = nlohmann::ordered_json::array();
  for (const RunEvent& event : summary.events) {
    events.push_back({{"t_s", static_cast<double>(event.time_us) / 1e6},
                      {"kind", event.kind},
                      {"text", event.text},
                      {"fields", event.fields}});
  }
  return document;
}

void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& document) {
  write_whole_file(file,
                   document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
}

}  // namespace koboshi::simulation
