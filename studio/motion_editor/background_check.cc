#include "studio/motion_editor/background_check.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <utility>

#include "tools/motion_check/check.h"

namespace koboshi::studio {
namespace {

constexpr int kNiceness = 5;

// The longest pause of the edits for which a check waits. While a joint is dragged in a long motion, each
// check would be cancelled by the next edit, and would only take a processor from the window.
constexpr std::chrono::milliseconds kLongestPause{120};

// A checker with the file of its robot.
struct RobotChecker {
  std::filesystem::path robot_file;
  std::unique_ptr<tools::MotionChecker> checker;
};

std::vector<CheckedTick> ticks_of(const tools::MotionReport& report, const tools::MotionChecker& checker) {
  const tools::Trajectory& trajectory = checker.trajectory();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::vector<CheckedTick> ticks(trajectory.ticks());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const tools::TickState& state = checker.states()[i];
    const std::size_t step = trajectory.steps[i];
    const bool judged = trajectory.on_feet[i];
    ticks[i].line = step < report.places.size() ? report.places[step].line : 0;
    ticks[i].margin_m = judged ? state.margin().distance_m : kNaN;
    ticks[i].torque_share = judged ? state.torque.share : kNaN;
    ticks[i].torque_joint = state.torque.joint;
    if (judged) ticks[i].loads = state.loads;
  }
  return ticks;
}

std::vector<double> stall_torques_Nm(const tools::MotionChecker& checker) {
  std::vector<double> torques_Nm;
  for (const sim_board::JointDescription& joint : checker.robot().joints)
    torques_Nm.push_back(tools::available_torque_Nm(joint.servo, 0.0, checker.analysis().supply().lowest_V));
  return torques_Nm;
}

// Returns nothing if it was cancelled.
std::shared_ptr<const CheckResult> check_text(const BackgroundCheck::Request& request, RobotChecker& robot,
                                              const std::stop_token& cancel) {
  auto result = std::make_shared<CheckResult>();
  try {
    if (robot.checker == nullptr || robot.robot_file != request.robot_file)
      robot = {request.robot_file, std::make_unique<tools::MotionChecker>(request.robot_file)};
    tools::MotionChecker& checker = *robot.checker;
    const auto motion = checker.compile(simulation::read_motion_text(request.file, request.text));
    auto report = checker.check(motion, cancel);
    if (!report) return nullptr;
    result->ticks = ticks_of(*report, checker);
    result->targets_rad = checker.trajectory().targets_rad;
    result->joints = checker.trajectory().joints;
    result->stall_torques_Nm = stall_torques_Nm(checker);
    result->diagnostics = std::move(report->diagnostics);
    result->balance = tools::kBalanceNames.at(static_cast<std::size_t>(report->balance));
    result->is_judged = report->balance != tools::Balance::kNotJudged;
    result->least_margin_m = report->least_margin_m;
    result->least_margin_s = report->least_margin_s;
    result->duration_s = report->duration_s;
    result->endless = report->endless;
  } catch (const std::exception& error) {
    result->error = error.what();
  }
  return result;
}

}  // namespace

BackgroundCheck::BackgroundCheck(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& end) { run(end); }) {}

BackgroundCheck::~BackgroundCheck() {
  thread_.request_stop();
  const std::scoped_lock lock(mutex_);
  running_.request_stop();
}

void BackgroundCheck::request(Request request) {
  ++last_;
  is_running_ = true;
  {
    const std::scoped_lock lock(mutex_);
    pending_ = std::move(request);
    pending_number_ = last_;
    running_.request_stop();
  }
  has_request_.notify_one();
}

void BackgroundCheck::cancel() {
  ++last_;
  is_running_ = false;
  const std::scoped_lock lock(mutex_);
  pending_.reset();
  running_.request_stop();
}

void BackgroundCheck::run(const std::stop_token& end) {
  // On Linux, of this thread alone: edits come first.
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kNiceness));
  RobotChecker robot;
  std::chrono::steady_clock::duration pause{};  // as long as the last check took: short ones follow a drag
  while (true) {
    Request request;
    std::uint64_t number = 0;
    std::stop_token cancel;
    {
      std::unique_lock lock(mutex_);
      has_request_.wait(lock, end, [this] { return pending_.has_value(); });
      for (std::uint64_t seen = 0; pending_ && seen != pending_number_;) {
        seen = pending_number_;
        has_request_.wait_for(lock, end, pause, [&] { return !pending_ || pending_number_ != seen; });
      }
      if (end.stop_requested()) return;
      if (!pending_) continue;
      request = *std::exchange(pending_, std::nullopt);
      number = pending_number_;
      running_ = std::stop_source();
      cancel = running_.get_token();
    }
    has_begun_ = true;
    const auto begin = std::chrono::steady_clock::now();
    const auto result = check_text(request, robot, cancel);
    const auto took = std::min<decltype(pause)>(std::chrono::steady_clock::now() - begin, kLongestPause);
    pause = result != nullptr ? took : std::max(pause, took);  // a cancelled one would have taken longer
    has_begun_ = false;
    if (result == nullptr) {
      ++cancelled_;
      continue;
    }
    // The event goes with this object if that is destroyed first.
    QMetaObject::invokeMethod(
        this, [this, number, result] { deliver(number, result); }, Qt::QueuedConnection);
  }
}

void BackgroundCheck::deliver(std::uint64_t number, const std::shared_ptr<const CheckResult>& result) {
  if (number != last_) return;
  is_running_ = false;
  Q_EMIT finished(result);
}

}  // namespace koboshi::studio
