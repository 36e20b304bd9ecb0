#include "base/table/table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace koboshi {
namespace {

TEST(CsvLine, QuotesCellsWithSeparatorsQuotesAndLineBreaks) {
  EXPECT_EQ(csv_line({"plain text", "a, b", "", "say \"no\"", "two\nlines"}),
            "plain text,\"a, b\",,\"say \"\"no\"\"\",\"two\nlines\"\n");
}

TEST(CsvCells, ReadsBackWhatCsvLineWrites) {
  for (const Row& row :
       {Row{"plain text", "a, b", "", "say \"no\"", "\"", "two\nlines"}, Row{""}, Row{"", ""}})
    EXPECT_EQ(csv_cells(csv_line(row)), row);
}

TEST(CsvCell, RoundTripsNumbersAndIsEmptyForNaN) {
  EXPECT_EQ(csv_cell(0.1), "0.1");
  EXPECT_EQ(csv_cell(std::nan("")), "");
}

TEST(TableText, AlignsColumnsForATerminal) {
  EXPECT_EQ(table_text({"name", "value"}, {{"a", "1"}, {"longer", "22.5"}}, TableStyle::kTerminal),
            "name    value\n"
            "a           1\n"
            "longer   22.5\n");
}

TEST(TableText, WritesMarkdownAndCsv) {
  EXPECT_EQ(table_text({"name", "value"}, {{"a, b", "1"}}, TableStyle::kMarkdown),
            "| name | value |\n| --- | ---: |\n| a, b | 1 |\n");
  EXPECT_EQ(table_text({"name", "value"}, {{"a, b", "1"}}, TableStyle::kCsv), "name,value\n\"a, b\",1\n");
}

}  // namespace
}  // namespace koboshi
