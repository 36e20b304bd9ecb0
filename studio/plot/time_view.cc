#include "studio/plot/time_view.h"

#include <algorithm>
#include <cmath>

namespace koboshi::studio {
namespace {

constexpr double kJump_us = 0.5e6;  // more than the time between two pictures of a run

}  // namespace

TimeView::TimeView(QObject* parent) : QObject(parent) {}

// Shows range_us from from_us, within the data. A followed range may be longer than the data: it then fills
// from the left.
void TimeView::place(double from_us, double range_us) {
  const double longest_us = std::max(end_us_ - begin_us_, follows_ ? followed_us_ : kMinRange_us);
  range_us = std::clamp(range_us, kMinRange_us, longest_us);
  from_us = std::clamp(from_us, begin_us_, std::max(begin_us_, end_us_ - range_us));
  if (from_us == from_us_ && from_us + range_us == to_us_) return;
  from_us_ = from_us;
  to_us_ = from_us + range_us;
  Q_EMIT range_changed();
}

void TimeView::set_extent(double begin_us, double end_us) {
  begin_us_ = begin_us;
  end_us_ = std::max(begin_us, end_us);
  if (follows_) {
    place(end_us_ - followed_us_, followed_us_);
  } else if (shows_all_) {
    place(begin_us_, end_us_ - begin_us_);
  } else {
    place(from_us_, range_us());
  }
}

void TimeView::set_range(double from_us, double to_us) {
  shows_all_ = to_us - from_us >= end_us_ - begin_us_;
  followed_us_ = std::max(to_us - from_us, kMinRange_us);
  set_follow(follows_ && to_us >= end_us_);
  place(from_us, to_us - from_us);
}

void TimeView::zoom(double factor, double about_us) {
  if (follows_) {
    followed_us_ =
        std::clamp(factor * range_us(), kMinRange_us, std::max(kFollowedRange_us, end_us_ - begin_us_));
    place(end_us_ - followed_us_, followed_us_);
    return;
  }
  const double range =
      std::clamp(factor * range_us(), kMinRange_us, std::max(kMinRange_us, end_us_ - begin_us_));
  const double share = (about_us - from_us_) / range_us();
  set_range(about_us - share * range, about_us + (1.0 - share) * range);
}

void TimeView::pan(double by_us) {
  if (follows_ && by_us < 0.0) set_follow(false);
  if (follows_) return;
  shows_all_ = shows_all_ && range_us() >= end_us_ - begin_us_;
  place(from_us_ + by_us, range_us());
}

void TimeView::show_all() {
  set_follow(false);
  set_range(begin_us_, end_us_);
}

void TimeView::set_follow(bool follow) {
  if (follow == follows_) return;
  follows_ = follow;
  if (follow) {
    followed_us_ = shows_all_ ? kFollowedRange_us : range_us();
    shows_all_ = false;
    place(end_us_ - followed_us_, followed_us_);
  }
  Q_EMIT follow_changed(follow);
}

void TimeView::set_cursor(std::uint64_t time_us) {
  if (cursor_us_ == time_us) return;
  const auto time = static_cast<double>(time_us);
  const double before = cursor_us_ ? static_cast<double>(*cursor_us_) : -kJump_us;
  const bool was_shown = before >= from_us_ && before <= to_us_;
  const bool jumps = time < before || time >= before + kJump_us;
  cursor_us_ = time_us;
  // The cursor reappears at a tenth of the range from the side at which it left.
  if (!follows_ && (was_shown || jumps) && (time < from_us_ || time > to_us_))
    place(time < from_us_ ? time - 0.9 * range_us() : time - 0.1 * range_us(), range_us());
  Q_EMIT cursor_changed();
}

void TimeView::move_cursor(double time_us) {
  const double time = std::clamp(time_us, begin_us_, end_us_);
  if (follows_ && time < end_us_) set_follow(false);  // otherwise the next sample would carry the time away
  set_cursor(static_cast<std::uint64_t>(std::llround(std::max(0.0, time))));
  Q_EMIT cursor_moved(*cursor_us_);
}

void TimeView::forget_cursor() {
  cursor_us_.reset();
  Q_EMIT cursor_changed();
}

}  // namespace koboshi::studio
