#pragma once

#include <QFrame>
#include <QString>
#include <functional>
#include <vector>

class QHBoxLayout;
class QLabel;

namespace koboshi::studio {

// A bar that tells the user something and offers what can be done about it. It waits for an answer without
// blocking the window.
class OfferBar final : public QFrame {
  Q_OBJECT

 public:
  struct Choice {
    QString text = {};
    std::function<void()> act = {};  // may be empty; the bar is hidden before
  };

  explicit OfferBar(QWidget* parent = nullptr);
  void offer(const QString& text, std::vector<Choice> choices);

 private:
  QHBoxLayout* row_;
  QLabel* icon_;
  QLabel* text_;
  std::vector<QWidget*> buttons_;
};

}  // namespace koboshi::studio
