#include "studio/motion_editor/message_line.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>
#include <algorithm>

#include "base/text/user_units.h"
#include "studio/widgets/colours.h"
#include "studio/widgets/step_icons.h"

namespace koboshi::studio {

using simulation::Severity;

MessageLine::MessageLine(MotionEditor& editor, QWidget* parent) : QWidget(parent), editor_(editor) {
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(4, 1, 8, 1);
  message_ = new QToolButton(this);
  message_->setAutoRaise(true);
  message_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  message_->installEventFilter(this);
  message_->setObjectName(QStringLiteral("message"));
  message_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  count_ = new QLabel(this);
  previous_ = new QToolButton(this);
  previous_->setArrowType(Qt::UpArrow);
  previous_->setAutoRaise(true);
  previous_->setToolTip(tr("Previous finding (Shift+F8)"));
  next_ = new QToolButton(this);
  next_->setArrowType(Qt::DownArrow);
  next_->setAutoRaise(true);
  next_->setToolTip(tr("Next finding (F8)"));
  verdict_ = new QLabel(this);
  verdict_->setObjectName(QStringLiteral("verdict"));
  verdict_->setToolTip(
      tr("Result of the check: balance, and the least distance of ZMP or centre of mass from the\n"
         "edge of the support polygon in mm, positive inside"));
  row->addWidget(message_, 1);
  for (QWidget* const widget : std::initializer_list<QWidget*>{count_, previous_, next_, verdict_})
    row->addWidget(widget);
  connect(previous_, &QToolButton::clicked, this, [this] { show_next(-1); });
  connect(next_, &QToolButton::clicked, this, [this] { show_next(1); });
  connect(message_, &QToolButton::clicked, this, [this] {
    const auto& findings = editor_.findings();
    if (own_text_.isEmpty() && shown_ < findings.size() && findings[shown_].row)
      Q_EMIT row_wanted(*findings[shown_].row);
  });
  connect(&editor, &MotionEditor::changed, this, [this] {
    own_text_.clear();
    refresh();
  });
  connect(&editor, &MotionEditor::findings_changed, this, &MessageLine::refresh);
  connect(&editor, &MotionEditor::failed, this, &MessageLine::show_error);
}

void MessageLine::show_error(const QString& text) {
  own_text_ = text;
  own_is_error_ = true;
  refresh();
}

void MessageLine::show_note(const QString& text) {
  own_text_ = text;
  own_is_error_ = false;
  refresh();
}

void MessageLine::show_row(std::size_t row) {
  own_text_.clear();
  const auto& findings = editor_.findings();
  const auto found = std::ranges::find(findings, std::optional(row), &RowFinding::row);
  if (found != findings.end()) shown_ = static_cast<std::size_t>(found - findings.begin());
  refresh();
}

void MessageLine::show_next(int step) {
  const auto count = static_cast<int>(editor_.findings().size());
  if (count == 0) return;
  own_text_.clear();
  shown_ = static_cast<std::size_t>((static_cast<int>(shown_) + step + count) % count);
  refresh();
  if (editor_.findings()[shown_].row) Q_EMIT row_wanted(*editor_.findings()[shown_].row);
}

QString MessageLine::verdict() const {
  if (!editor_.is_open()) return {};
  if (editor_.is_checking()) return tr("checking…");
  if (editor_.document().compiled() == nullptr) return tr("has errors");
  const CheckResult* const result = editor_.checked();
  if (result == nullptr || !result->error.empty()) return {};
  const QString duration = tr("%1 s").arg(result->duration_s, 0, 'f', 2);
  if (!result->is_judged) return tr("balance not judged, %1").arg(duration);
  return tr("%1, margin %2 mm at %3 s of %4")
      .arg(QString::fromStdString(result->balance))
      .arg(result->least_margin_m * kMmPerM, 0, 'f', 1)
      .arg(result->least_margin_s, 0, 'f', 2)
      .arg(duration);
}

void MessageLine::refresh() {
  const auto& findings = editor_.findings();
  if (shown_ >= findings.size()) shown_ = 0;
  count_->setText(findings.empty() ? QString() : tr("%1 of %2").arg(shown_ + 1).arg(findings.size()));
  previous_->setVisible(findings.size() > 1);
  next_->setVisible(findings.size() > 1);
  verdict_->setText(verdict());
  const auto icon = [this](Severity severity) { return severity_icon(severity, palette()); };
  if (!own_text_.isEmpty()) {
    present(own_text_, icon(own_is_error_ ? Severity::kError : Severity::kNote), own_text_);
  } else if (!findings.empty()) {
    const RowFinding& finding = findings[shown_];
    const QString where = finding.row ? tr("step %1: ").arg(*finding.row + 1) : QString();
    present(finding.code + u' ' + where + finding.text, icon(finding.severity),
            finding.hint.isEmpty() ? finding.text : finding.text + u'\n' + finding.hint);
  } else if (editor_.is_open() && editor_.checked() != nullptr && !editor_.is_checking()) {
    present(tr("No findings"), good_icon(palette()), {});
  } else {
    present({}, {}, {});
  }
}

void MessageLine::present(const QString& text, const QIcon& icon, const QString& tip) {
  full_text_ = text;
  message_->setToolTip(tip);
  message_->setIcon(icon);
  elide();
}

void MessageLine::elide() {
  const int width = message_->width() - 32;
  message_->setText(message_->fontMetrics().elidedText(full_text_, Qt::ElideRight, width));
}

bool MessageLine::eventFilter(QObject* watched, QEvent* event) {
  if (watched == message_ && event->type() == QEvent::Resize) elide();
  return QWidget::eventFilter(watched, event);
}

void MessageLine::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange && editor_.is_open()) refresh();
}

}  // namespace koboshi::studio
