// decode_log ROBOT LOG: decodes a candump log for dbc_test.py. Each line holds one signal: frame number,
// signal, raw value, value and the value's name.

#include <cstdio>

#include <fmt/core.h>

#include "bus/dictionary/network.h"
#include "sim_board/can/candump_log.h"
#include "sim_board/description/load.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const koboshi::bus::Network network = koboshi::bus::make_network(koboshi::sim_board::load_robot(argv[1]));
  koboshi::sim_board::CandumpReader log(argv[2]);
  for (int number = 0; const auto logged = log.next(); ++number) {
    const auto* frame = std::get_if<koboshi::hal::CanFrame>(&logged->frame);
    if (frame == nullptr) continue;
    for (const koboshi::bus::Reading& reading : koboshi::bus::decode(network, *frame)) {
      fmt::print("{}\t{}\t{}\t{}\t{}\n", number, reading.signal->name, reading.raw, reading.value,
                 reading.name);
    }
  }
  return 0;
}
