#include "studio/run/controller_inquiry.h"

#include <algorithm>
#include <iterator>

#include "firmware/app/dictionary.h"
#include "firmware/storage/item.h"
#include "sim_board/board/sim_board.h"

namespace koboshi::studio {
namespace {

constexpr std::uint16_t kValidMotionsObject = 0x2403;  // a mask of 32 motions at each sub-index
constexpr std::uint16_t kMaskBits = 32;
constexpr std::uint16_t kMasks = (storage::kMaxMotions + kMaskBits - 1) / kMaskBits;
// By sub-index of 0x2111, from 1.
constexpr std::int16_t walk::VelocityLimits::*kLimits[] = {
    &walk::VelocityLimits::forward_mm_per_s, &walk::VelocityLimits::backward_mm_per_s,
    &walk::VelocityLimits::lateral_mm_per_s, &walk::VelocityLimits::turn_mrad_per_s};

std::uint32_t unsigned_of(const std::vector<std::uint8_t>& data) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < data.size() && i < sizeof value; ++i)
    value |= std::uint32_t{data[i]} << (8 * i);
  return value;
}

}  // namespace

ControllerInquiry::ControllerInquiry(Scope scope) : scope_(scope) {
  for (std::uint16_t i = 0; asks_limits() && i < std::size(kLimits); ++i)
    questions_.push_back({.kind = Kind::kLimit, .number = i});
  for (std::uint16_t i = 0; i < kMasks; ++i) questions_.push_back({.kind = Kind::kMask, .number = i});
}

std::vector<simulation::ObjectRequest> ControllerInquiry::due(std::uint64_t now_us) {
  constexpr std::uint16_t kObjects[] = {app::kVelocityLimitsObject, kValidMotionsObject,
                                        app::kMotionNameObject};
  std::vector<simulation::ObjectRequest> requests;
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    Question& question = questions_[i];
    if (question.answered || question.under_way || now_us < question.due_us) continue;
    question.under_way = true;
    requests.push_back({.number = kFirstNumber + i,
                        .node_id = sim_board::kControllerNode,
                        .address = {kObjects[static_cast<std::size_t>(question.kind)],
                                    static_cast<std::uint8_t>(question.number + 1)}});
  }
  return requests;
}

bool ControllerInquiry::take(const simulation::ObjectAnswer& answer, std::uint64_t now_us) {
  if (answer.number < kFirstNumber || answer.number - kFirstNumber >= questions_.size()) return false;
  const std::size_t index = answer.number - kFirstNumber;
  if (!questions_[index].under_way) return true;
  questions_[index].under_way = false;
  if (answer.is_lost()) {
    questions_[index].due_us = now_us + kRetry_us;
    return true;
  }
  questions_[index].answered = true;
  ++answered_;
  if (questions_[index].kind == Kind::kName) {
    questions_[index].name.assign(answer.data.begin(), std::ranges::find(answer.data, std::uint8_t{0}));
  } else if (answer.abort == canopen::AbortCode::kNone) {
    accept(Question(questions_[index]), answer.data);
  }
  return true;
}

// A limit, or a mask, which leads to questions about names.
void ControllerInquiry::accept(const Question& question, const std::vector<std::uint8_t>& data) {
  const std::uint32_t value = unsigned_of(data);
  if (question.kind == Kind::kLimit) {
    limits_.*kLimits[question.number] = static_cast<std::int16_t>(value);
    return;
  }
  for (std::uint16_t bit = 0; bit < kMaskBits; ++bit) {
    if ((value >> bit & 1u) != 0)
      questions_.push_back(
          {.kind = Kind::kName, .number = static_cast<std::uint16_t>(kMaskBits * question.number + bit)});
  }
}

std::vector<std::pair<std::uint16_t, std::string>> ControllerInquiry::motions() const {
  std::vector<std::pair<std::uint16_t, std::string>> motions;
  for (const Question& question : questions_) {
    if (!question.name.empty()) motions.emplace_back(question.number, question.name);
  }
  std::ranges::sort(motions);
  return motions;
}

}  // namespace koboshi::studio
