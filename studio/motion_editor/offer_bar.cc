#include "studio/motion_editor/offer_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>

#include "studio/widgets/step_icons.h"

namespace koboshi::studio {

OfferBar::OfferBar(QWidget* parent) : QFrame(parent) {
  setFrameShape(QFrame::StyledPanel);
  setAutoFillBackground(true);
  setBackgroundRole(QPalette::AlternateBase);
  row_ = new QHBoxLayout(this);
  row_->setContentsMargins(8, 3, 4, 3);
  icon_ = new QLabel(this);
  text_ = new QLabel(this);
  row_->addWidget(icon_);
  row_->addWidget(text_, 1);
  hide();
}

void OfferBar::offer(const QString& text, std::vector<Choice> choices) {
  for (QWidget* const button : buttons_) button->deleteLater();
  buttons_.clear();
  icon_->setPixmap(severity_icon(simulation::Severity::kWarning, palette()).pixmap(16, 16));
  text_->setText(text);
  for (Choice& choice : choices) {
    auto* const button = new QPushButton(choice.text, this);
    button->setObjectName(choice.text);
    connect(button, &QPushButton::clicked, this, [this, act = std::move(choice.act)] {
      hide();
      if (act) act();
    });
    row_->addWidget(button);
    buttons_.push_back(button);
  }
  show();
}

}  // namespace koboshi::studio
