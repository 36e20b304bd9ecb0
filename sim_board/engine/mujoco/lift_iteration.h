#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace koboshi::sim_board {

// Solves Coulomb's law as the fixed point of a sequence of convex contact problems.
//
// MuJoCo's problem has forces in the friction cone and velocities in its dual, v_n >= mu |v_t|, so a sliding
// foot would lift off. Coulomb's law is the same with v_n + mu |v_t| in place of v_n (de Saxce and Feng, "The
// bipotential method", 1998). The iteration therefore lowers each contact's normal target by a lift s, solves
// the problem, and seeks s = F(s) with F_i = mu_i |v_t,i| of the solution (Acary, Cadoux, Lemarechal and
// Malick, "A formulation of the linear discrete Coulomb friction problem via convex optimization", 2011; a
// solution exists if every contact can open).
//
// The simple iteration s <- F(s) can diverge. For one contact that slides along t, with inverse inertia W at
// the point (W_nt > 0 if friction presses the contact into the ground) and D = W_nn - 2 mu W_nt + mu^2 W_tt >
// 0,
//   F'(s) = 1 - (W_nn - mu W_nt) / D.
// This is below 1 unless mu W_nt >= W_nn (Painleve's paradox), so the fixed point is unique. But it is below
// -1 if 3 mu W_nt > W_nn + 2 mu^2 W_tt, for example at a leaning shank or a head. The iteration then
// alternates between an open contact, which hardly slides and gives a small lift, and a closed one, which
// slides fast and gives a lift that opens it. The relaxation s <- s + omega (F - s) with omega = 1 / (1 - F')
// reaches the fixed point in one step. Aitken's formula estimates omega from the last two residuals, with
// their vectors for several contacts (Irons and Tuck, "A version of the Aitken accelerator for computer
// iteration", 1969). For one contact it is the secant method.
//
// Coupled contacts may prevent convergence. The last iterations therefore only lower lifts that are above
// their F. This sequence decreases and is bounded by zero, so it converges, and in its limit s <= F. No
// contact then sinks: the dual cone has v_n + s >= target + F, so v_n >= target. The remaining error
// separates the surfaces with F - s, as MuJoCo's own relaxation does with F.
class LiftIteration {
 public:
  static constexpr double kTolerance_m_per_s = 0.002;  // a contact with this error lifts by at most a
                                                       // micrometre
  static constexpr int kMaxSolutions = 32;

  explicit LiftIteration(std::size_t max_contacts);

  // Starts a step with these lifts by contact: mu |v_t| of the previous step. At most max_contacts.
  void begin(std::span<const double> lifts_m_per_s);
  // Lifts for the next solution.
  std::span<const double> lifts_m_per_s() const { return {lifts_.data(), count_}; }
  // Processes F of the solution with these lifts. Returns true if the step is finished; otherwise the lifts
  // have changed.
  bool is_over(std::span<const double> slips_m_per_s);
  // Returns whether all lifts agree with their slips.
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

}  // namespace koboshi::sim_board
