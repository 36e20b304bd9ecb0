#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "base/text/text.h"
#include "hal/port/ankle.h"
#include "sim_board/description/fault_list.h"
#include "sim_board/description/schema/schema_rules.h"

namespace koboshi::sim_board {
namespace {

// The jitter must be so small that samples keep their order.
void find_jitter_faults(const XmlNode& sensor, FaultList& faults) {
  const auto jitter = sensor.find("koboshi:jitter_s");
  if (!jitter) return;
  const double jitter_s = jitter->numbers().front();
  const double half_period_s = 0.5 / sensor.number("update_rate");
  if (jitter_s < half_period_s) return;
  faults.add(RobotFaultKind::kSensor, *jitter, "<koboshi:jitter_s> = " + number_text(jitter_s),
             "less than half the sampling period, " + number_text(half_period_s));
}

// The upper end may lack half a count; two's complement has one more value below zero.
void find_count_faults(const XmlNode& channel, FaultList& faults) {
  const double range = channel.number("range");
  const double resolution = channel.number("resolution");
  if (range / resolution <= 32768.5) return;
  faults.add(
      RobotFaultKind::kSensor, channel.child("resolution"),
      "<" + channel.name() + "> of range " + number_text(range) + " at resolution " + number_text(resolution),
      "counts that fit 16 bits");
}

// A sensor delivers the samples of its two channels together. Times have the resolution of the simulation.
void find_delay_faults(const XmlNode& sensor, const char* first, const char* second, FaultList& faults) {
  const auto one = sensor.find(first);
  const auto other = sensor.find(second);
  if (!one || !other) return;
  const double one_s = one->number("delay_s");
  const double other_s = other->number("delay_s");
  if (std::llround(1e6 * one_s) == std::llround(1e6 * other_s)) return;
  faults.add(RobotFaultKind::kSensor, other->child("delay_s"),
             "delay_s = " + number_text(other_s) + " in <" + other->name() + "> and " + number_text(one_s) +
                 " in <" + one->name() + ">",
             "one delay for both channels of a sensor");
}

// The keys that a type of an ankle sensor has, and how often.
struct TypeKeys {
  const std::string& type;
  std::map<std::string, std::size_t> counts;
};

const std::array<TypeKeys, 3>& ankle_types() {
  static const std::array<TypeKeys, 3> types{
      TypeKeys{kForceTorqueType, {{"force_torque", 1}, {"koboshi:force", 1}, {"koboshi:torque", 1}}},
      TypeKeys{kPressureCellsType, {{"koboshi:cell", hal::kPressureCells}, {"koboshi:cell_force", 1}}},
      TypeKeys{kContactSwitchType, {{"koboshi:closing_force_N", 1}}}};
  return types;
}

// The table of the keys has those of all types as optional ones.
void find_type_faults(const XmlNode& sensor, FaultList& faults) {
  const std::string type = sensor.attribute("type");
  for (const TypeKeys& keys : ankle_types()) {
    for (const auto& [key, count] : keys.counts) {
      const std::vector<XmlNode> found = sensor.children(key);
      const std::size_t expected = keys.type == type ? count : 0;
      if (found.size() == expected) continue;
      const XmlNode& place = found.empty() ? sensor : found.front();
      faults.add(RobotFaultKind::kSensor, place,
                 std::to_string(found.size()) + " times <" + key + "> in a sensor of type " + type,
                 expected == 0 ? "none" : std::to_string(expected));
    }
  }
}

}  // namespace

void find_ankle_faults(const XmlNode& sensor, FaultList& faults) {
  find_type_faults(sensor, faults);
  find_sensor_faults(sensor, faults);
}

void find_sensor_faults(const XmlNode& sensor, FaultList& faults) {
  find_jitter_faults(sensor, faults);
  find_delay_faults(sensor, "koboshi:gyro", "koboshi:accelerometer", faults);
  find_delay_faults(sensor, "koboshi:force", "koboshi:torque", faults);
  for (const char* name :
       {"koboshi:gyro", "koboshi:accelerometer", "koboshi:force", "koboshi:torque", "koboshi:cell_force"})
    if (const auto channel = sensor.find(name)) find_count_faults(*channel, faults);
}

void find_sensor_set_faults(const XmlNode& model, const ModelFrames& frames, FaultList& faults) {
  bool has_imu = false;
  std::map<std::string, bool> has_box;  // by link
  for (const XmlNode& link : model.children("link")) {
    has_box[link.attribute("name")] = link.find("collision").has_value();
    for (const XmlNode& sensor : link.children("sensor")) {
      if (has_imu) faults.add(RobotFaultKind::kSensor, sensor, "a second IMU", "one");
      has_imu = true;
    }
  }
  std::map<std::string, bool> has_ankle;  // by the sensor's name
  std::string type;                       // of the first one
  for (const XmlNode& joint : model.children("joint")) {
    for (const XmlNode& sensor : joint.children("sensor")) {
      const std::string name = sensor.attribute("name");
      if (has_ankle[name]) faults.add(RobotFaultKind::kSensor, sensor, "a second sensor " + name, "one");
      has_ankle[name] = true;
      if (type.empty()) type = sensor.attribute("type");
      if (type != sensor.attribute("type"))
        faults.add(RobotFaultKind::kSensor, sensor, "an ankle sensor of type " + sensor.attribute("type"),
                   type + ", as on the other side");
      const std::string foot = frames.link_of(joint.child("child").text());
      if (!has_box[foot])
        faults.add(RobotFaultKind::kSensor, sensor, "an ankle sensor above link " + foot + " without a box",
                   "a sole");
    }
  }
}

}  // namespace koboshi::sim_board
