#include "tools/robot_file/check/repairs.h"
#include "mechanics/axes.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

Eigen::Vector3d moments_of(const Eigen::Matrix3d& inertia) {
  return mechanics::principal_inertia(inertia).moments;
}

bool is_rigid(const Eigen::Vector3d& m) {
  return m.minCoeff() > 0.0 && 2.0 * m.maxCoeff() <= m.sum() * (1.0 + 1e-9);
}

TEST(NearestInertia, IsThatOfARigidBodyAndNoOtherIsNearer) {
  constexpr unsigned kSeed = 20261124;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    Eigen::Matrix3d inertia = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
    inertia = (inertia + inertia.transpose()).eval();
    const auto nearest = nearest_inertia(inertia);
    if (!nearest) continue;
    const Eigen::Vector3d moments = moments_of(*nearest);
    EXPECT_TRUE(2.0 * moments.maxCoeff() <= moments.sum() * (1.0 + 1e-3)) << kSeed << " " << i;
    EXPECT_GT(moments.minCoeff(), 0.0);
    // Rigid bodies near the result are not nearer, but for the thinnest moment that the reader wants.
    const double distance = (*nearest - inertia).norm();
    for (int other = 0; other < 50; ++other) {
      const Eigen::Vector3d changed =
          moments + 0.2 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
      if (!is_rigid(changed)) continue;
      const Eigen::Matrix3d axes = mechanics::principal_inertia(*nearest).axes;
      const Eigen::Matrix3d rigid = axes * changed.asDiagonal() * axes.transpose();
      EXPECT_GT((rigid - inertia).norm(), distance - 2e-3 * inertia.norm()) << kSeed << " " << i;
    }
  }
}

TEST(NearestInertia, KeepsAValidOne) {
  const Eigen::Matrix3d box = Eigen::Vector3d(2.0, 3.0, 4.0).asDiagonal();
  EXPECT_LT((*nearest_inertia(box) - box).norm(), 1e-9);
  EXPECT_FALSE(nearest_inertia(Eigen::Matrix3d::Zero()));
  EXPECT_FALSE(nearest_inertia(-box));
}

TEST(NearestValue, StaysInTheRange) {
  const NumberRange range{.min = 0.5, .max = 9};
  EXPECT_EQ(nearest_value("10 1", XmlContent::kNumbers, 2, range, {}), "9 1");
  EXPECT_EQ(nearest_value("-3", XmlContent::kNumbers, 1, range, {}), "3");
  EXPECT_EQ(nearest_value("1,5", XmlContent::kNumbers, 1, range, {}), "1.5");
  EXPECT_EQ(nearest_value("3.7", XmlContent::kInteger, 1, range, {}), "4");
  EXPECT_EQ(nearest_value("lefd", XmlContent::kText, 1, {}, {"left", "right"}), "left");
  EXPECT_EQ(nearest_value("heavy", XmlContent::kNumbers, 1, range, {}), std::nullopt);
  EXPECT_EQ(nearest_value("1", XmlContent::kNumbers, 2, range, {}), std::nullopt);
  EXPECT_EQ(nearest_value("", XmlContent::kText, 1, {}, {}), std::nullopt);
}

TEST(UnitVectorText, HasTheLengthOne) {
  EXPECT_EQ(unit_vector_text({0, 0, -2}), "0 0 -1");
  EXPECT_EQ(unit_vector_text({0.6, 0.9, 0}), "0.5547 0.83205 0");
  EXPECT_EQ(unit_vector_text({0, 0, 0}), std::nullopt);
}

TEST(NearestFile, LooksInTheFolderOfThePath) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "meshes");
  test::write_file(folder.path / "meshes" / "servo.stl", "");
  test::write_file(folder.path / "meshes" / "horn.stl", "");
  EXPECT_EQ(nearest_file(folder.path, "meshes/sevro.stl"), "meshes/servo.stl");
  EXPECT_EQ(nearest_file(folder.path, "meshes/trunk_frame.stl"), std::nullopt);
  EXPECT_EQ(nearest_file(folder.path, "shapes/servo.stl"), std::nullopt);
}

}  // namespace
}  // namespace koboshi::tools
