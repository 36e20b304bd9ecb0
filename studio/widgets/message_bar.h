#pragma once

#include <QFrame>
#include <QString>
#include <QTimer>

#include "studio/widgets/message_kind.h"

class QLabel;

namespace koboshi::studio {

// A line above the status bar with the last message, in the colour and with the sign of its kind. Warnings
// and errors stay until somebody closes them; nothing is ever blocked by them. All messages go to the log.
class MessageBar final : public QFrame {
  Q_OBJECT

 public:
  // Set by hand (2026-11-25): a success is read in this time, and the log keeps it.
  static constexpr int kShown_ms = 8000;

  explicit MessageBar(QWidget* parent = nullptr);
  void show_message(const QString& text, koboshi::studio::MessageKind kind);
  void show_error(const QString& text) { show_message(text, MessageKind::kError); }
  // The message that is shown; empty: none.
  QString text() const;
  MessageKind kind() const { return kind_; }

 Q_SIGNALS:
  void told(const QString& text, koboshi::studio::MessageKind kind);

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void apply_style();

  MessageKind kind_ = MessageKind::kInformation;
  QLabel* const icon_;
  QLabel* const word_;
  QLabel* const label_;
  QTimer timer_;  // of a message that goes by itself
};

}  // namespace koboshi::studio
