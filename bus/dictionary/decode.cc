#include <algorithm>

#include "bus/dictionary/network.h"

namespace koboshi::bus {
namespace {

std::int64_t raw_value(const Signal& signal, const hal::CanFrame& frame) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < frame.data.size(); ++i) bits |= std::uint64_t{frame.data[i]} << (8 * i);
  const unsigned unused = 64 - signal.size_bits;
  const std::uint64_t shifted = bits >> signal.start_bit << unused;
  return signal.is_signed ? static_cast<std::int64_t>(shifted) >> unused
                          : static_cast<std::int64_t>(shifted >> unused);
}

}  // namespace

const Message* Network::find(std::uint16_t identifier) const {
  const auto message =
      std::lower_bound(messages.begin(), messages.end(), identifier,
                       [](const Message& one, std::uint16_t wanted) { return one.identifier < wanted; });
  return message != messages.end() && message->identifier == identifier ? &*message : nullptr;
}

std::vector<Reading> decode(const Network& network, const hal::CanFrame& frame) {
  std::vector<Reading> readings;
  const Message* message = frame.remote ? nullptr : network.find(frame.identifier);
  if (message == nullptr) return readings;
  for (const Signal& signal : message->signals) {
    if (signal.start_bit + signal.size_bits > 8u * frame.size) continue;
    const std::int64_t raw = raw_value(signal, frame);
    readings.push_back(
        {&signal, raw, static_cast<double>(raw) * signal.factor, canopen::name_of(signal.values, raw)});
  }
  return readings;
}

}  // namespace koboshi::bus
