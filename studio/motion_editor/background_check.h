#pragma once

#include <QObject>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "simulation/motion_language/parse/diagnostic.h"
#include "tools/motion_check/servo_curve.h"

namespace koboshi::studio {

// The check's result for 10 ms of the motion.
struct CheckedTick {
  int line = 0;           // of the step in the file
  double margin_m = 0.0;  // NaN: balance is not judged
  // The greatest share of a servo's torque at the lowest supply; NaN: not judged.
  double torque_share = 0.0;
  std::uint8_t torque_joint = 0;
  // The load of each servo, by joint; null: not judged.
  std::shared_ptr<const std::vector<tools::ServoLoad>> loads = {};
};

// The result of `koboshi motion check` for one text.
struct CheckResult {
  std::vector<simulation::Diagnostic> diagnostics = {};
  std::vector<CheckedTick> ticks = {};   // of the path with neutral sensors
  std::vector<double> targets_rad = {};  // `joints` per tick
  std::size_t joints = 0;
  std::vector<double> stall_torques_Nm = {};  // of the servos at the lowest supply, by joint
  std::string balance = "not judged";
  bool is_judged = false;
  double least_margin_m = 0.0;
  double least_margin_s = 0.0;
  double duration_s = 0.0;
  bool endless = false;
  std::string error = {};  // of a robot or motion that cannot be checked
};

// Runs `koboshi motion check` in a thread of its own. A newer request cancels an older one. A check begins
// when no newer request has come for as long as the last check took, at most 0.12 s.
class BackgroundCheck final : public QObject {
  Q_OBJECT

 public:
  struct Request {
    std::filesystem::path robot_file = {};
    std::filesystem::path file = {};  // for messages
    std::string text = {};
  };

  explicit BackgroundCheck(QObject* parent = nullptr);
  // Cancels the check and waits for its thread, which takes at most a tick of the motion.
  ~BackgroundCheck() override;

  void request(Request request);
  // Cancels the last request; `finished` does not follow.
  void cancel();
  // Whether the result of the last request is still to come.
  bool is_running() const { return is_running_; }
  // Whether the thread works on a request.
  bool has_begun() const { return has_begun_; }
  // Number of checks that a newer request or cancel() has stopped after they began.
  std::size_t cancelled() const { return cancelled_; }

 Q_SIGNALS:
  // The result of the last request.
  void finished(const std::shared_ptr<const koboshi::studio::CheckResult>& result);

 private:
  void run(const std::stop_token& end);
  void deliver(std::uint64_t number, const std::shared_ptr<const CheckResult>& result);

  std::uint64_t last_ = 0;  // number of the last request
  bool is_running_ = false;
  std::atomic<bool> has_begun_ = false;
  std::atomic<std::size_t> cancelled_ = 0;
  std::mutex mutex_;  // of what follows
  std::condition_variable_any has_request_;
  std::optional<Request> pending_;
  std::uint64_t pending_number_ = 0;
  std::stop_source running_;
  std::jthread thread_;  // the last member: it ends before the others
};

}  // namespace koboshi::studio
