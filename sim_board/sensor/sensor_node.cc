#include "sim_board/sensor/sensor_node.h"

#include <algorithm>

namespace koboshi::sim_board {

SensorNode::SensorNode(SensorKind kind, std::uint8_t node_id, Bus& bus)
    : bus_(bus),
      handle_(bus.attach(*this, AcceptanceFilter(), kTransmitFifo)),
      description_(sensor_node_description(kind)),
      values_{.kind = kind},
      services_({description_.vendor_id, description_.product_code, description_.revision_number, node_id},
                *this),
      node_(description_,
            {.node_id = node_id,
             .serial_number = node_id,
             .values = std::as_writable_bytes(std::span(&values_, 1)),
             .services = &services_},
            memory_.buffers(), *this, *this) {}

void SensorNode::store(const Axes& first, std::int16_t (&first_values)[3], const Axes& second,
                       std::int16_t (&second_values)[3]) {
  std::ranges::copy(first, first_values);
  std::ranges::copy(second, second_values);
  ++values_.sample;
}

void SensorNode::take(const hal::AnkleSample& sample) {
  store(sample.force_raw, values_.force, sample.torque_raw, values_.torque);
  std::ranges::copy(sample.force_raw, values_.cells);
  values_.cells[3] = sample.torque_raw[0];
  values_.contact = static_cast<std::uint8_t>(sample.force_raw[2] & 1);
}

void SensorNode::update(std::uint64_t now_us) {
  now_us_ = now_us;
  if (!started_ && now_us >= kBootTime_us) {
    started_ = true;
    services_.start(node_.node_id());
    node_.start(now_us);
    filter_.set(bus_, handle_, node_, services_);
  }
  if (!started_) return;
  const hal::CanStatus status = bus_.status(handle_);
  node_.on_can_status(status, now_us);
  bus_off_.step(bus_, handle_, status, now_us);
  storage_.process();
  services_.process(node_);
  node_.process(now_us);
  if (const auto time = services_.time_of_day(now_us)) {
    values_.time_ms = time->ms;
    values_.time_days = time->days;
  }
}

void SensorNode::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  if (!started_) return;
  now_us_ = time_us;
  if (!services_.on_frame(node_, frame, time_us)) node_.on_frame(frame, time_us);
  filter_.update(bus_, handle_, node_, services_);
}

void SensorNode::archive(StateArchive& archive) {
  archive(values_, storage_, bus_off_, started_, now_us_);
  archive.in_place(memory_, services_, node_);
  if (!archive.writes()) filter_.set(bus_, handle_, node_, services_);
}

}  // namespace koboshi::sim_board
