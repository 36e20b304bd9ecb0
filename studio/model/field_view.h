#pragma once

#include <QStandardItemModel>
#include <QString>
#include <QTreeView>
#include <map>
#include <string>
#include <vector>

#include "studio/model/model_document.h"

namespace koboshi::studio {

// The values of one body, joint or type of servo with unit and range, by their groups in the file. A group
// with a finding shows it beside its name; a value shows its default while the file lacks it.
class FieldView final : public QTreeView {
  Q_OBJECT

 public:
  enum Column { kName, kValue, kUnit, kRange, kColumns };

  explicit FieldView(QWidget* parent = nullptr);

  // Shows an element of a document; an unknown one shows nothing. Which groups are open, the chosen row and
  // the scroll bar stay while the element is the same.
  void show_element(const ModelDocument& document, const QString& element);
  // Chooses the value of a field, by its path; returns the index of the value, invalid: there is none.
  QModelIndex choose(const QString& path);

 Q_SIGNALS:
  // The user has typed a value; it is shown again as it was unless the document changes.
  void edited(const QString& key, const QString& typed);

 private:
  struct Group {
    QString title{};
    int line = 0;  // of its element
    std::vector<const sim_board::ModelField*> fields{};
  };

  std::vector<Group> groups_of(const ModelDocument& document) const;
  QStandardItem* group_item(const ModelDocument& document, const Group& group) const;
  QStandardItem* finding_item(const tools::ModelFinding& finding) const;
  void add_group(QStandardItem* title);
  bool has_rows(const std::vector<QStandardItem*>& titles) const;
  static void update_rows(QStandardItem& shown, const QStandardItem& wanted);
  QList<QStandardItem*> row_of(const sim_board::ModelField& field) const;
  void take_edit(QStandardItem* item);

  QStandardItemModel* const model_;
  QString element_;
  std::vector<sim_board::ModelField> fields_;
  std::map<QString, bool> open_;  // by title of a group
  bool filling_ = false;
};

}  // namespace koboshi::studio
