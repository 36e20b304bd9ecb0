#pragma once

#include <QToolBar>

class QAction;
class QComboBox;
class QLabel;
class QSlider;

namespace koboshi::studio {

class RunController;

// Start, pause, single steps, speed, rewind, and the slider of the cursor.
class TransportBar final : public QToolBar {
  Q_OBJECT

 public:
  // The controller must outlive the bar.
  explicit TransportBar(RunController& run, QWidget* parent = nullptr);

 private:
  void update_state();
  void update_slider();

  RunController& run_;
  QAction* play_;
  QAction* tick_;
  QAction* rewind_;
  QComboBox* speed_;
  QSlider* slider_;
  QLabel* time_;
};

}  // namespace koboshi::studio
