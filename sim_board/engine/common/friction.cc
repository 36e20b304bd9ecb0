#include "sim_board/engine/common/friction.h"

#include <algorithm>
#include <cmath>

namespace koboshi::sim_board {
namespace {

using Eigen::Vector2d;

// A smaller normal force or impulse, in N or N s, is rounding.
constexpr double kMinNormal = 1e-12;

Vector2d scales(const FrictionLaw& law) { return {law.mu, law.mu2}; }

// In scaled coordinates, M^-1 t for forces and M v for velocities, the ellipse is a disc of radius N, and t
// obeys the law if it is the point of the disc that is nearest to t - m v, for any m > 0.
Vector2d scaled_force(const FrictionLaw& law, const Vector2d& force) {
  return {force.x() / law.mu, law.is_planar() ? force.y() / law.mu2 : 0.0};
}

// t - m v in scaled coordinates.
Vector2d pull(const FrictionLaw& law, const FrictionSolution& solution, double mass) {
  const double scaled_mass = mass / (law.mu * (law.is_planar() ? law.mu2 : law.mu));
  return scaled_force(law, solution.friction) - scaled_mass * scales(law).cwiseProduct(solution.velocity);
}

}  // namespace

FrictionRows friction_rows(const FrictionLaw& law, const FrictionGuess& guess) {
  if (!law.is_planar()) return {.bounds = {law.mu * guess.normal, 0.0}};
  FrictionRows rows{.first = guess.against};
  const Vector2d M = scales(law);
  const double reach = M.cwiseProduct(rows.first).norm();
  rows.bounds = {guess.normal * reach, guess.normal * M.cwiseProduct(rows.second()).norm()};
  rows.aside = guess.normal / reach * M.cwiseProduct(rows.first).dot(M.cwiseProduct(rows.second()));
  if (guess.speed > 0.0 && guess.normal > kMinNormal) {
    const double product = law.mu * law.mu2;
    rows.softness = guess.speed * reach * reach * reach / (guess.normal * product * product);
  }
  return rows;
}

namespace {

double error_of(const FrictionLaw& law, const FrictionSolution& solution, const Vector2d& pull) {
  const double normal = std::max(solution.normal, 0.0);
  Vector2d nearest = pull;
  const double length = nearest.norm();
  if (length > normal) nearest *= normal / length;
  return (scaled_force(law, solution.friction) - nearest).norm();
}

FrictionGuess guess_of(const FrictionLaw& law, const FrictionSolution& solution, const Vector2d& pull) {
  FrictionGuess guess{.normal = std::max(solution.normal, 0.0)};
  if (!law.is_planar()) return guess;
  if (pull.norm() > guess.normal) guess.speed = solution.velocity.norm();
  const Vector2d against = pull.cwiseQuotient(scales(law));
  if (against.norm() > 0.0) guess.against = against.normalized();
  return guess;
}

}  // namespace

double friction_error(const FrictionLaw& law, const FrictionSolution& solution, double mass) {
  return error_of(law, solution, pull(law, solution, mass));
}

FrictionGuess better_guess(const FrictionLaw& law, const FrictionSolution& solution, double mass) {
  return guess_of(law, solution, pull(law, solution, mass));
}

void FrictionSearch::improve(const FrictionLaw& law, const FrictionSolution& solution, double mass,
                             FrictionGuess& guess) {
  const Vector2d force = pull(law, solution, mass);
  normal_ = std::max(normal_, solution.normal);
  error_ = std::max(error_, error_of(law, solution, force));
  guess = guess_of(law, solution, force);
}

double FrictionSearch::error() const { return error_ > kMinNormal ? error_ / normal_ : 0.0; }

}  // namespace koboshi::sim_board
