#include "simulation/python/recording.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "simulation/observe/run_recorder.h"

namespace py = pybind11;

namespace koboshi::simulation {
namespace {

// A field of the structured array, and the columns that it is filled from.
struct RecordedField {
  std::string name;
  const TraceColumn* column;         // the first of them; null: the time
  std::vector<py::ssize_t> columns;  // of the rows; several: one for each joint
  bool by_joint = false;
};

// The columns of the joints come last, with the joint's name before that of the field.
std::vector<RecordedField> fields_of(const std::vector<TraceColumn>& columns,
                                     const std::vector<std::string>& joints) {
  std::vector<RecordedField> fields{{"time_s", nullptr, {0}}};
  const auto joint_of = [&](const std::string& title) {
    return std::ranges::find_if(joints, [&](const std::string& joint) {
      return title == joint + "_target_rad" || title == joint + "_encoder_rad" ||
             title == joint + "_true_rad" || title == joint + "_torque_permille";
    });
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string title = columns[i].title();
    const auto place = static_cast<py::ssize_t>(i + 1);
    const auto joint = joint_of(title);
    if (joint == joints.end()) {
      fields.push_back({title, &columns[i], {place}});
      continue;
    }
    const std::string name = "joint" + title.substr(joint->size());
    const auto known = std::ranges::find(fields, name, &RecordedField::name);
    if (known == fields.end()) {
      fields.push_back({name, &columns[i], {place}, true});
    } else {
      known->columns.push_back(place);
    }
  }
  return fields;
}

// The names of a column's values, indexed by value.
std::vector<std::string> names_by_value(const TraceColumn& column) {
  std::vector<std::string> names;
  for (const canopen::ValueName& known : column.names) {
    const auto value = static_cast<std::size_t>(known.value);
    if (names.size() <= value) names.resize(value + 1);
    names[value] = known.name;
  }
  return names;
}

py::tuple dtype_of(const RecordedField& field) {
  if (field.by_joint) return py::make_tuple(field.name, "f8", py::make_tuple(field.columns.size()));
  if (field.column == nullptr || field.column->kind == TraceKind::kReal)
    return py::make_tuple(field.name, "f8");
  if (field.column->names.empty()) return py::make_tuple(field.name, "i8");
  std::size_t longest = 1;
  for (const canopen::ValueName& known : field.column->names) longest = std::max(longest, known.name.size());
  return py::make_tuple(field.name, "U" + std::to_string(longest));
}

}  // namespace

py::object recording(const std::vector<std::vector<double>>& rows, const sim_board::RobotDescription& robot,
                     bool by_world) {
  const std::vector<TraceColumn> columns = RunRecorder::columns(robot);
  const std::vector<RecordedField> fields = fields_of(columns, robot.joint_names());
  const std::size_t width = columns.size() + 1;
  const std::size_t count = rows.front().size() / width;
  py::array_t<double> numbers(std::vector<py::ssize_t>{static_cast<py::ssize_t>(rows.size()),
                                                       static_cast<py::ssize_t>(count),
                                                       static_cast<py::ssize_t>(width)});
  double* to = numbers.mutable_data();
  for (const std::vector<double>& one : rows) {
    if (one.size() != count * width)
      throw std::invalid_argument(
          "found simulations at different times of the control cycle, expected the same");
    to = std::ranges::copy(one, to).out;
  }

  const py::module_ numpy = py::module_::import("numpy");
  py::list types;
  for (const RecordedField& field : fields) types.append(dtype_of(field));
  const py::object array =
      numpy.attr("empty")(py::make_tuple(rows.size(), count), numpy.attr("dtype")(types));
  const py::ellipsis all;
  for (const RecordedField& field : fields) {
    py::object values = field.by_joint ? py::object(numbers[py::make_tuple(all, py::cast(field.columns))])
                                       : py::object(numbers[py::make_tuple(all, field.columns.front())]);
    if (field.column != nullptr && !field.column->names.empty())
      values = numpy.attr("array")(names_by_value(*field.column))[values.attr("astype")("i8")];
    array[py::str(field.name)] = values;
  }
  return by_world ? array : py::object(array[py::int_(0)]);
}

}  // namespace koboshi::simulation
