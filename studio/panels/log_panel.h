#pragma once

#include <QDateTime>
#include <QString>
#include <QWidget>
#include <deque>

#include "studio/widgets/message_kind.h"

class QPlainTextEdit;

namespace koboshi::studio {

// All messages since the start of the program, with time and kind, as a text that can be copied.
class LogPanel final : public QWidget {
  Q_OBJECT

 public:
  // The oldest messages are forgotten beyond this number.
  static constexpr std::size_t kMaxMessages = 5000;

  explicit LogPanel(QWidget* parent = nullptr);
  void add(const QString& text, koboshi::studio::MessageKind kind);
  // One line for each message: time of day, kind, text.
  QString text() const;

 protected:
  void changeEvent(QEvent* event) override;

 private:
  struct Message {
    QTime time;
    MessageKind kind;
    QString text;
  };

  void append(const Message& message);
  void copy_all() const;
  void clear();

  std::deque<Message> messages_;
  QPlainTextEdit* const shown_;
};

}  // namespace koboshi::studio
