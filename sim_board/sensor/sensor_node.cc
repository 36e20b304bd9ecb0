#include "sim_board/sensor/sensor_node.h"

#include <algorithm>

namespace koboshi::sim {

SensorNode::SensorNode(SensorKind kind, std::uint8_t node_id, Bus& bus)
    : bus_(bus),
      handle_(bus.attach(*this, AcceptanceFilter::all(), kTransmitFifo)),
      description_(sensor_node_description(kind)),
      values_{.kind = kind},
      node_(description_,
            {.node_id = node_id,
             .serial_number = node_id,
             .values = std::as_writable_bytes(std::span(&values_, 1))},
            memory_.buffers(), *this, *this) {}

void SensorNode::store(const Axes& first, std::int16_t (&first_values)[3], const Axes& second,
                       std::int16_t (&second_values)[3]) {
  std::ranges::copy(first, first_values);
  std::ranges::copy(second, second_values);
  ++values_.sample;
}

void SensorNode::update(std::uint64_t now_us) {
  now_us_ = now_us;
  if (!started_ && now_us >= kBootTime_us) {
    started_ = true;
    node_.start(now_us);
  }
  if (!started_) return;
  const hal::CanStatus status = bus_.status(handle_);
  node_.on_can_status(status, now_us);
  bus_off_.step(bus_, handle_, status, now_us);
  node_.process(now_us);
}

void SensorNode::on_frame(const hal::CanFrame& frame, std::uint64_t time_us) {
  now_us_ = time_us;
  if (started_) node_.on_frame(frame, time_us);
}

}  // namespace koboshi::sim
