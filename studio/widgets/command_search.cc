#include "studio/widgets/command_search.h"

#include <QAction>
#include <QCompleter>
#include <QStandardItemModel>

namespace koboshi::studio {

QString plain_text(const QAction& action) {
  QString text = action.text();
  text.remove(QLatin1Char('&'));
  return text;
}

CommandSearch::CommandSearch(QWidget* parent) : QLineEdit(parent), model_(new QStandardItemModel(this)) {
  setPlaceholderText(tr("Search commands (Ctrl+K)"));
  setClearButtonEnabled(true);
  setAccessibleName(tr("Command search"));
  auto* completer = new QCompleter(model_, this);
  completer->setFilterMode(Qt::MatchContains);
  completer->setCaseSensitivity(Qt::CaseInsensitive);
  completer->setMaxVisibleItems(12);
  setCompleter(completer);
  connect(completer, qOverload<const QString&>(&QCompleter::activated), this, &CommandSearch::trigger,
          Qt::QueuedConnection);
}

// A menu bar gives its corner this width: the placeholder's, with room for the button that clears the text.
QSize CommandSearch::sizeHint() const {
  const int width = fontMetrics().horizontalAdvance(placeholderText()) + 3 * fontMetrics().height();
  return {width, QLineEdit::sizeHint().height()};
}

void CommandSearch::set_actions(const QList<QAction*>& actions) {
  actions_ = actions;
  model_->clear();
  for (const QAction* action : actions_) {
    QString text = plain_text(*action);
    if (!action->shortcut().isEmpty())
      text += QStringLiteral("   ") + action->shortcut().toString(QKeySequence::NativeText);
    model_->appendRow(new QStandardItem(text));
  }
}

void CommandSearch::trigger(const QString& text) {
  for (int row = 0; row < model_->rowCount(); ++row) {
    if (model_->item(row)->text() != text) continue;
    clear();
    clearFocus();
    actions_[row]->trigger();
    return;
  }
}

}  // namespace koboshi::studio
