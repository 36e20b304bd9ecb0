#pragma once

#include <QObject>
#include <QString>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "simulation/scenario/object_access.h"
#include "studio/window/motion_upload.h"

namespace koboshi::studio {

class RunController;

// Stores a motion in the controller of the simulation, by SDO over the simulated bus, and compares the CRC
// that the controller then has. It needs simulated time: while the run pauses, it waits.
class SimulatedUpload final : public QObject {
  Q_OBJECT

 public:
  // Numbers of its requests, above those of ControllerInquiry.
  static constexpr std::uint64_t kFirstNumber = std::uint64_t{16} << 40;

  // The run must outlive this object.
  explicit SimulatedUpload(RunController& run, QObject* parent = nullptr);

  // `motions`: number and name of those that the controller has. The motion gets the number of one with its
  // name, or else the lowest free one. An upload under way is forgotten. Throws std::runtime_error if no
  // number is free.
  void start(MotionImage image, const std::vector<std::pair<std::uint16_t, std::string>>& motions);

 Q_SIGNALS:
  // The controller has the motion, at this time of the run.
  void done(const koboshi::studio::UploadedMotion& motion, std::uint64_t time_us);
  void failed(const QString& reason);

 private:
  void take_answer(const simulation::ObjectAnswer& answer);

  RunController& run_;
  std::optional<UploadedMotion> under_way_;
  std::uint32_t crc32_ = 0;
  std::uint64_t last_request_ = kFirstNumber;  // reads the CRC; the one before writes the motion
};

}  // namespace koboshi::studio
