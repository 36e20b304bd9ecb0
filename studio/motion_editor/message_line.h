#pragma once

#include <QIcon>
#include <QWidget>

#include "studio/motion_editor/motion_editor.h"

class QLabel;
class QToolButton;

namespace koboshi::studio {

// The last line of the panel: an error, or one of the findings, and what the check says about the whole
// motion. A click leads to the step.
class MessageLine final : public QWidget {
  Q_OBJECT

 public:
  explicit MessageLine(MotionEditor& editor, QWidget* parent = nullptr);

  // Shows an error until the next edit or selection.
  void show_error(const QString& text);
  // Shows a piece of news in the same place.
  void show_note(const QString& text);
  // Shows the first finding of the row, if it has one.
  void show_row(std::size_t row);
  void show_next(int step);  // 1 or -1
  QString text() const { return full_text_; }
  // The check's verdict about the whole motion.
  QString verdict() const;

 Q_SIGNALS:
  void row_wanted(std::size_t row);

 protected:
  void changeEvent(QEvent* event) override;
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void refresh();
  void present(const QString& text, const QIcon& icon, const QString& tip);
  void elide();

  MotionEditor& editor_;
  std::size_t shown_ = 0;  // index of the finding
  QString own_text_;       // an error or a note; empty: the finding is shown
  bool own_is_error_ = false;
  QString full_text_;
  QToolButton* message_;
  QLabel* count_;
  QToolButton* previous_;
  QToolButton* next_;
  QLabel* verdict_;
};

}  // namespace koboshi::studio
