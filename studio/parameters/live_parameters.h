#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/dictionary.h"
#include "simulation/scenario/object_access.h"
#include "studio/parameters/parameter_table.h"

namespace koboshi::studio {

// The parameters of a running controller: reads and writes their objects by SDO, as a client on the bus does.
// In a simulation the accesses are inputs of the run, so a rewind repeats them. Nothing waits: answers come
// by take_answer(). At most one write of a parameter is under way; of values that are set meanwhile, the last
// one follows, so a slider does not fill the bus.
class LiveParameters {
 public:
  using Send = std::function<void(const simulation::ObjectRequest& request)>;

  // The state of one parameter.
  struct State {
    std::optional<double> in_force;  // in the controller's dictionary; nothing: not set or not known
    bool is_known = false;
    bool is_pending = false;  // a write is under way
    std::string refusal;      // of the last write, in the words of CiA 301; empty: accepted
  };

  // Numbers of requests from here on: others on the same bus count from 1.
  static constexpr std::uint64_t kFirstNumber = std::uint64_t{1} << 40;
  explicit LiveParameters(ParameterTable table, Send send, std::uint64_t first_number = kFirstNumber);

  ParameterTable table() const { return table_; }
  const State& state(std::size_t index) const { return states_[index]; }

  // Forgets everything: another run, robot or bus.
  void reset();
  // The values that a controller has at the start of a scenario, which need not be read.
  void set_known(const app::ControllerValues& values);
  // Returns to an earlier moment: accesses later than that have not happened.
  void return_to(std::uint64_t time_us);
  void read(std::size_t index);
  void read_all();
  // Writes a value, rounded to a step. Parameters without an object are left alone.
  void write(std::size_t index, double value);
  // Returns the parameter that an answer is about, if any.
  std::optional<std::size_t> take_answer(const simulation::ObjectAnswer& answer);

 private:
  struct Access {
    std::size_t index = 0;
    std::optional<double> value{};  // to write; nothing: read
    int tries = 1;
  };
  // A value that came into force.
  struct Change {
    std::uint64_t time_us = 0;
    std::size_t index = 0;
    State before;
  };

  void request(const Access& access);
  void take_write(const Access& access, const simulation::ObjectAnswer& answer);
  void take_read(const Access& access, const simulation::ObjectAnswer& answer);

  const ParameterTable table_;
  const Send send_;
  std::vector<State> states_;
  std::vector<std::optional<double>> wanted_;  // value that follows the write under way
  // By number. Answered ones stay: after a rewind to the time between, an answer comes again.
  std::map<std::uint64_t, Access> accesses_;
  std::vector<Change> changes_;  // in order of time
  std::uint64_t last_number_;
};

}  // namespace koboshi::studio
