#include "studio/widgets/message_bar.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QStyle>
#include <QToolButton>

#include "studio/widgets/message_style.h"

namespace koboshi::studio {

MessageBar::MessageBar(QWidget* parent)
    : QFrame(parent), icon_(new QLabel(this)), word_(new QLabel(this)), label_(new QLabel(this)) {
  setObjectName(QStringLiteral("message_bar"));
  setAutoFillBackground(true);
  setFrameShape(QFrame::Box);
  icon_->setObjectName(QStringLiteral("message_icon"));
  word_->setObjectName(QStringLiteral("message_kind"));
  QFont bold = word_->font();
  bold.setBold(true);
  word_->setFont(bold);
  label_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label_->setTextFormat(Qt::PlainText);
  label_->setWordWrap(true);
  label_->setAccessibleName(tr("Message"));
  auto* close = new QToolButton(this);
  close->setIcon(style()->standardIcon(QStyle::SP_TitleBarCloseButton));
  close->setAutoRaise(true);
  close->setToolTip(tr("Close the message; the panel Messages keeps it"));
  connect(close, &QToolButton::clicked, this, &QWidget::hide);
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(8, 4, 4, 4);
  layout->addWidget(icon_);
  layout->addWidget(word_);
  layout->addWidget(label_, 1);
  layout->addWidget(close);
  timer_.setSingleShot(true);
  timer_.setInterval(kShown_ms);
  connect(&timer_, &QTimer::timeout, this, &QWidget::hide);
  hide();
}

void MessageBar::show_message(const QString& text, MessageKind kind) {
  kind_ = kind;
  label_->setText(text);
  word_->setText(word_of(kind));
  apply_style();
  const bool goes = kind == MessageKind::kSuccess || kind == MessageKind::kInformation;
  goes ? timer_.start() : timer_.stop();
  show();
  Q_EMIT told(text, kind);
}

QString MessageBar::text() const { return isVisible() ? label_->text() : QString(); }

// The frame has the colour of the kind as well: it is the palette's text of the frame alone.
void MessageBar::apply_style() {
  const QPalette base = parentWidget() != nullptr ? parentWidget()->palette() : QPalette();
  constexpr int kIcon_px = 16;
  icon_->setPixmap(icon_of(kind_, base).pixmap(kIcon_px, kIcon_px));
  QPalette own = base;
  own.setColor(QPalette::Window, background_of(kind_, base));
  own.setColor(QPalette::WindowText, base.color(QPalette::Text));
  if (own.color(QPalette::Window) == palette().color(QPalette::Window)) return;
  setPalette(own);
}

void MessageBar::changeEvent(QEvent* event) {
  QFrame::changeEvent(event);
  if (event->type() == QEvent::ApplicationPaletteChange) apply_style();
}

}  // namespace koboshi::studio
