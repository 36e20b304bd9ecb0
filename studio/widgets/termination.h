#pragma once

#include <QObject>
#include <functional>

namespace koboshi::studio {

// Lets SIGTERM, SIGINT and SIGHUP end the program in order: calls a function in the event loop. A second
// signal ends the process at once, as without this object.
class Termination final : public QObject {
 public:
  // `end` gets the signal's number.
  explicit Termination(std::function<void(int)> end);
  ~Termination() override;

 private:
  void read_signal();

  const std::function<void(int)> end_;
};

}  // namespace koboshi::studio
