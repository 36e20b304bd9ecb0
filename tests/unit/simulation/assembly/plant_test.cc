// A robot in the world that differs from the firmware's model.

#include "simulation/assembly/plant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/text/error.h"
#include "simulation/assembly/simulation.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

const std::string kSquat = KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml";

Scenario with(const std::vector<Override>& plant) { return read_scenario(kSquat, plant); }

TEST(Plant, ChangesTheRobotInTheWorldAndNotTheModel) {
  const Simulation as_modelled(with({}));
  const Simulation changed(with({{"plant.left_shank.mass", "80 g"},
                                 {"plant", "{left_shank.position: 0 0 -66 mm, trunk: {com: 0 0 10 mm}}"},
                                 text_override("plant.left_shank.mass", "80 g", "--plant")}));
  EXPECT_EQ(changed.model().image, as_modelled.model().image);
  const auto& links = changed.robot().links;
  const auto shank = static_cast<std::size_t>(*changed.robot().find_link("left_shank"));
  EXPECT_DOUBLE_EQ(links[shank].mass_kg, 0.08);
  EXPECT_DOUBLE_EQ(links[0].p_LCom_L.z(), 0.01);
  const auto knee = static_cast<std::size_t>(*changed.robot().find_joint("left_knee"));
  EXPECT_NEAR((changed.robot().joints[knee].p_MJ - as_modelled.robot().joints[knee].p_MJ).z(), -0.001, 1e-12);
  EXPECT_EQ(as_modelled.robot().links[shank].mass_kg, 0.05);
}

TEST(Plant, IsEmptyWhereNothingDiffers) { EXPECT_FALSE(read_plant(with({}))); }

TEST(Plant, NamesTheOptionAndTheKeyOfABadValue) {
  const auto error_of = [](const Override& plant) -> std::string {
    try {
      static_cast<void>(read_plant(with({plant})));
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(error_of(text_override("plant.left_shnk.mass", "80 g", "--plant")),
              testing::StartsWith("--plant: found left_shnk.mass, expected left_shank"));
  EXPECT_THAT(error_of(text_override("plant.left_shank.mass", "80 mm", "--plant")),
              testing::StartsWith("--plant: found "));
  EXPECT_THAT(error_of(text_override("plant.left_shank.mass", "45", "--plant")),
              testing::HasSubstr("did you mean 45 g?"));
}

}  // namespace
}  // namespace koboshi::simulation
