#include "simulation/observe/trace_table.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>

#include "firmware/app/controller_objects.h"

namespace koboshi::simulation {
namespace {

using Sample = const TraceSample&;
using Row = std::vector<TraceValue>;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

class Fields {
 public:
  // An integer, or its name from a table of names.
  template <typename Getter>
  void add_integer(const char* name, Getter get, std::span<const canopen::ValueName> names = {}) {
    fields_.push_back({{{name, "", TraceKind::kInteger, names}}, [get](Sample sample, Row& row) {
                         row.emplace_back(static_cast<std::int64_t>(get(sample)));
                       }});
  }

  // Numbers of one unit; `get` returns at least as many of them as there are names.
  template <typename Getter>
  void add(std::initializer_list<std::string> names, const char* unit, Getter get) {
    std::vector<TraceColumn> columns;
    for (const std::string& name : names) columns.push_back({name, unit});
    fields_.push_back({std::move(columns), [get, count = names.size()](Sample sample, Row& row) {
                         const auto values = get(sample);
                         assert(static_cast<std::size_t>(values.size()) >= count);
                         for (std::size_t i = 0; i < count; ++i)
                           row.emplace_back(*(values.begin() + static_cast<std::ptrdiff_t>(i)));
                       }});
  }

  std::vector<TraceFields> take() { return std::move(fields_); }

 private:
  std::vector<TraceFields> fields_;
};

std::array<double, 3> sole_pose(Sample sample, std::size_t side) {
  const Eigen::Isometry3d& X_WSole = sample.truth.X_WSole[side];
  return {X_WSole.translation().x(), X_WSole.translation().y(),
          std::atan2(X_WSole.linear()(1, 0), X_WSole.linear()(0, 0))};
}

std::array<double, 2> told_zmp_m(Sample sample, std::size_t side) {
  const Telemetry::FootZmp& zmp = sample.told.foot_zmp[side];
  return {zmp.valid ? zmp.x_m : kNotANumber, zmp.valid ? zmp.y_m : kNotANumber};
}

Eigen::Vector2d true_zmp_m(Sample sample, std::size_t side) {
  return sample.truth.foot_zmp_S_m[side].value_or(Eigen::Vector2d::Constant(kNotANumber));
}

void add_controller(Fields& fields) {
  fields.add_integer("state", [](Sample s) { return s.told.state; });
  fields.add_integer("reason", [](Sample s) { return s.told.reason; });
  fields.add_integer(
      "state_name", [](Sample s) { return s.told.state; }, app::kStateNames);
  fields.add_integer(
      "reason_name", [](Sample s) { return s.told.reason; }, app::kReasonNames);
  fields.add_integer("drive_fault", [](Sample s) { return s.told.drive_fault; });
  fields.add_integer("emergencies", [](Sample s) { return s.told.emergencies; });
  fields.add_integer("drive_enable", [](Sample s) { return s.board.electronics().drive_enable_line(); });
  fields.add({"imu_roll", "imu_pitch"}, "rad", [](Sample s) {
    return std::array{s.told.roll_rad, s.told.pitch_rad};
  });
  fields.add({"gyro_x", "gyro_y", "gyro_z"}, "rad_per_s", [](Sample s) { return s.told.rate_rad_per_s; });
  fields.add({"left_load", "right_load"}, "N", [](Sample s) { return s.told.foot_load_N; });
}

void add_world(Fields& fields) {
  fields.add({"true_base_x", "true_base_y", "true_base_z"}, "m", [](Sample s) { return s.truth.p_WB_W; });
  fields.add({"pose_base_z"}, "m", [](Sample s) { return std::array{s.truth.pose_height_m}; });
  fields.add({"true_roll", "true_pitch", "true_yaw"}, "rad", [](Sample s) { return s.truth.rpy_rad; });
  fields.add({"true_rate_x", "true_rate_y", "true_rate_z"}, "rad_per_s",
             [](Sample s) { return s.truth.w_WB_W; });
  fields.add({"true_com_x", "true_com_y", "true_com_z"}, "m", [](Sample s) { return s.truth.p_WCom_W; });
  fields.add({"true_left_load", "true_right_load"}, "N", [](Sample s) { return s.truth.foot_load_N; });
  fields.add({"true_left_slip", "true_right_slip"}, "m", [](Sample s) { return s.truth.foot_slip_m; });
}

void add_feet(Fields& fields) {
  for (const auto& [side, index] : {std::pair<std::string, std::size_t>{"left", 0}, {"right", 1}}) {
    const std::string sole = "true_" + side + "_sole_";
    fields.add({sole + "x", sole + "y"}, "m", [index = index](Sample s) { return sole_pose(s, index); });
    fields.add({sole + "yaw"}, "rad",
               [index = index](Sample s) { return std::array{sole_pose(s, index)[2]}; });
  }
  for (const auto& [side, index] : {std::pair<std::string, std::size_t>{"left", 0}, {"right", 1}}) {
    fields.add({side + "_zmp_x", side + "_zmp_y"}, "m",
               [index = index](Sample s) { return told_zmp_m(s, index); });
    fields.add({"true_" + side + "_zmp_x", "true_" + side + "_zmp_y"}, "m",
               [index = index](Sample s) { return true_zmp_m(s, index); });
  }
}

void add_balance(Fields& fields) {
  fields.add({"zmp_x", "zmp_y"}, "m", [](Sample s) { return s.zmp_W; });
  fields.add({"true_zmp_x", "true_zmp_y"}, "m",
             [](Sample s) { return s.truth.p_WZmp_W.value_or(Eigen::Vector3d::Constant(kNotANumber)); });
  fields.add({"true_zmp_margin"}, "m",
             [](Sample s) { return std::array{s.truth.zmp_margin_m.value_or(kNotANumber)}; });
  fields.add({"planned_zmp_x", "planned_zmp_y"}, "m", [](Sample s) { return s.planned_zmp_W; });
  fields.add({"com_x", "com_y", "com_z"}, "m", [](Sample s) { return s.com_W; });
}

void add_joint(Fields& fields, const std::string& name, std::size_t joint) {
  fields.add({name + "_target", name + "_encoder", name + "_true"}, "rad", [joint](Sample s) {
    const Telemetry::Joint& drive = s.told.joints[joint];
    return std::array{drive.target_rad, drive.position_rad,
                      s.board.world().joint(static_cast<int>(joint)).position_rad};
  });
  fields.add({name + "_torque"}, "permille",
             [joint](Sample s) { return std::array{s.told.joints[joint].torque_permille}; });
}

}  // namespace

std::vector<TraceFields> trace_fields(const sim_board::RobotDescription& robot) {
  Fields fields;
  add_controller(fields);
  add_world(fields);
  add_feet(fields);
  add_balance(fields);
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint)
    add_joint(fields, robot.joints[joint].name, joint);
  return fields.take();
}

}  // namespace koboshi::simulation
