#include "lab/tune/infeasible.h"

#include <gtest/gtest.h>

namespace koboshi::lab {
namespace {

TEST(Infeasible, IsCountedByTheLimitAndNotByTheValue) {
  InfeasibleCounter counter;
  counter.add(
      {"gait.yaml", 0, "a walk that takes left_knee to 151 degrees", "0 to 150", "the limits of left_knee"});
  counter.add(
      {"gait.yaml", 0, "a walk that takes left_knee to 163 degrees", "0 to 150", "the limits of left_knee"});
  counter.add({"gait.yaml", 0, "a walk whose legs do not reach", "a lower one", "the reach of the legs"});
  counter.add({"gait.yaml", 3, "something else", "what there is"});
  EXPECT_EQ(
      infeasible_text(counter.counts(), 20),
      "4 of 20 candidates infeasible: the limits of left_knee 2, the reach of the legs 1, what there is 1\n");
  EXPECT_EQ(infeasible_text({}, 20), "");
}

}  // namespace
}  // namespace koboshi::lab
