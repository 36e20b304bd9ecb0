#include "studio/document/neighbours.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

using Neighbours = std::vector<std::size_t>;

// Rows of the sample: 0 stand, 1 wait, 2 loop, 3 wave, 4 stand, 5 if, 6 low, 7 call, 8 jump, 9 label; of the
// routine 10 and 11.
TEST(NeighbouringMoves, AreTheNearestFirst) {
  const auto document = document_of();
  const auto around = [&](std::size_t row, std::size_t before, std::size_t after) {
    return neighbouring_moves(document->rows(), row, before, after);
  };
  EXPECT_EQ(around(4, 5, 5).before, (Neighbours{3, 0}));
  EXPECT_EQ(around(4, 5, 5).after, (Neighbours{6}));
  EXPECT_EQ(around(0, 5, 2).after, (Neighbours{3, 4}));
  EXPECT_TRUE(around(0, 5, 0).before.empty());
  EXPECT_EQ(around(9, 1, 5).before, (Neighbours{6}));
  EXPECT_EQ(around(10, 5, 5).after, (Neighbours{11}));
  EXPECT_TRUE(around(99, 5, 5).before.empty());
}

// On the side of `else`, those of `then` are not neighbours.
TEST(NeighbouringMoves, AreOnOneSideOfABranch) {
  const auto document = document_of(with("- {call: nod}", "- {pose: wave, time_s: 1}"));
  const MotionRows& rows = document->rows();
  ASSERT_TRUE(rows.rows[7].in_else);
  EXPECT_EQ(neighbouring_moves(rows, 7, 1, 1).before, (Neighbours{4}));
  EXPECT_EQ(neighbouring_moves(rows, 4, 0, 5).after, (Neighbours{6}));
  EXPECT_EQ(neighbouring_moves(rows, 6, 5, 5).after, Neighbours());
}

}  // namespace
}  // namespace koboshi::studio
