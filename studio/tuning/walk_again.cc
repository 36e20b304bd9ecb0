#include "studio/tuning/walk_again.h"

#include "bus/can/sdo_transfer.h"
#include "firmware/app/dictionary.h"
#include "sim_board/board/sim_board.h"
#include "studio/parameters/live_parameters.h"

namespace koboshi::studio {
namespace {

constexpr int kPeriod_ms = 50;
constexpr canopen::ObjectAddress kCommand{0x2000, 1};
constexpr canopen::ObjectAddress kState{0x2001, 1};

std::vector<std::uint8_t> command(behaviour::Command command) { return {static_cast<std::uint8_t>(command)}; }

}  // namespace

// Numbers behind those of the parameters.
WalkAgain::WalkAgain(QObject* parent) : QObject(parent), number_(4 * LiveParameters::kFirstNumber) {
  timer_.setSingleShot(true);
  timer_.setInterval(kPeriod_ms);
  connect(&timer_, &QTimer::timeout, this, [this] { request(Stage::kAwaitStand); });
}

void WalkAgain::start() { request(Stage::kStop); }

void WalkAgain::cancel() {
  stage_ = Stage::kIdle;
  timer_.stop();
}

void WalkAgain::request(Stage stage) {
  stage_ = stage;
  simulation::ObjectRequest request{
      .number = ++number_, .node_id = sim_board::kControllerNode, .address = kCommand};
  if (stage == Stage::kStop) request.data = command(behaviour::Command::kStop);
  if (stage == Stage::kWalk) request.data = command(behaviour::Command::kWalk);
  if (stage == Stage::kAwaitStand) request.address = kState;
  Q_EMIT requested(request);
}

void WalkAgain::take_answer(const simulation::ObjectAnswer& answer) {
  if (stage_ == Stage::kIdle || answer.number != number_) return;
  // A robot that stands refuses to stop, which is as good.
  if (stage_ == Stage::kStop) return request(Stage::kAwaitStand);
  const bool refused = answer.abort != canopen::AbortCode::kNone;
  if (stage_ == Stage::kWalk || refused) {
    stage_ = Stage::kIdle;
    if (refused) Q_EMIT failed(QString::fromStdString(bus::text_of(answer.abort)));
    return;
  }
  const bool stands =
      !answer.data.empty() && answer.data.front() == static_cast<std::uint8_t>(behaviour::State::kStanding);
  if (stands) return request(Stage::kWalk);
  timer_.start();
}

}  // namespace koboshi::studio
