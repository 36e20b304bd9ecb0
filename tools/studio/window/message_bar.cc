#include "tools/studio/window/message_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QStyle>
#include <QToolButton>

namespace koboshi::studio {

MessageBar::MessageBar(QWidget* parent) : QFrame(parent), label_(new QLabel(this)) {
  setObjectName(QStringLiteral("message_bar"));
  setStyleSheet(
      QStringLiteral("#message_bar { background: #b3261e; } #message_bar QLabel { color: white; }"));
  label_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label_->setWordWrap(true);
  label_->setAccessibleName(tr("Message"));
  auto* close = new QToolButton(this);
  close->setIcon(style()->standardIcon(QStyle::SP_TitleBarCloseButton));
  close->setAutoRaise(true);
  close->setToolTip(tr("Close the message"));
  connect(close, &QToolButton::clicked, this, &QWidget::hide);
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(8, 4, 4, 4);
  layout->addWidget(label_, 1);
  layout->addWidget(close);
  hide();
}

void MessageBar::show_message(const QString& text) {
  label_->setText(text);
  show();
}

QString MessageBar::text() const { return isVisible() ? label_->text() : QString(); }

}  // namespace koboshi::studio
