#include "studio/panels/log_panel.h"

#include <QClipboard>
#include <QEvent>
#include <QGuiApplication>
#include <QHBoxLayout>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "studio/widgets/message_style.h"

namespace koboshi::studio {

LogPanel::LogPanel(QWidget* parent) : QWidget(parent), shown_(new QPlainTextEdit(this)) {
  shown_->setObjectName(QStringLiteral("log"));
  shown_->setReadOnly(true);
  shown_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  shown_->setMaximumBlockCount(static_cast<int>(kMaxMessages));
  shown_->setFrameShape(QFrame::NoFrame);
  shown_->setPlaceholderText(tr("No messages so far"));
  shown_->setAccessibleName(tr("Log of messages"));
  auto* copy = new QPushButton(tr("Copy all"), this);
  copy->setObjectName(QStringLiteral("copy_log"));
  copy->setToolTip(tr("Copies all messages to the clipboard, one in a line"));
  connect(copy, &QPushButton::clicked, this, &LogPanel::copy_all);
  auto* forget = new QPushButton(tr("Clear"), this);
  forget->setObjectName(QStringLiteral("clear_log"));
  forget->setToolTip(tr("Forgets all messages so far"));
  connect(forget, &QPushButton::clicked, this, &LogPanel::clear);
  auto* buttons = new QVBoxLayout;
  buttons->addWidget(copy);
  buttons->addWidget(forget);
  buttons->addStretch(1);
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addWidget(shown_, 1);
  layout->addLayout(buttons);
}

void LogPanel::add(const QString& text, MessageKind kind) {
  messages_.push_back({QTime::currentTime(), kind, text.simplified()});
  if (messages_.size() > kMaxMessages) messages_.pop_front();
  append(messages_.back());
}

void LogPanel::append(const Message& message) {
  shown_->appendHtml(QStringLiteral("%1 <b style=\"color:%2\">%3</b> %4")
                         .arg(message.time.toString(QStringLiteral("HH:mm:ss")),
                              colour_of(message.kind, palette()).name(), word_of(message.kind),
                              message.text.toHtmlEscaped()));
}

QString LogPanel::text() const { return shown_->toPlainText(); }

void LogPanel::copy_all() const { QGuiApplication::clipboard()->setText(text() + u'\n'); }

void LogPanel::clear() {
  messages_.clear();
  shown_->clear();
}

void LogPanel::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() != QEvent::PaletteChange) return;
  shown_->clear();
  for (const Message& message : messages_) append(message);
}

}  // namespace koboshi::studio
