#pragma once

#include <QString>
#include <initializer_list>

class QTableView;

namespace koboshi::studio {

// Gives a table the look of all tables of the studio: whole rows, narrow lines, no vertical header, the last
// column as wide as the rest. `widths` are those of the first columns, in digits of the font; `name` is for
// screen readers. To be called after setModel().
void style_table(QTableView& table, const QString& name, std::initializer_list<int> widths = {});

}  // namespace koboshi::studio
