#include "simulation/observe/event_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "firmware/app/controller_objects.h"
#include "firmware/canopen/frame.h"
#include "firmware/drive/configuration.h"
#include "simulation/disturbance/world_text.h"
#include "simulation/observe/event_words.h"
#include "simulation/observe/posture.h"

namespace koboshi::simulation {
namespace {

using behaviour::State;

// Maximum time from a command to the telemetry of its outcome: the controller receives a frame within a
// millisecond, and the telemetry of a tick is on the bus 2.6 to 3 ms after it (docs/design/timing.md).
constexpr std::uint64_t kAnswer_us = 4'000;
// Telemetry that ends earlier than this after a command cannot report its outcome.
constexpr std::uint64_t kEarliestAnswer_us = 2'000;
// Emergency messages with the same code within this time of each other form one event, for example when
// twenty drives miss the same heartbeat.
constexpr std::uint64_t kSameEmergency_us = 100'000;

constexpr std::uint16_t kCommandIdentifier = canopen::kRpdo1Base + drive::kControllerNodeId;
constexpr std::uint16_t kVelocityIdentifier = kCommandIdentifier + canopen::kPdoStep;
constexpr std::uint16_t kStateIdentifier = canopen::kTpdo1Base + drive::kControllerNodeId;
constexpr std::uint16_t kSdoIdentifier = canopen::kSdoRequestBase + drive::kControllerNodeId;
constexpr std::uint16_t kSdoAnswerIdentifier = canopen::kSdoResponseBase + drive::kControllerNodeId;
constexpr std::uint16_t kHeartbeatIdentifier = canopen::kHeartbeatBase + drive::kControllerNodeId;

constexpr const char* kNotOfTheRobot = ", which the robot does not have";

// Events whose texts differ only in their numbers have the same cause.
std::string without_digits(std::string text) {
  std::erase_if(text, [](char letter) { return letter >= '0' && letter <= '9'; });
  return text;
}

walk::Velocity velocity_of(const hal::CanFrame& frame) {
  const auto part = [&](std::size_t at) {
    return static_cast<std::int16_t>(canopen::load_u16(&frame.data[at]));
  };
  return {part(0), part(2), part(4)};
}

nlohmann::ordered_json velocity_json(const walk::Velocity& velocity) {
  return {{"forward_m_per_s", velocity.forward_mm_per_s / 1000.0},
          {"left_m_per_s", velocity.left_mm_per_s / 1000.0},
          {"turn_rad_per_s", velocity.turn_mrad_per_s / 1000.0}};
}

}  // namespace

EventLog::EventLog(const Scenario& scenario, const NamedModel& model, const walk::VelocityLimits& limits)
    : scenario_(scenario),
      model_(model),
      limits_(limits),
      begun_(scenario.faults.size()),
      ended_(scenario.faults.size()) {
  for (const PlantSetting& setting : scenario.plant)
    add(0, "plant",
        "The simulated robot has " + setting.field.text + " = " + setting.value + ", unlike its model.",
        {{"key", setting.field.text}, {"value", setting.value}});
  last_text_.clear();
}

void EventLog::add_world(const DisturbedWorld& world, const sim_board::RobotDescription& robot) {
  for (const auto& [factor, value] : drawn_texts(world, robot)) {
    add(0, "world",
        fmt::format("Seed {} of the world {} draws {}: {}.", world.seed, world.name, factor, value),
        {{"world", world.name}, {"seed", world.seed}, {"factor", factor}, {"value", value}});
  }
  last_text_.clear();
}

void EventLog::add(std::uint64_t time_us, const std::string& kind, const std::string& text,
                   nlohmann::ordered_json fields) {
  if (kind != "command" && kind != "velocity") last_text_ = text;
  static_cast<void>(events_.add({time_us, kind, text, std::move(fields)}, without_digits(text)));
}

void EventLog::on_bus_frame(const hal::CanFrame& frame, std::uint64_t end_us, const Telemetry& said) {
  if (frame.remote) return;  // without data: a request for a frame
  switch (frame.identifier) {
    case kCommandIdentifier:
      if (frame.size < 3) return;
      return hear_command(static_cast<behaviour::Command>(frame.data[0]),
                          static_cast<std::int16_t>(canopen::load_u16(&frame.data[1])), end_us, said);
    case kVelocityIdentifier:
      if (frame.size < 6) return;
      velocity_ = velocity_of(frame);
      velocity_us_ = end_us;
      return;
    case kSdoIdentifier:
      return hear_sdo(frame, end_us, said);
    case kSdoAnswerIdentifier:
      if (frame.size == 8) sdo_blocks_.follow(frame.data, false);
      return;
    case kHeartbeatIdentifier:
      if (hal::is_boot_up(frame)) sdo_blocks_.reset();
      return;
    case kStateIdentifier:
      if (frame.size != 8) return;
      follow_state(end_us, said);
      judge_commands(end_us, said);
      return judge_velocity(end_us, said);
    default:
      if ((frame.identifier & ~0x7F) == canopen::kEmergencyBase && (frame.identifier & 0x7F) != 0)
        hear_emergency(frame, end_us);
  }
}

// Detects expedited downloads (CiA 301, 7.2.4.3.3) to the command object. The data of a block are none.
void EventLog::hear_sdo(const hal::CanFrame& frame, std::uint64_t time_us, const Telemetry& said) {
  if (frame.size != 8 || sdo_blocks_.follow(frame.data, true)) return;
  const bool is_download = (frame.data[0] & 0xE2) == 0x22;
  if (!is_download || canopen::load_u16(&frame.data[1]) != app::kRequestObject) return;
  const std::uint16_t value = canopen::load_u16(&frame.data[4]);
  if (frame.data[3] == 2) sdo_argument_ = static_cast<std::int16_t>(value);
  if (frame.data[3] == 1)
    hear_command(static_cast<behaviour::Command>(value & 0xFF), sdo_argument_, time_us, said);
}

void EventLog::hear_command(behaviour::Command command, std::int16_t argument, std::uint64_t time_us,
                            const Telemetry& said) {
  if (command == behaviour::Command::kNone) return;
  GivenCommand given{time_us, command, argument, {}, said.state};
  if (command == behaviour::Command::kWalk) {
    given.velocity = velocity_.value_or(walk::Velocity{});
    reported_velocity_ = given.velocity;
    velocity_us_.reset();
  }
  given_.push_back(given);
}

// The telemetry reports the outcome of the last command before its tick. The outcome of an earlier command in
// the same cycle is unknown.
void EventLog::judge_commands(std::uint64_t time_us, const Telemetry& said) {
  const auto is_answered = [&](const GivenCommand& given) { return time_us >= given.time_us + kAnswer_us; };
  while (!given_.empty() && is_answered(given_.front())) {
    const bool is_followed = given_.size() > 1 && time_us >= given_[1].time_us + kEarliestAnswer_us;
    judge(given_.front(), is_followed ? std::nullopt : std::optional(said.refusal));
    given_.erase(given_.begin());
  }
}

void EventLog::judge(const GivenCommand& given, std::optional<behaviour::Reason> refusal) {
  const std::string verb(canopen::name_of(app::kCommandNames, static_cast<std::int64_t>(given.command)));
  nlohmann::ordered_json fields{{"command", verb}};
  std::string text = verb.empty() ? fmt::format("{}", static_cast<int>(given.command)) : verb;
  if (given.command == behaviour::Command::kPlay) {
    text += " " + motion_name(given.argument);
    fields["motion"] = motion_name(given.argument);
  }
  if (given.velocity) {
    text += ", " + velocity_text(*given.velocity);
    fields.update(velocity_json(*given.velocity));
  }
  std::string outcome = refusal ? "obeyed" : "outcome unknown, another command followed at once";
  if (refusal && *refusal != behaviour::Reason::kNone) {
    ++refused_;
    outcome = fmt::format("refused, {} ({})", name_of(*refusal), name_of(given.state));
    fields["outcome"] = "refused";
    fields["reason"] = name_of(*refusal);
    fields["state"] = name_of(given.state);
  } else if (!refusal) {
    fields["outcome"] = "unknown";
  } else if (given.velocity && clamped(*given.velocity, limits_) != *given.velocity) {
    ++refused_;
    outcome = "obeyed, but its velocity is refused, " + name_of(behaviour::Reason::kVelocityOutOfRange);
    fields["reason"] = name_of(behaviour::Reason::kVelocityOutOfRange);
  }
  last_command_ = text + ": " + outcome;
  add(given.time_us, "command", "Command " + last_command_ + ".", fields);
}

void EventLog::judge_velocity(std::uint64_t time_us, const Telemetry& said) {
  if (!velocity_us_ || time_us < *velocity_us_ + kAnswer_us) return;
  const std::uint64_t at_us = *std::exchange(velocity_us_, std::nullopt);
  if (reported_velocity_ == velocity_) return;  // a joystick repeats the velocity
  reported_velocity_ = velocity_;
  const bool is_refused = said.refusal == behaviour::Reason::kVelocityOutOfRange;
  refused_ += is_refused ? 1 : 0;
  nlohmann::ordered_json fields = velocity_json(*velocity_);
  fields["outcome"] = is_refused ? "refused" : "obeyed";
  if (is_refused) fields["reason"] = name_of(said.refusal);
  last_command_ = fmt::format("velocity {}: {}", velocity_text(*velocity_),
                              is_refused ? "refused, " + name_of(said.refusal) : "obeyed");
  add(at_us, "velocity", "V" + last_command_.substr(1) + ".", fields);
}

void EventLog::hear_emergency(const hal::CanFrame& frame, std::uint64_t time_us) {
  if (frame.size != 8) return;
  const std::uint16_t code = canopen::load_u16(frame.data.data());
  if (code == 0) return;  // error reset
  const auto number = static_cast<std::uint8_t>(frame.identifier & 0x7F);
  const bool exists = has_node(model_.model, number);
  const std::string node = node_name(number);
  const std::string name(canopen::name_of(canopen::kErrorCodeNames, code));
  const std::string what = fmt::format("Emergency message 0x{:04X}{}", code, name.empty() ? "" : ", " + name);
  const auto group = emergencies_.find({code, exists});
  if (group != emergencies_.end() && time_us <= group->second.last_us + kSameEmergency_us) {
    group->second.last_us = time_us;
    if (!group->second.event) return;
    RunEvent& event = events_[*group->second.event];
    auto& nodes = event.fields["nodes"];
    if (std::ranges::find(nodes, nlohmann::ordered_json(node)) == nodes.end()) nodes.push_back(node);
    if (nodes.size() > 1)
      event.text = fmt::format("{}, from {} nodes{}.", what, nodes.size(), exists ? "" : kNotOfTheRobot);
    return;
  }
  last_text_ = what + ", from " + node + (exists ? "" : kNotOfTheRobot) + ".";
  const auto event =
      events_.add({time_us,
                   "emergency",
                   last_text_,
                   {{"code", fmt::format("0x{:04X}", code)}, {"name", name}, {"nodes", {node}}}},
                  exists ? fmt::format("0x{:04X}", code) : kNotOfTheRobot);
  emergencies_[{code, exists}] = {event, time_us};
}

void EventLog::follow_state(std::uint64_t time_us, const Telemetry& said) {
  if (heard_state_ && said.state != said_.state) {
    tell_cut_off(time_us, said);
    tell_state(time_us, said);
    entered_us_ = time_us;
  }
  heard_state_ = true;
  said_.state = said.state;
  said_.motion = said.motion;
}

// Reports the motion or walk that was interrupted before its end.
void EventLog::tell_cut_off(std::uint64_t time_us, const Telemetry& said) {
  const bool was_moving = said_.state == State::kMotion || said_.state == State::kWalking;
  // Sitting down begins with the orderly end of both.
  if (!was_moving || said.state == State::kStanding || said.state == State::kSittingDown) return;
  const std::string what =
      said_.state == State::kMotion ? motion_name(said_.motion) : std::string("the walk");
  cut_offs_.push_back(what + " was cut off at " + seconds_text(time_us));
  add(time_us, "cut_off",
      fmt::format("{} is cut off after {}: {}.",
                  said_.state == State::kMotion ? "The motion " + what : "The walk",
                  seconds_text(time_us - entered_us_), reason_text(said)),
      {{"motion", said_.state == State::kMotion ? what : "walk"},
       {"after_s", static_cast<double>(time_us - entered_us_) / 1e6},
       {"reason", reason_text(said)}});
}

void EventLog::tell_state(std::uint64_t time_us, const Telemetry& said) {
  const std::string motion = motion_name(said.motion);
  const auto tell = [&](const char* kind, const std::string& text) {
    add(time_us, kind, text,
        {{"from", name_of(said_.state)}, {"to", name_of(said.state)}, {"reason", reason_text(said)}});
  };
  switch (said.state) {
    case State::kBoot:
      return tell("state", "The controller boots.");
    case State::kLimp:
      if (said_.state == State::kSittingDown)
        return tell("sits", "Sits, and is limp: " + reason_text(said) + ".");
      return tell("state", said_.state == State::kBoot ? "Limp and ready: drives and sensors have answered."
                                                       : "Limp: " + reason_text(said) + ".");
    case State::kEnabling:
      return tell("state", "The drives are enabled.");
    case State::kSoftStart:
      return tell("state", said_.state == State::kEnabling
                               ? "Goes to the standing pose."
                               : "Goes to the standing pose: " + reason_text(said) + ".");
    case State::kStanding:
      if (said_.state == State::kMotion && said.reason == behaviour::Reason::kMotionFailed) {
        const std::string failed = motion_name(said_.motion) + " failed at " + seconds_text(time_us);
        cut_offs_.push_back(failed);
        return tell("motion_failed", "Stands: the motion " + motion_name(said_.motion) + " has failed.");
      }
      if (said_.state == State::kMotion) return tell("state", "Stands: the motion has ended.");
      if (said_.state == State::kWalking) return tell("state", "Stands: the walk has ended.");
      if (said_.state == State::kStreaming) return tell("state", "Stands: the stream of targets has ended.");
      if (said_.state == State::kSteadying) {
        const std::string since =
            down_us_ ? fmt::format(", {} after {}", seconds_text(time_us - *down_us_), down_by_) : "";
        tell("recovery_ended",
             fmt::format("Stands: has got up at attempt {}{}.", std::max<std::size_t>(attempts_, 1), since));
      } else {
        tell("state", "Stands.");
      }
      attempts_ = 0;
      down_us_.reset();
      return;
    case State::kMotion:
      return tell("state", "Plays the motion " + motion + ".");
    case State::kWalking:
      return tell("state", said.reason == behaviour::Reason::kPushed
                               ? "Is pushed beyond what its soles hold, and takes steps."
                               : "Walks.");
    case State::kFalling:
      down_us_ = time_us;
      down_by_ = "the fall was detected";
      return tell("fall_predicted", "A fall is detected: takes the pose of " + motion + ".");
    case State::kFallen:
      if (behaviour::kGettingUp.contains(said_.state))
        return tell("recovery_failed", "The attempt to get up has failed: " + reason_text(said) + ".");
      if (!down_us_) {
        down_us_ = time_us;
        down_by_ = "it was commanded";
      }
      return tell("state", "Down and limp, until it lies still.");
    case State::kRighting:
      if (said_.state == State::kRolling) return tell("state", "Has rolled.");
      return tell("recovery_begun", fmt::format("Begins to get up, attempt {}.", ++attempts_));
    case State::kRolling:
      return tell("state", fmt::format("Rolls, {}, with the motion {}.", name_of(said.reason), motion));
    case State::kRising:
      return tell("state", fmt::format("Rises, {}, with the motion {}.", name_of(said.reason), motion));
    case State::kSteadying:
      return tell("state", "Has risen, and comes to rest.");
    case State::kLowBattery:
      if (said_.state == State::kSittingDown)
        return tell("low_supply",
                    "Does not sit as the motion " + motion +
                        " expects: keeps its pose, and obeys only limp and the emergency stop.");
      return tell("low_supply",
                  "The supply is low, and the robot has no motion sit: stands, and obeys only limp and the "
                  "emergency stop.");
    case State::kSittingDown:
      return tell("low_supply",
                  std::string("The supply is low: ") +
                      (said_.state == State::kWalking     ? "slows down, stops and sits down."
                       : said_.state == State::kMotion    ? "ends its motion and sits down."
                       : said_.state == State::kStreaming ? "returns to the standing pose and sits down."
                                                          : "sits down."));
    case State::kStreaming:
      return tell("state", "Follows a stream of joint targets.");
    case State::kFault:
      return tell("fault", "Fault: " + reason_text(said) + ".");
    case State::kEmergencyStop:
      return tell("emergency_stop", "Emergency stop: limp at once.");
  }
}

void EventLog::observe_tick(std::uint64_t now_us, const Telemetry& said, const GroundTruth& truth,
                            std::span<const Push> pushes) {
  now_us_ = now_us;
  said_ = said;
  truth_ = truth;
  follow_scenario(now_us, pushes);
  follow_truth(now_us);
}

void EventLog::follow_truth(std::uint64_t now_us) {
  if (truth_.tilt_rad > kFallen_rad && was_upright_ && !is_down_) {
    is_down_ = true;
    falls_.push_back({now_us, {}});
    const std::string direction = lean_direction(truth_.rpy_rad);
    add(now_us, "fall", "The robot falls: its trunk leans more than 60 degrees, to the " + direction + ".",
        {{"direction", direction}});
  }
  if (truth_.tilt_rad >= kUpAgain_rad) return;
  was_upright_ = true;
  is_down_ = false;
  if (!falls_.empty() && !falls_.back().up_us && behaviour::kOnItsFeet.contains(said_.state))
    falls_.back().up_us = now_us;
}

void EventLog::follow_scenario(std::uint64_t now_us, std::span<const Push> pushes) {
  const auto release_us = scenario_.initial.release_us;
  if (!released_ && release_us && now_us > *release_us) {
    released_ = true;
    add(*release_us, "release", "The stand releases the robot.");
  }
  for (; next_push_ < pushes.size() && pushes[next_push_].at_us < now_us; ++next_push_)
    tell_push(pushes[next_push_]);
  for (std::size_t i = 0; i < begun_.size(); ++i) {
    const Fault& fault = scenario_.faults[i];
    const nlohmann::ordered_json fields{{"fault", Fault::kind_names()[static_cast<std::size_t>(fault.kind)]},
                                        {"target", fault.target.text}};
    if (!begun_[i] && fault.at_us < now_us) {
      begun_[i] = true;
      add(fault.at_us, "scenario_fault", "The scenario's fault " + fault_text(fault) + " begins.", fields);
    }
    if (!ended_[i] && fault.end_us() < now_us) {
      ended_[i] = true;
      add(fault.end_us(), "scenario_fault_end", "The scenario's fault " + fault_text(fault) + " ends.",
          fields);
    }
  }
}

void EventLog::tell_push(const Push& push) {
  const double duration_s = static_cast<double>(push.duration_us) / 1e6;
  const Eigen::Vector3d impulse_W_N_s =
      duration_s * push.mean_force_W_N(push.at_us, push.at_us + push.duration_us);
  const std::string direction = direction_text(impulse_W_N_s, truth_.rpy_rad.z());
  add(push.at_us, "push",
      fmt::format("The {} is pushed {} with {:.2f} N s in {:.2f} s.", push.link.text, direction,
                  impulse_W_N_s.norm(), duration_s),
      {{"link", push.link.text},
       {"direction", direction},
       {"impulse_N_s", {impulse_W_N_s.x(), impulse_W_N_s.y(), impulse_W_N_s.z()}},
       {"duration_s", duration_s}});
}

std::string EventLog::motion_name(int number) const {
  const auto index = static_cast<std::size_t>(number);
  if (number >= 0 && index < scenario_.motions.size()) return scenario_.motions[index].name();
  if (scenario_.gait && index == scenario_.motions.size()) return kGaitMotion;
  return fmt::format("number {}", number);
}

std::string EventLog::node_name(std::uint8_t node) const {
  if (node == drive::kControllerNodeId) return "the controller";
  for (std::size_t joint = 0; joint < model_.model.joint_count; ++joint)
    if (model_.model.joints[joint].drive.node_id == node) return model_.joint_names[joint];
  return fmt::format("node {}", node);
}

std::string EventLog::reason_text(const Telemetry& said) const {
  if (said.reason != behaviour::Reason::kDriveFault) return name_of(said.reason);
  const std::string fault(
      canopen::name_of(app::kDriveFaultNames, static_cast<std::int64_t>(said.drive_fault)));
  const bool known = said.faulty_joint < model_.joint_names.size();
  return (known ? model_.joint_names[said.faulty_joint] + " " : "drive ") + fault;
}

std::string events_text(std::span<const RunEvent> events) {
  std::string text;
  for (const RunEvent& event : events)
    text += fmt::format("{:9.3f} s  {}\n", static_cast<double>(event.time_us) / 1e6, event.text);
  return text;
}

void EventLog::archive(sim_board::StateArchive& archive) {
  archive(events_, said_, truth_, now_us_, heard_state_, entered_us_, given_, velocity_, velocity_us_,
          reported_velocity_, sdo_blocks_, sdo_argument_, last_command_, last_text_, refused_, emergencies_,
          falls_, is_down_, was_upright_, down_us_, down_by_, attempts_, cut_offs_, remarks_, next_push_,
          begun_, ended_, released_);
}

}  // namespace koboshi::simulation
