#include "lab/policy_search/search_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace koboshi::lab {
namespace {

TEST(Adam, MovesByTheStepSizeAtFirst) {
  SearchState state = SearchState::at({1.0, 2.0, 3.0});
  ascend(state, std::vector{0.5, -40.0, 0.0}, 0.01);
  EXPECT_NEAR(state.mean[0], 1.01, 1e-9);
  EXPECT_NEAR(state.mean[1], 1.99, 1e-9);
  EXPECT_EQ(state.mean[2], 3.0);
  EXPECT_EQ(state.steps, 1u);
  EXPECT_EQ(state.generation, 0u) << "a generation has many steps";
}

// The second step by hand, from the paper's algorithm 1.
TEST(Adam, RemembersTheSlopesBefore) {
  SearchState state = SearchState::at({0.0});
  ascend(state, std::vector{1.0}, 0.1);
  ascend(state, std::vector{-3.0}, 0.1);
  const double first = 0.9 * 0.1 + 0.1 * -3.0;
  const double second = 0.999 * 0.001 + 0.001 * 9.0;
  const double moved = first / (1.0 - 0.81) / (std::sqrt(second / (1.0 - 0.999 * 0.999)) + 1e-8);
  EXPECT_NEAR(state.mean[0], 0.1 + 0.1 * moved, 1e-9);
}

TEST(Adam, RefusesAGradientOfAnotherSize) {
  SearchState state = SearchState::at({0.0});
  EXPECT_THROW(ascend(state, std::vector{1.0, 2.0}, 0.1), std::logic_error);
}

}  // namespace
}  // namespace koboshi::lab
