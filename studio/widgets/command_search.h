#pragma once

#include <QLineEdit>
#include <QList>

class QAction;
class QStandardItemModel;

namespace koboshi::studio {

// A field that finds actions by any part of their texts and triggers the chosen one.
class CommandSearch final : public QLineEdit {
  Q_OBJECT

 public:
  explicit CommandSearch(QWidget* parent = nullptr);
  // Offers these actions, each with its menu and shortcut. The actions outlive the field.
  void set_actions(const QList<QAction*>& actions);
  QSize sizeHint() const override;

 private:
  void trigger(const QString& text);

  QStandardItemModel* const model_;
  QList<QAction*> actions_;
};

// The text of an action without mnemonics.
QString plain_text(const QAction& action);

}  // namespace koboshi::studio
