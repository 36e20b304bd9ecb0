#pragma once

#include <QStringList>
#include <QVariant>
#include <vector>

#include "studio/plot/run_samples.h"
#include "studio/plot/trace_painter.h"

namespace koboshi::studio {

// The signals of each row of plots, by name. Names that a recording lacks stay for the next recording.
using PlotRows = std::vector<QStringList>;

// Returns the rows of a new user that the recording has: the commanded and true joint positions of one leg,
// the trunk's pitch and roll, and the ZMP. If it has none of them, its first signals.
PlotRows default_rows(const RunSamples& samples);

// Returns the traces of a row. Commanded and planned values are dashed, in the colour of what is measured
// against them. The planned, measured and true ZMP have the colours of their marks (view/render/looks.h) as
// far as a plot has them, and so have one quantity of the left and of the right side; the replay page does
// the same (seriesOf in format.js).
std::vector<Trace> traces_of(const RunSamples& samples, const QStringList& names);

// Rows as a value for QSettings. Anything else than rows gives no rows.
QVariant rows_to_variant(const PlotRows& rows);
PlotRows rows_of_variant(const QVariant& variant);

}  // namespace koboshi::studio
