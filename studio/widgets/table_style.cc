#include "studio/widgets/table_style.h"

#include <QHeaderView>
#include <QTableView>

namespace koboshi::studio {

void style_table(QTableView& table, const QString& name, std::initializer_list<int> widths) {
  constexpr int kSpace_px = 6;  // between the lines
  table.setSelectionBehavior(QAbstractItemView::SelectRows);
  table.setWordWrap(false);
  table.setAlternatingRowColors(true);
  table.verticalHeader()->hide();
  table.verticalHeader()->setDefaultSectionSize(table.fontMetrics().height() + kSpace_px);
  table.horizontalHeader()->setStretchLastSection(true);
  table.setAccessibleName(name);
  const int digit_px = table.fontMetrics().horizontalAdvance(QLatin1Char('0'));
  int column = 0;
  for (const int digits : widths) table.setColumnWidth(column++, digits * digit_px);
}

}  // namespace koboshi::studio
