#pragma once

#include <Eigen/Core>
#include <array>

namespace koboshi::sim_board {

// Coulomb's friction of a contact point, for solvers whose rows have constant bounds.
//
// With the normal force N, the friction t in the contact plane and M = diag(mu, mu2) along the two friction
// directions, the law is
//   |M^-1 t| <= N,  and  t = -N M^2 v / |M v|  if the point slides with the velocity v:
// of all forces on the ellipse, the one that dissipates the most (Goyal, Ruina and Papadopoulos, "Planar
// sliding with dry friction", 1991). N, and the direction of v, are unknown before the solution. The rows of
// a point are therefore derived from a guess, and the step is solved again with a better one until the law
// holds. Forces may be impulses throughout.
struct FrictionLaw {
  double mu = 0.0;
  double mu2 = 0.0;  // 0: no force along the second direction, and only one row

  bool is_planar() const { return mu2 > 0.0; }
};

// The state of the contact point of which the rows are the linearisation.
struct FrictionGuess {
  double normal = 0.0;
  Eigen::Vector2d against = Eigen::Vector2d::UnitX();  // unit vector against the sliding velocity
  double speed = 0.0;                                  // of sliding; 0: the point sticks
};

// Two rows along perpendicular directions. The first one, against the sliding, has the force of sliding as
// its bound: the line that touches the ellipse there. Along the second direction, which is the tangent of the
// ellipse, the law is linear to first order: the force changes with the direction of the velocity, like that
// of a viscous damper. A square of such bounds becomes the ellipse when it is turned to the force.
struct FrictionRows {
  Eigen::Vector2d first = Eigen::Vector2d::UnitX();
  std::array<double, 2> bounds{};  // of the forces' magnitudes
  double aside = 0.0;              // the second row's force while the point slides as guessed
  // Softness of the second row: velocity + softness * force = target().
  double softness = 0.0;
  double target() const { return softness * aside; }

  Eigen::Vector2d second() const { return {-first.y(), first.x()}; }
};

// The solution at a contact point.
struct FrictionSolution {
  double normal = 0.0;
  Eigen::Vector2d friction = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // after the step
};

FrictionRows friction_rows(const FrictionLaw& law, const FrictionGuess& guess);

// Distance of the solution from the law, as a share of the normal force's unit: 0.01 means that the friction
// is wrong by 0.01 mu newtons. `mass` in kg (of impulses) or kg/s (of forces) is that of the body at the
// point approximately; it weighs velocities against forces.
double friction_error(const FrictionLaw& law, const FrictionSolution& solution, double mass);

// The guess that the solution suggests.
FrictionGuess better_guess(const FrictionLaw& law, const FrictionSolution& solution, double mass);

// Improves the guesses of all contact points of one solution, and finds how far it is from the law.
class FrictionSearch {
 public:
  void improve(const FrictionLaw& law, const FrictionSolution& solution, double mass, FrictionGuess& guess);
  // Largest error of a contact point so far, relative to the largest normal force. Infinite if there is
  // friction but no normal force.
  double error() const;

 private:
  double error_ = 0.0;
  double normal_ = 0.0;  // never negative
};

}  // namespace koboshi::sim_board
