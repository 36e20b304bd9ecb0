#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace koboshi::sim {

// Finds Coulomb's law as the fixed point of a sequence of convex contact problems.
//
// MuJoCo's problem puts the forces into the friction cone and the velocities into its dual, v_n >= mu |v_t|:
// a foot that slides would take off. Coulomb's law is the same with v_n + mu |v_t| in place of v_n (de Saxce
// and Feng, "The bipotential method", 1998). So each contact's normal target is lowered by a lift s, the
// problem is solved, and s is sought with s = F(s), F_i = mu_i |v_t,i| of the solution (Acary, Cadoux,
// Lemarechal and Malick, "A formulation of the linear discrete Coulomb friction problem via convex
// optimization", 2011; a solution exists wherever every contact can be opened).
//
// Why s <- F(s) is not enough. One contact that slides along t has, with its inverse inertia W at the point
// (W_nt > 0 where friction presses the contact into the ground) and D = W_nn - 2 mu W_nt + mu^2 W_tt > 0,
//   F'(s) = 1 - (W_nn - mu W_nt) / D.
// This is below 1 unless mu W_nt >= W_nn, Painleve's paradox, so that there is one fixed point. But it is
// below -1 where 3 mu W_nt > W_nn + 2 mu^2 W_tt, as of a leaning shank or a head: then the iteration
// alternates between a contact that is off, hardly slides and so asks for a small lift, and one that is
// struck, slides fast and asks for a lift that turns it off. The step omega = 1 / (1 - F') of s <- s + omega
// (F - s) ends at the fixed point at once. Aitken's formula finds omega from the last two residuals, for
// several contacts one by their vectors (Irons and Tuck, "A version of the Aitken accelerator for computer
// iteration", 1969). For one contact it is the secant method.
//
// Coupled contacts can defeat it. What is left then is made safe: the last repeats only lower lifts that are
// above their F. That sequence falls and is bounded by zero, so it converges, and in its limit s <= F. This
// suffices that no contact sinks: the dual cone has v_n + s >= target + F, so v_n >= target. What remains of
// the error parts the surfaces by F - s, as MuJoCo's own relaxation does by F.
class LiftIteration {
 public:
  static constexpr double kTolerance_m_per_s = 0.002;  // a contact off by this hops by a micrometre or less
  static constexpr int kMaxSolutions = 32;

  explicit LiftIteration(std::size_t max_contacts);

  // Starts a step with these lifts, by contact: mu |v_t| of the step before. At most max_contacts.
  void begin(std::span<const double> lifts_m_per_s);
  // The lifts to solve the contacts with.
  std::span<const double> lifts_m_per_s() const { return {lifts_.data(), count_}; }
  // Takes F of the solution with them. True when the step is over; otherwise the lifts have changed.
  bool is_over(std::span<const double> slips_m_per_s);
  // Whether all lifts agree with their slips.
  bool settled() const { return settled_; }

 private:
  static constexpr int kAitkenSolutions = 12;

  void relax();
  void lower();

  std::size_t count_ = 0;
  int solutions_ = 0;
  double omega_ = 1.0;
  bool settled_ = true;
  std::vector<double> lifts_;
  std::vector<double> residuals_;  // F - s
  std::vector<double> last_residuals_;
};

}  // namespace koboshi::sim
