#include "studio/parameters/live_parameters.h"

#include <algorithm>
#include <utility>

#include "bus/can/sdo_transfer.h"
#include "sim_board/board/sim_board.h"

namespace koboshi::studio {
namespace {

// Attempts to write a value: a controller that boots does not answer yet.
constexpr int kMaxTries = 20;

std::vector<std::uint8_t> bytes_of(const ParameterInfo& info, double value) {
  const auto raw = static_cast<std::uint64_t>(info.object->raw(value));
  std::vector<std::uint8_t> bytes(canopen::size_bytes(info.object->object->entry.type));
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(raw >> (8 * i));
  return bytes;
}

// Nothing for a value beyond the range: the parameter is not set.
std::optional<double> value_of(const ParameterInfo& info, const std::vector<std::uint8_t>& data) {
  std::uint64_t raw = 0;
  for (std::size_t i = 0; i < data.size() && i < sizeof raw; ++i) raw |= std::uint64_t{data[i]} << (8 * i);
  const std::size_t bits = 8 * data.size();
  const bool is_negative = canopen::is_signed(info.object->object->entry.type) && bits > 0 && bits < 64 &&
                           (raw >> (bits - 1)) != 0;
  if (is_negative) raw |= ~std::uint64_t{0} << bits;
  const auto number = static_cast<std::int64_t>(raw);
  if (number < info.object->low() || number > info.object->high()) return std::nullopt;
  return info.object->value(number);
}

}  // namespace

LiveParameters::LiveParameters(ParameterTable table, Send send, std::uint64_t first_number)
    : table_(table), send_(std::move(send)), last_number_(first_number) {
  reset();
}

void LiveParameters::reset() {
  states_.assign(table_.size(), {});
  wanted_.assign(table_.size(), std::nullopt);
  accesses_.clear();
  changes_.clear();
}

void LiveParameters::set_known(const app::ControllerValues& values) {
  for (std::size_t index = 0; index < table_.size(); ++index) {
    if (table_[index].object == nullptr) continue;
    states_[index].in_force = simulation::value_in(values, *table_[index].object);
    states_[index].is_known = true;
  }
}

void LiveParameters::return_to(std::uint64_t time_us) {
  wanted_.assign(table_.size(), std::nullopt);
  for (State& state : states_) state.is_pending = false;
  for (; !changes_.empty() && changes_.back().time_us > time_us; changes_.pop_back())
    states_[changes_.back().index] = changes_.back().before;
}

void LiveParameters::request(const Access& access) {
  const ParameterInfo& info = table_[access.index];
  simulation::ObjectRequest request{.number = ++last_number_,
                                    .node_id = sim_board::kControllerNode,
                                    .address = info.object->address(),
                                    .data = {}};
  if (access.value) request.data = bytes_of(info, *access.value);
  accesses_[request.number] = access;
  send_(request);
}

void LiveParameters::read(std::size_t index) {
  if (table_[index].object != nullptr) request({.index = index});
}

void LiveParameters::read_all() {
  for (std::size_t index = 0; index < table_.size(); ++index) read(index);
}

void LiveParameters::write(std::size_t index, double value) {
  if (table_[index].object == nullptr) return;
  if (states_[index].is_pending) {
    wanted_[index] = value;
    return;
  }
  states_[index].is_pending = true;
  request({.index = index, .value = value});
}

std::optional<std::size_t> LiveParameters::take_answer(const simulation::ObjectAnswer& answer) {
  const auto found = accesses_.find(answer.number);
  if (found == accesses_.end()) return std::nullopt;
  Access access = found->second;
  if (access.value && answer.abort == canopen::AbortCode::kTimedOut && access.tries < kMaxTries) {
    ++access.tries;
    request(access);
  } else if (access.value) {
    take_write(access, answer);
  } else {
    take_read(access, answer);
  }
  return access.index;
}

void LiveParameters::take_write(const Access& access, const simulation::ObjectAnswer& answer) {
  State& state = states_[access.index];
  State before = state;
  before.is_pending = false;
  changes_.push_back({answer.time_us, access.index, before});
  state.is_pending = false;
  if (answer.abort == canopen::AbortCode::kNone) {
    const ParameterInfo& info = table_[access.index];
    state.in_force = info.object->value(info.object->raw(*access.value));
    state.is_known = true;
    state.refusal.clear();
  } else {
    state.refusal = bus::text_of(answer.abort);
  }
  if (const auto next = std::exchange(wanted_[access.index], std::nullopt)) write(access.index, *next);
}

void LiveParameters::take_read(const Access& access, const simulation::ObjectAnswer& answer) {
  if (answer.abort != canopen::AbortCode::kNone) return;
  State& state = states_[access.index];
  changes_.push_back({answer.time_us, access.index, state});
  changes_.back().before.is_pending = false;
  state.in_force = value_of(table_[access.index], answer.data);
  state.is_known = true;
}

}  // namespace koboshi::studio
