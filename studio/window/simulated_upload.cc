#include "studio/window/simulated_upload.h"

#include <algorithm>
#include <stdexcept>

#include "bus/can/sdo_transfer.h"
#include "firmware/app/dictionary.h"
#include "firmware/storage/image.h"
#include "firmware/storage/item.h"
#include "sim_board/board/sim_board.h"
#include "studio/controls/run_controller.h"

namespace koboshi::studio {
namespace {

simulation::ObjectRequest request_for(std::uint64_t number, std::uint16_t index, std::uint16_t motion,
                                      std::vector<std::uint8_t> data = {}) {
  return {.number = number,
          .node_id = sim_board::kControllerNode,
          .address = {index, static_cast<std::uint8_t>(motion + 1)},
          .data = std::move(data)};
}

}  // namespace

SimulatedUpload::SimulatedUpload(RunController& run, QObject* parent) : QObject(parent), run_(run) {
  connect(&run_, &RunController::answered, this, &SimulatedUpload::take_answer);
  connect(&run_, &RunController::opened, this, [this] { under_way_.reset(); });
}

void SimulatedUpload::start(MotionImage image,
                            const std::vector<std::pair<std::uint16_t, std::string>>& motions) {
  const auto same = std::ranges::find(motions, image.name, [](const auto& motion) { return motion.second; });
  std::uint16_t number = 0;
  if (same != motions.end()) {
    number = same->first;
  } else {
    const auto is_taken = [&] {
      return std::ranges::find(motions, number, [](const auto& motion) { return motion.first; }) !=
             motions.end();
    };
    while (is_taken()) ++number;
  }
  if (number >= storage::kMaxMotions) throw std::runtime_error("all numbers of motions are in use");
  crc32_ = storage::image_crc32(std::as_bytes(std::span(image.bytes)));
  under_way_ = {number, image.name, image.bytes.size()};
  // Both at once: the run may pause again before an answer is here.
  run_.give(request_for(++last_request_, app::kMotionObject, number, std::move(image.bytes)));
  run_.give(request_for(++last_request_, app::kMotionCrcObject, number));
}

void SimulatedUpload::take_answer(const simulation::ObjectAnswer& answer) {
  const bool is_write = answer.number + 1 == last_request_;
  if (!under_way_ || (!is_write && answer.number != last_request_)) return;
  if (answer.abort != canopen::AbortCode::kNone) {
    under_way_.reset();
    return Q_EMIT failed(QString::fromStdString(bus::text_of(answer.abort)));
  }
  if (is_write) return;
  const UploadedMotion motion = *std::exchange(under_way_, std::nullopt);
  std::uint32_t read = 0;
  for (std::size_t i = 0; i < answer.data.size(); ++i) read |= std::uint32_t{answer.data[i]} << (8 * i);
  if (read != crc32_) return Q_EMIT failed(tr("the controller has other bytes than were sent"));
  Q_EMIT done(motion, answer.time_us);
}

}  // namespace koboshi::studio
