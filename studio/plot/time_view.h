#pragma once

#include <QObject>
#include <cstdint>
#include <optional>

namespace koboshi::studio {

// The common time axis of several plots: the visible range, the extent of the data, and the cursor. Times in
// microseconds.
class TimeView final : public QObject {
  Q_OBJECT

 public:
  static constexpr double kMinRange_us = 20e3;       // two ticks of the controller
  static constexpr double kFollowedRange_us = 10e6;  // of a live run, until the user zooms

  explicit TimeView(QObject* parent = nullptr);

  double from_us() const { return from_us_; }
  double to_us() const { return to_us_; }
  double range_us() const { return to_us_ - from_us_; }
  double begin_us() const { return begin_us_; }
  double end_us() const { return end_us_; }

  // Sets the extent of the data. The range moves along with the end in follow mode, and grows while it shows
  // everything.
  void set_extent(double begin_us, double end_us);
  // Shows a range, shifted and shortened to fit the data.
  void set_range(double from_us, double to_us);
  // Multiplies the range's duration, with a time that stays where it is. In follow mode that time is the end.
  void zoom(double factor, double about_us);
  // Shifts the range. Ends follow mode, unless the end stays visible.
  void pan(double by_us);
  void show_all();

  bool follows() const { return follows_; }
  void set_follow(bool follow);

  std::optional<std::uint64_t> cursor_us() const { return cursor_us_; }
  // Places the cursor. Outside of follow mode the range turns a page if the cursor leaves it or jumps; the
  // range stays if the user has moved it away from a cursor that goes on as time does.
  void set_cursor(std::uint64_t time_us);
  // The same as a deed of the user: within the data, and emits cursor_moved.
  void move_cursor(double time_us);
  void forget_cursor();

 Q_SIGNALS:
  void range_changed();
  void cursor_changed();
  void cursor_moved(std::uint64_t time_us);
  void follow_changed(bool follow);

 private:
  void place(double from_us, double range_us);

  double begin_us_ = 0.0;
  double end_us_ = 0.0;
  double from_us_ = 0.0;
  double to_us_ = kFollowedRange_us;
  bool shows_all_ = true;
  bool follows_ = false;
  double followed_us_ = kFollowedRange_us;
  std::optional<std::uint64_t> cursor_us_{};
};

}  // namespace koboshi::studio
