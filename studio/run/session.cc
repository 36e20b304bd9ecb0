#include "studio/run/session.h"

#include <algorithm>
#include <future>
#include <iterator>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/text/error.h"

namespace koboshi::studio {
namespace {

constexpr std::uint64_t kMillisecond_us = 1000;
constexpr std::uint64_t kTick_us = sim_board::SimBoard::kTick_us;
constexpr std::uint64_t kEventPeriod_us = 10 * kTick_us;
// A machine that is too slow falls behind by this much, then the run is slower than the wall clock instead of
// hurrying once it can.
constexpr std::uint64_t kMaxLag_us = 200'000;

bool same(const view::Event& shown, const simulation::RunEvent& event) {
  return shown.time_us == event.time_us && shown.kind == event.kind && shown.text == event.text;
}

}  // namespace

Session::Session(const simulation::Scenario& scenario, Options options)
    : scenario_(scenario),
      options_(std::move(options)),
      simulation_(scenario),
      recorder_(simulation_, nullptr, this, simulation::RunRecorder::Rows::kAlways),
      snapshots_(options_.snapshot_budget_bytes),
      head_(view::recording_head(simulation_)),
      robot_(simulation_.robot()) {
  begin_recording();
  snapshots_.add(simulation_.snapshot());
  publish_bus();
  now_.duration_us = scenario.duration_us;
  publish();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Session::~Session() {
  thread_.request_stop();
  thread_.join();
}

void Session::start() {
  enqueue([this] {
    if (now_.state == SessionStatus::State::kFailed) return;
    now_.state = SessionStatus::State::kRunning;
    now_.message.clear();
    pacer_.reset();
  });
}

void Session::pause() {
  enqueue([this] {
    if (now_.state == SessionStatus::State::kRunning) now_.state = SessionStatus::State::kPaused;
  });
}

void Session::step(std::uint64_t milliseconds) {
  enqueue([this, milliseconds] {
    if (now_.state == SessionStatus::State::kFailed) return;
    for (std::uint64_t i = 0; i < milliseconds && now_.state != SessionStatus::State::kFailed; ++i) advance();
    if (now_.state != SessionStatus::State::kFailed) now_.state = SessionStatus::State::kPaused;
  });
}

void Session::set_speed(double speed) {
  constexpr double kMaxSpeed = 100.0;
  enqueue([this, speed = std::clamp(speed, kUnpaced, kMaxSpeed)] {
    speed_ = speed;
    pacer_.reset();
  });
}

void Session::rewind(std::uint64_t time_us) {
  enqueue([this, time_us] { return_to(time_us - time_us % kMillisecond_us); });
}

void Session::give(Input input) {
  enqueue([this, input = std::move(input)] {
    if (now_.state == SessionStatus::State::kFailed) return;
    apply(input);
    inputs_.push_back({simulation_.board().now_us(), input});
    now_.message.clear();
  });
}

SessionStatus Session::status() const {
  const std::scoped_lock lock(mutex_);
  return status_;
}

void Session::wait() {
  std::uint64_t samples = 0;
  enqueue_and_wait([&] {
    publish_events();
    samples = samples_;
  });
  inbox_.wait_for_samples(samples);
}

std::uint64_t Session::state_hash() {
  std::uint64_t hash = 0;
  enqueue_and_wait([&] { hash = recorder_.state_hash(); });
  return hash;
}

simulation::RunSummary Session::summary() {
  simulation::RunSummary summary;
  enqueue_and_wait([&] { summary = recorder_.summary(); });
  return summary;
}

simulation::Scenario Session::played() {
  simulation::Scenario played;
  enqueue_and_wait([&] { played = simulation_.played(); });
  return played;
}

void Session::enqueue(Job job) {
  {
    const std::scoped_lock lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  wake_.notify_one();
}

void Session::enqueue_and_wait(const Job& job) {
  std::promise<void> done;
  enqueue([&] {
    job();
    publish();
    done.set_value();
  });
  done.get_future().wait();
}

void Session::run(const std::stop_token& stop) {
  std::vector<Job> jobs;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      const bool awake = wake_.wait(
          lock, stop, [this] { return !jobs_.empty() || now_.state == SessionStatus::State::kRunning; });
      if (!awake || stop.stop_requested()) return;
      std::swap(jobs, jobs_);
    }
    const bool commanded = !jobs.empty();
    for (const Job& job : jobs) obey(job);
    jobs.clear();
    const bool runs = now_.state == SessionStatus::State::kRunning;
    if (runs) advance();
    if (commanded || (runs && now_.state != SessionStatus::State::kRunning)) publish_events();
    if (commanded || simulation_.board().now_us() % kTick_us == 0) publish();
    if (runs) pace();
  }
}

void Session::obey(const Job& job) {
  try {
    job();
  } catch (const InputError& error) {
    now_.message = error.what();
  }
}

// Advances and records a millisecond.
void Session::advance() {
  try {
    simulation_.advance();
    recorder_.record();
    recording_->record(recorder_);
  } catch (const std::runtime_error& error) {
    now_.state = SessionStatus::State::kFailed;
    now_.message = error.what();
    return;
  }
  const std::uint64_t now_us = simulation_.board().now_us();
  if (now_us % kTick_us == 0) ++samples_;
  if (snapshots_.due(now_us)) snapshots_.add(simulation_.snapshot());
  if (auto answers = simulation_.take_answers(); !answers.empty()) inbox_.add_answers(std::move(answers));
  if (now_us % kEventPeriod_us == 0) {
    publish_events();
    publish_bus();
  }
  if (now_us == scenario_.duration_us) now_.state = SessionStatus::State::kPaused;
}

void Session::pace() {
  if (speed_ == kUnpaced) return;
  const std::uint64_t now_us = simulation_.board().now_us();
  if (!pacer_ || pacer_->delay_us() > kMaxLag_us) pacer_.emplace(now_us, speed_, options_.wall);
  pacer_->wait_for(now_us);
}

void Session::apply(const Input& input) {
  if (const auto* command = std::get_if<simulation::Command>(&input)) {
    simulation_.command(*command);
  } else if (const auto* push = std::get_if<simulation::Push>(&input)) {
    simulation::check(*push, simulation_.robot());
    simulation_.push(*push);
  } else if (const auto* fault = std::get_if<simulation::Fault>(&input)) {
    simulation::check(*fault, simulation_.robot());
    simulation_.fault(*fault);
  } else if (const auto* request = std::get_if<simulation::ObjectRequest>(&input)) {
    simulation_.request(*request);
  } else {
    simulation_.write(std::get<simulation::ParameterSetting>(input));
  }
}

void Session::begin_recording() {
  recording_.emplace(std::filesystem::path(), simulation_, view::RunRecording::Options{.listener = &inbox_});
}

void Session::on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) {
  if (recording_) recording_->on_bus_frame(frame, start_us, end_us);
}

void Session::return_to(std::uint64_t time_us) {
  if (time_us >= simulation_.board().now_us() && now_.state != SessionStatus::State::kFailed) return;
  recording_.reset();
  replay_to(time_us);
  inbox_.rewind({simulation_.board().now_us(), simulation_.board().electronics().bus().now_us()});
  begin_recording();
  now_.state = SessionStatus::State::kPaused;
  now_.message.clear();
  pacer_.reset();
}

// Restores the last snapshot before a moment and repeats the run up to it, without recording it again.
void Session::replay_to(std::uint64_t time_us) {
  const simulation::Snapshot& snapshot = snapshots_.before(time_us);
  simulation_.restore(snapshot);
  const auto input_time = [](const GivenInput& given) { return given.time_us; };
  auto next = std::ranges::lower_bound(inputs_, snapshot.time_us(), {}, input_time);
  while (simulation_.board().now_us() < time_us) {
    for (; next != inputs_.end() && next->time_us <= simulation_.board().now_us(); ++next) apply(next->input);
    simulation_.advance();
    recorder_.record();
  }
  static_cast<void>(simulation_.take_answers());  // given before
  usage_ = simulation_.board().electronics().bus().usage();
  inputs_.erase(std::ranges::lower_bound(inputs_, time_us, {}, input_time), inputs_.end());
  snapshots_.truncate_after(time_us);
}

void Session::publish() {
  now_.time_us = simulation_.board().now_us();
  now_.said = recorder_.telemetry();
  now_.snapshots = snapshots_.count();
  now_.snapshot_bytes = snapshots_.size_bytes();
  now_.snapshot_interval_us = snapshots_.interval_us();
  const std::scoped_lock lock(mutex_);
  status_ = now_;
}

void Session::publish_bus() {
  const sim_board::Bus& bus = simulation_.board().electronics().bus();
  now_.nodes.clear();
  for (const sim_board::BusMember& member : simulation_.board().electronics().bus_members())
    now_.nodes.push_back(
        {member.node_id, bus.status(member.handle), bus.counters(member.handle), bus.powered(member.handle)});
  const sim_board::BusUsage usage = bus.usage();
  now_.bus_load = sim_board::bus_load(std::exchange(usage_, usage), usage);
}

void Session::publish_events() {
  const std::span<const simulation::RunEvent> events = recorder_.events().so_far();
  if (std::ranges::equal(events_, events, same)) return;
  events_.clear();
  for (const simulation::RunEvent& event : events) events_.push_back({event.time_us, event.kind, event.text});
  inbox_.set_events(events_);
}

}  // namespace koboshi::studio
