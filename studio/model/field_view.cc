#include "studio/model/field_view.h"

#include <QHeaderView>
#include <QPalette>
#include <QScrollBar>
#include <QStyle>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/text.h"
#include "sim_board/description/edit/field_value.h"
#include "studio/model/field_labels.h"

namespace koboshi::studio {
namespace {

enum Role { kKeyRole = Qt::UserRole + 1, kTypedRole };

QString qt_text(const std::string& text) { return QString::fromStdString(text); }

QString range_text(const sim_board::ModelField& field) {
  const NumberRange& range = field.range();
  const auto end = [&](double value) -> QString {
    if (std::abs(value) >= NumberRange().max) return QStringLiteral("∞");
    return qt_text(sim_board::shown_text(field, koboshi::number_text(value)));
  };
  if (field.numbers() == 0 && field.content() != XmlContent::kInteger)
    return qt_text(field.choices().empty() ? "" : join_alternatives(field.choices()));
  if (range.min <= -NumberRange().max && range.max >= NumberRange().max) return {};
  return end(range.min) + QStringLiteral(" … ") + end(range.max);
}

QString tip_of(const sim_board::ModelField& field) {
  QStringList parts;
  if (!field.note().meaning.empty()) parts << qt_text(field.note().meaning);
  parts << FieldView::tr("Path: %1").arg(qt_text(field.path));
  if (field.value)
    parts << FieldView::tr("In the file: %1")
                 .arg(qt_text(*field.value + (field.unit() == "1" ? "" : " " + field.unit())));
  parts << FieldView::tr("Permitted: %1").arg(qt_text(field.expected()));
  if (!field.fallback().empty()) parts << FieldView::tr("Default: %1").arg(qt_text(field.fallback()));
  if (!field.note().source.empty()) parts << FieldView::tr("Source: %1").arg(qt_text(field.note().source));
  return parts.join(QLatin1Char('\n'));
}

}  // namespace

FieldView::FieldView(QWidget* parent) : QTreeView(parent), model_(new QStandardItemModel(0, kColumns, this)) {
  model_->setHorizontalHeaderLabels({tr("Value of"), tr("Value"), tr("Unit"), tr("Range")});
  setModel(model_);
  setUniformRowHeights(true);
  setAlternatingRowColors(true);
  setIndentation(12);
  setEditTriggers(DoubleClicked | EditKeyPressed | AnyKeyPressed | SelectedClicked);
  setAccessibleName(tr("Values"));
  header()->setStretchLastSection(true);
  const int digit = fontMetrics().horizontalAdvance(QLatin1Char('0'));
  header()->resizeSection(kName, 18 * digit);
  header()->resizeSection(kValue, 15 * digit);
  header()->resizeSection(kUnit, 8 * digit);
  connect(model_, &QStandardItemModel::itemChanged, this, &FieldView::take_edit);
  const auto keep_state = [this](const QModelIndex& index, bool open) {
    if (!filling_) open_[model_->itemFromIndex(index)->text()] = open;
  };
  connect(this, &QTreeView::expanded, this,
          [keep_state](const QModelIndex& index) { keep_state(index, true); });
  connect(this, &QTreeView::collapsed, this,
          [keep_state](const QModelIndex& index) { keep_state(index, false); });
}

void FieldView::show_element(const ModelDocument& document, const QString& element) {
  const bool is_same = element == element_;
  const QString chosen = currentIndex().siblingAtColumn(kValue).data(kKeyRole).toString();
  const int scrolled = verticalScrollBar()->value();
  filling_ = true;
  element_ = element;
  fields_ = document.fields(element.toStdString());
  std::vector<QStandardItem*> titles;
  for (const Group& group : groups_of(document)) titles.push_back(group_item(document, group));
  if (is_same && has_rows(titles)) {
    for (std::size_t i = 0; i < titles.size(); ++i)
      update_rows(*model_->item(static_cast<int>(i)), *titles[i]);
    for (const QStandardItem* title : titles) delete title;
    filling_ = false;
    return;
  }
  model_->removeRows(0, model_->rowCount());
  for (QStandardItem* title : titles) add_group(title);
  filling_ = false;
  if (!is_same) return scrollToTop();
  choose(chosen);
  verticalScrollBar()->setValue(scrolled);
}

// Whether the model has rows for the same values and findings.
bool FieldView::has_rows(const std::vector<QStandardItem*>& titles) const {
  if (model_->rowCount() != static_cast<int>(titles.size())) return false;
  for (std::size_t i = 0; i < titles.size(); ++i) {
    const QStandardItem& shown = *model_->item(static_cast<int>(i));
    if (shown.text() != titles[i]->text() || shown.rowCount() != titles[i]->rowCount()) return false;
    for (int row = 0; row < shown.rowCount(); ++row) {
      const QStandardItem* value = shown.child(row, kValue);
      const QStandardItem* wanted = titles[i]->child(row, kValue);
      if ((value == nullptr) != (wanted == nullptr)) return false;
      if (value != nullptr && value->data(kKeyRole) != wanted->data(kKeyRole)) return false;
    }
  }
  return true;
}

// Editors of other values stay open.
void FieldView::update_rows(QStandardItem& shown, const QStandardItem& wanted) {
  constexpr std::array<int, 6> kRoles{Qt::DisplayRole,    Qt::ToolTipRole, Qt::FontRole,
                                      Qt::ForegroundRole, kKeyRole,        kTypedRole};
  for (int row = 0; row < shown.rowCount(); ++row)
    for (int column = 0; column < kColumns; ++column) {
      QStandardItem* to = shown.child(row, column);
      const QStandardItem* from = wanted.child(row, column);
      if (to == nullptr || from == nullptr) continue;
      for (const int role : kRoles)
        if (to->data(role) != from->data(role)) to->setData(from->data(role), role);
    }
}

// An element below the shown one is a group if it has values of its own; other values belong to the shown
// one.
std::vector<FieldView::Group> FieldView::groups_of(const ModelDocument& document) const {
  std::vector<Group> groups;
  for (const sim_board::ModelField& field : fields_) {
    if (!is_shown(field)) continue;
    const QString title = qt_text(group_of(field));
    auto found = std::ranges::find(groups, title, &Group::title);
    if (found == groups.end()) {
      sim_board::ModelField owner = field;
      owner.steps.resize(has_inner_group(field) ? 2 : 1);
      const auto path = owner.element_path(document.xml());
      groups.push_back({title, path ? document.xml().find(*path)->line : 0});
      found = groups.end() - 1;
    }
    found->fields.push_back(&field);
  }
  return groups;
}

QStandardItem* FieldView::group_item(const ModelDocument& document, const Group& group) const {
  auto* title = new QStandardItem(group.title);
  QFont bold = font();
  bold.setBold(true);
  title->setFont(bold);
  title->setEditable(false);
  for (const tools::ModelFinding& finding : document.report().findings)
    if (finding.line == group.line && group.line > 0) title->appendRow(finding_item(finding));
  for (const sim_board::ModelField* field : group.fields) title->appendRow(row_of(*field));
  return title;
}

// A group with a finding is open.
void FieldView::add_group(QStandardItem* title) {
  model_->appendRow(title);
  setFirstColumnSpanned(title->row(), {}, true);
  bool has_findings = false;
  for (int row = 0; row < title->rowCount(); ++row) {
    if (title->child(row, kValue) != nullptr) continue;
    setFirstColumnSpanned(row, title->index(), true);
    has_findings = true;
  }
  const auto open = open_.find(title->text());
  const bool is_look = title->text().startsWith(QLatin1String("visual"));
  setExpanded(title->index(), has_findings || (open == open_.end() ? !is_look : open->second));
}

QStandardItem* FieldView::finding_item(const tools::ModelFinding& finding) const {
  const QString text = tr("%1: found %2, expected %3.")
                           .arg(qt_text(finding.code), qt_text(finding.found), qt_text(finding.expected));
  auto* item = new QStandardItem(style()->standardIcon(QStyle::SP_MessageBoxWarning), text);
  item->setToolTip((text + QLatin1Char('\n') + qt_text(finding.repair)).trimmed());
  item->setEditable(false);
  return item;
}

QList<QStandardItem*> FieldView::row_of(const sim_board::ModelField& field) const {
  auto* name = new QStandardItem(qt_text(label_of(field)));
  const bool is_missing = !field.value;
  const std::string value = field.value.value_or(field.fallback());
  // A unit other than the file's stands in the text that is edited: a number without one is in the file's.
  const std::string unit = sim_board::shown_unit(field);
  const bool is_converted = !unit.empty() && unit != field.unit();
  auto* shown =
      new QStandardItem(qt_text(sim_board::shown_text(field, value) + (is_converted ? " " + unit : "")));
  shown->setData(qt_text(field.key()), kKeyRole);
  shown->setData(shown->text(), kTypedRole);
  if (is_missing) {
    QFont italic = font();
    italic.setItalic(true);
    shown->setFont(italic);
    shown->setForeground(palette().color(QPalette::Disabled, QPalette::Text));
  }
  QList<QStandardItem*> row{name, shown, new QStandardItem(qt_text(unit)),
                            new QStandardItem(range_text(field))};
  for (QStandardItem* item : row) {
    item->setToolTip(tip_of(field));
    item->setEditable(item == shown);
  }
  return row;
}

void FieldView::take_edit(QStandardItem* item) {
  if (filling_ || !item->data(kKeyRole).isValid()) return;
  const QString typed = item->text().trimmed();
  const QString before = item->data(kTypedRole).toString();
  if (typed == before) return;
  filling_ = true;
  item->setText(before);
  filling_ = false;
  // Later: the edit replaces the rows, which the delegate still uses.
  const QString key = item->data(kKeyRole).toString();
  QMetaObject::invokeMethod(
      this, [this, key, typed] { Q_EMIT edited(key, typed); }, Qt::QueuedConnection);
}

QModelIndex FieldView::choose(const QString& path) {
  for (const sim_board::ModelField& field : fields_) {
    if (qt_text(field.path) != path && qt_text(field.key()) != path) continue;
    for (int group = 0; group < model_->rowCount(); ++group)
      for (int row = 0; row < model_->item(group)->rowCount(); ++row) {
        const QModelIndex index = model_->index(row, kValue, model_->item(group)->index());
        if (index.data(kKeyRole).toString() != qt_text(field.key())) continue;
        setCurrentIndex(index);
        scrollTo(index);
        horizontalScrollBar()->setValue(0);  // the names
        return index;
      }
  }
  return {};
}

}  // namespace koboshi::studio
