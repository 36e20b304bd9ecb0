#include "mechanics/joint_space.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "sim_board/engine/tree/tree_solver.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::sim_board {
namespace {

using mechanics::JointSpace;
using mechanics::spatial;
using mechanics::spatial_force;
using mechanics::SpatialInertia;
using mechanics::Vector6;
using mechanics::velocity_at;

Vector6 random_vector(RandomStream& random) {
  Vector6 vector;
  for (double& value : vector) value = random.within(1.0);
  return vector;
}

// A random tree: bodies of 0.1 kg to 1.1 kg, joints of one to three axes in general position, with servos.
class RandomTree {
 public:
  explicit RandomTree(std::uint64_t seed, std::size_t bodies = 8) : random_(seed, "tree") {
    std::vector<JointSpace::Joint> joints;
    for (std::size_t b = 1; b < bodies; ++b)
      joints.push_back({random_.bits() % b, b, 1 + random_.bits() % 3});
    joints_ = joints;
    solver_.emplace(bodies, joints);
    for (std::size_t b = 0; b < bodies; ++b) {
      Eigen::Matrix3d root;
      for (double& value : root.reshaped()) value = random_.within(0.1);
      const Vector6 place = random_vector(random_);
      tree().body(b) = {SpatialInertia(0.1 + random_.uniform(), place.head<3>(),
                                       root * root.transpose() + 1e-3 * Eigen::Matrix3d::Identity()),
                        random_vector(random_)};
    }
    for (std::size_t j = 0; j < joints.size(); ++j) {
      tree().slip(j) = 0.1 * random_vector(random_);
      for (std::size_t i = 0; i < joints[j].axes; ++i)
        tree().axis(tree().first_dof(j) + i) = {random_vector(random_), random_.uniform(),
                                                random_.within(1.0)};
    }
  }

  JointSpace& tree() { return solver_->tree(); }
  TreeSolver& solver() { return *solver_; }
  const std::vector<JointSpace::Joint>& joints() const { return joints_; }
  RandomStream& random() { return random_; }

 private:
  RandomStream random_;
  std::vector<JointSpace::Joint> joints_;
  std::optional<TreeSolver> solver_;
};

Eigen::Matrix<double, 6, 6> matrix_of(const SpatialInertia& inertia) {
  Eigen::Matrix<double, 6, 6> matrix;
  for (Eigen::Index i = 0; i < 6; ++i) matrix.col(i) = inertia * Vector6::Unit(i);
  return matrix;
}

// The reference: all bodies and joints in one dense system in the bodies' velocities v, the joints' impulses
// P and the speeds u. Nothing is projected or eliminated.
//   I_b v_b - P of its joint + sum of P of the joints behind = momentum + impulse
//   v_child - v_parent - S u = slip,   S' P + damping u = drive
struct Reference {
  std::vector<Vector6> velocities;
  std::vector<Vector6> joint_impulses;
};

Reference solve_densely(RandomTree& random, bool fixed_root, const std::vector<Vector6>& impulses) {
  JointSpace& tree = random.tree();
  const auto place = [](std::size_t number) { return static_cast<Eigen::Index>(6 * number); };
  const std::size_t bodies = tree.bodies();
  const Eigen::Index joints_at = place(bodies);
  const Eigen::Index speeds_at = joints_at + place(random.joints().size()) - 6;  // the root has no joint
  const Eigen::Index size =
      joints_at + place(random.joints().size()) + static_cast<Eigen::Index>(tree.dofs()) - 6;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  const Eigen::Matrix<double, 6, 6> one = Eigen::Matrix<double, 6, 6>::Identity();
  for (std::size_t b = 0; b < bodies; ++b) {
    system.block<6, 6>(place(b), place(b)) = matrix_of(tree.body(b).inertia);
    right.segment<6>(place(b)) = tree.body(b).momentum + impulses[b];
  }
  for (std::size_t j = 0; j < random.joints().size(); ++j) {
    const JointSpace::Joint& joint = random.joints()[j];
    const Eigen::Index row = joints_at + place(j);
    system.block<6, 6>(place(joint.child), row) = -one;
    system.block<6, 6>(place(joint.parent), row) = one;
    system.block<6, 6>(row, place(joint.child)) = one;
    system.block<6, 6>(row, place(joint.parent)) = -one;
    right.segment<6>(row) = tree.slip(j);
    for (std::size_t i = 0; i < joint.axes; ++i) {
      const std::size_t dof = tree.first_dof(j) + i;
      const Eigen::Index speed = speeds_at + static_cast<Eigen::Index>(dof);
      system.block<6, 1>(row, speed) = -tree.axis(dof).motion;
      system.block<1, 6>(speed, row) = tree.axis(dof).motion.transpose();
      system(speed, speed) = tree.axis(dof).damping;
      right(speed) = tree.axis(dof).drive;
    }
  }
  if (fixed_root) {
    system.topRows<6>().setZero();
    system.topLeftCorner<6, 6>() = one;
    right.head<6>().setZero();
  }
  const Eigen::VectorXd solution = system.fullPivLu().solve(right);
  Reference reference;
  for (std::size_t b = 0; b < bodies; ++b) reference.velocities.push_back(solution.segment<6>(place(b)));
  for (std::size_t j = 0; j < random.joints().size(); ++j)
    reference.joint_impulses.push_back(solution.segment<6>(joints_at + place(j)));
  return reference;
}

void expect_equal(RandomTree& random, const Reference& reference) {
  for (std::size_t b = 0; b < random.tree().bodies(); ++b)
    EXPECT_LT((random.tree().velocity(b) - reference.velocities[b]).norm(), 1e-9) << "body " << b;
  for (std::size_t j = 0; j < random.joints().size(); ++j)
    EXPECT_LT((random.tree().joint_impulse(j) - reference.joint_impulses[j]).norm(), 1e-9) << "joint " << j;
}

class TreeOnRoot : public testing::TestWithParam<bool> {};

TEST_P(TreeOnRoot, MovesAsTheDenseSystemOfItsBodiesAndJoints) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    RandomTree random(seed);
    random.tree().fix_root(GetParam());
    const std::vector<Vector6> none(random.tree().bodies(), Vector6::Zero());
    ASSERT_TRUE(random.tree().factorise());
    random.tree().solve();
    random.tree().find_joint_impulses(none);
    expect_equal(random, solve_densely(random, GetParam(), none));
  }
}

TreeRow random_row(RandomTree& random, int body, int other_body) {
  TreeRow row{.body = body, .other_body = other_body};
  row.jacobian = random_vector(random.random());
  if (other_body >= 0) row.other_jacobian = random_vector(random.random());
  row.target = random.random().within(1.0);
  row.softness = 0.1;
  return row;
}

// The impulses that the solver finds are put into the dense system; there the rows must have their targets.
void expect_rows_met(RandomTree& random, bool fixed_root) {
  const std::vector<TreeRow>& rows = random.solver().rows();
  ASSERT_TRUE(random.solver().solve());
  random.solver().find_joint_impulses();
  std::vector<Vector6> impulses(random.tree().bodies(), Vector6::Zero());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    impulses[static_cast<std::size_t>(rows[r].body)] += random.solver().impulse(r) * rows[r].jacobian;
    if (rows[r].other_body >= 0)
      impulses[static_cast<std::size_t>(rows[r].other_body)] +=
          random.solver().impulse(r) * rows[r].other_jacobian;
  }
  const Reference reference = solve_densely(random, fixed_root, impulses);
  expect_equal(random, reference);
  for (std::size_t r = 0; r < rows.size(); ++r)
    EXPECT_NEAR(rows[r].speed(reference.velocities) + rows[r].softness * random.solver().impulse(r),
                rows[r].target, 1e-9);
}

TEST_P(TreeOnRoot, MeetsRowsByTheImpulsesItReports) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    RandomTree random(seed);
    random.tree().fix_root(GetParam());
    for (int r = 0; r < 4; ++r)
      random.solver().rows().push_back(random_row(random, 1 + r, r % 2 == 0 ? -1 : 6));
    expect_rows_met(random, GetParam());
  }
}

// Rows on the same bodies are treated four at a time: here in groups of one to four and of more, with bodies
// on one branch and on two.
TEST_P(TreeOnRoot, MeetsManyRowsOnTheSameBodies) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    RandomTree random(seed);
    random.tree().fix_root(GetParam());
    for (const int count : {6, 1, 4, 3, 9}) {
      const int body = static_cast<int>(random.random().bits() % 8);
      const int other = static_cast<int>(random.random().bits() % 9) - 1;
      for (int r = 0; r < count; ++r)
        random.solver().rows().push_back(random_row(random, body, other == body ? -1 : other));
    }
    expect_rows_met(random, GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(, TreeOnRoot, testing::Bool(),
                         [](const auto& info) { return info.param ? "Fixed" : "Free"; });

TEST(JointSpace, RejectsABodyWithoutInertia) {
  JointSpace tree(1, {});
  EXPECT_FALSE(tree.factorise());
}

// A body that falls and slides on a plane: one contact row along z, two of friction. Friction presses the
// corner into the plane, so that the normal impulse is larger than without it.
class SlidingPoint : public testing::Test {
 protected:
  SlidingPoint() {
    JointSpace::Body& body = solver.tree().body(0);
    body.inertia = SpatialInertia(2.0, Eigen::Vector3d::Zero(), 0.01 * Eigen::Matrix3d::Identity());
    row(Eigen::Vector3d::UnitZ());
    solver.rows()[0].lower = 0.0;
    row(Eigen::Vector3d::UnitX());
    row(Eigen::Vector3d::UnitY());
  }
  void row(const Eigen::Vector3d& direction) {
    solver.rows().push_back({.jacobian = spatial_force(corner, direction)});
  }
  void solve(const FrictionLaw& law, const Eigen::Vector3d& momentum) {
    solver.tree().body(0).momentum = spatial(Eigen::Vector3d::Zero(), momentum);
    solver.frictions() = {{.normal_row = 0, .law = law, .guess = {}}};
    ASSERT_TRUE(solver.solve());
    EXPECT_TRUE(solver.settled());
  }
  Eigen::Vector2d friction() const { return {solver.impulse(1), solver.impulse(2)}; }
  Eigen::Vector3d velocity() const { return velocity_at(solver.tree().velocity(0), corner); }

  const Eigen::Vector3d corner{0.03, 0.0, -0.04};
  TreeSolver solver{1, {}};
};

TEST_F(SlidingPoint, HasMuTimesTheFinalNormalImpulseAgainstItsVelocity) {
  for (int again = 0; again < 2; ++again) {  // from no start, and from the solution
    solve({0.5, 0.5}, {6.0, 2.0, -2.0});
    EXPECT_NEAR(friction().norm(), 0.5 * solver.impulse(0), 1e-4);
    EXPECT_GT(velocity().head<2>().norm(), 0.1);
    EXPECT_LT((friction().normalized() + velocity().head<2>().normalized()).norm(), 1e-3);
    EXPECT_NEAR(velocity().z(), 0.0, 1e-12);
  }
}

TEST_F(SlidingPoint, SticksWithinTheDisc) {
  solve({0.5, 0.5}, {0.1, 0.1, -2.0});
  EXPECT_LT(velocity().norm(), 1e-12);
  EXPECT_LT(friction().norm(), 0.5 * solver.impulse(0));
}

TEST_F(SlidingPoint, HasOneRowOfFrictionAlongGrooves) {
  solver.rows().pop_back();
  solve({0.5, 0.0}, {6.0, 2.0, -2.0});
  EXPECT_NEAR(solver.impulse(1), -0.5 * solver.impulse(0), 1e-4);
  EXPECT_NEAR(solver.tree().velocity(0)[4], 1.0, 1e-12);  // nothing slows it across
}

}  // namespace
}  // namespace koboshi::sim_board
