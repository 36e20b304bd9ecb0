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

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void update_icons();
  void update_state();
  void update_slider();

  RunController& run_;
  // Null while the bar is made.
  QAction* play_ = nullptr;
  QAction* tick_ = nullptr;
  QAction* rewind_ = nullptr;
  QComboBox* speed_;
  QSlider* slider_;
  QLabel* time_;
};

}  // namespace koboshi::studio
