#include "studio/plot/signal_list.h"

#include <QHeaderView>
#include <QMimeData>
#include <QVBoxLayout>
#include <map>
#include <string>

#include "studio/plot/plot_style.h"

namespace koboshi::studio {
namespace {

std::string group_of(const std::string& name) {
  const std::size_t end = name.find_last_of("_./");
  return end == std::string::npos ? std::string() : name.substr(0, end);
}

QList<QStandardItem*> row_of(const view::Signal& signal) {
  auto* name = new QStandardItem(QString::fromStdString(signal.name));
  name->setData(name->text(), SignalModel::kNameRole);
  auto* unit =
      new QStandardItem(signal.names.empty() ? shown_unit(signal.unit, 1.0).text : SignalModel::tr("state"));
  unit->setData(name->text(), SignalModel::kNameRole);
  return {name, unit};
}

}  // namespace

SignalModel::SignalModel(QObject* parent) : QStandardItemModel(parent) {}

void SignalModel::set_signals(std::span<const view::Signal> signals) {
  clear();
  setHorizontalHeaderLabels({tr("Signal"), tr("Unit")});
  std::map<std::string, int> sizes;
  for (const view::Signal& signal : signals) ++sizes[group_of(signal.name)];
  std::map<std::string, QStandardItem*> groups;
  for (const view::Signal& signal : signals) {
    const std::string group = group_of(signal.name);
    if (group.empty() || sizes[group] < 2) {
      invisibleRootItem()->appendRow(row_of(signal));
      continue;
    }
    QStandardItem*& item = groups[group];
    if (item == nullptr) {
      item = new QStandardItem(QString::fromStdString(group));
      invisibleRootItem()->appendRow({item, new QStandardItem});
    }
    item->appendRow(row_of(signal));
  }
  for (int row = 0; row < rowCount(); ++row)
    for (int column = 0; column < columnCount(); ++column)
      if (item(row, column) != nullptr) item(row, column)->setEditable(false);
}

QStringList SignalModel::mimeTypes() const { return {QLatin1String(kSignalMimeType)}; }

QMimeData* SignalModel::mimeData(const QModelIndexList& indexes) const {
  QStringList names;
  const auto add = [&names](const QString& name) {
    if (!name.isEmpty() && !names.contains(name)) names << name;
  };
  for (const QModelIndex& index : indexes) {
    add(index.data(kNameRole).toString());
    if (index.column() != 0) continue;
    for (int row = 0; row < rowCount(index); ++row)
      add(this->index(row, 0, index).data(kNameRole).toString());
  }
  auto* data = new QMimeData;
  data->setData(QLatin1String(kSignalMimeType), names.join(QLatin1Char('\n')).toUtf8());
  return data;
}

QStringList dragged_signals(const QMimeData& data) {
  return QString::fromUtf8(data.data(QLatin1String(kSignalMimeType)))
      .split(QLatin1Char('\n'), Qt::SkipEmptyParts);
}

SignalList::SignalList(QWidget* parent)
    : QWidget(parent),
      search_(new QLineEdit(this)),
      tree_(new QTreeView(this)),
      model_(new SignalModel(this)),
      proxy_(new QSortFilterProxyModel(this)) {
  search_->setPlaceholderText(tr("Search signals"));
  search_->setAccessibleName(search_->placeholderText());
  search_->setClearButtonEnabled(true);
  tree_->setAccessibleName(tr("Signals"));
  proxy_->setSourceModel(model_);
  proxy_->setRecursiveFilteringEnabled(true);
  proxy_->setAutoAcceptChildRows(true);
  proxy_->setFilterCaseSensitivity(Qt::CaseInsensitive);
  tree_->setModel(proxy_);
  tree_->setDragEnabled(true);
  tree_->setDragDropMode(QAbstractItemView::DragOnly);
  tree_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  tree_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  tree_->setUniformRowHeights(true);
  tree_->setToolTip(tr("Drag signals into a plot. A double click or Enter adds them."));
  tree_->header()->setStretchLastSection(false);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(2);
  layout->addWidget(search_);
  layout->addWidget(tree_);
  connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
    proxy_->setFilterFixedString(text);
    if (text.isEmpty()) {
      tree_->collapseAll();
    } else {
      tree_->expandAll();
    }
  });
  connect(tree_, &QTreeView::activated, this, &SignalList::choose);
}

void SignalList::set_signals(std::span<const view::Signal> signals) {
  model_->set_signals(signals);
  tree_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
  tree_->header()->setSectionResizeMode(1, QHeaderView::ResizeToContents);
  if (!search_->text().isEmpty()) tree_->expandAll();
}

void SignalList::choose(const QModelIndex& index) {
  const QString name = index.data(SignalModel::kNameRole).toString();
  if (!name.isEmpty()) Q_EMIT chosen({name});
}

}  // namespace koboshi::studio
