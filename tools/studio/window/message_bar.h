#pragma once

#include <QFrame>
#include <QString>

class QLabel;

namespace koboshi::studio {

// A line above the status bar that says what went wrong until somebody closes it; nothing is ever blocked by
// it.
class MessageBar final : public QFrame {
  Q_OBJECT

 public:
  explicit MessageBar(QWidget* parent = nullptr);
  void show_message(const QString& text);
  QString text() const;

 private:
  QLabel* const label_;
};

}  // namespace koboshi::studio
