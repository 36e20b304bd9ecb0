#include "sim_board/engine/tree/link_inertias.h"

#include "mechanics/vector_clones.h"

namespace koboshi::sim_board {
namespace {

using mechanics::Four;
using mechanics::Lanes;

constexpr std::size_t kX = 0;
constexpr std::size_t kY = 1;
constexpr std::size_t kZ = 2;

Eigen::Index at(std::size_t index) { return static_cast<Eigen::Index>(index); }

}  // namespace

LinkInertias::LinkInertias(std::size_t bodies, const Eigen::Vector3d& gravity_W_m_per_s2, double step_s)
    : bodies_(bodies), step_s_(step_s), groups_((bodies + Lanes::kCount - 1) / Lanes::kCount) {
  const Eigen::Vector3d falling_m_per_s = step_s * gravity_W_m_per_s2;
  for (std::size_t i = 0; i < 3; ++i) falling_m_per_s_[i] = falling_m_per_s[at(i)];
  // Lanes without a body compute something, too.
  LinkDescription none;
  none.mass_kg = 1.0;
  none.I_LCom_L.setIdentity();
  for (std::size_t body = 0; body < groups_.size() * Lanes::kCount; ++body) {
    describe(body, none);
    set(body, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
        Eigen::Vector3d::Zero());
  }
}

void LinkInertias::describe(std::size_t body, const LinkDescription& link) {
  Group& group = groups_[body / Lanes::kCount];
  const std::size_t lane = body % Lanes::kCount;
  for (std::size_t i = 0; i < 3; ++i) {
    group.mass_kg[i][lane] = link.mass_kg;
    for (std::size_t j = 0; j < 3; ++j) group.I_L[i][j][lane] = link.I_LCom_L(at(i), at(j));
  }
}

void LinkInertias::set(std::size_t body, const Eigen::Matrix3d& R_WL, const Eigen::Vector3d& p_OCom_W,
                       const Eigen::Vector3d& v_WCom_W, const Eigen::Vector3d& w_W) {
  Group& group = groups_[body / Lanes::kCount];
  const std::size_t lane = body % Lanes::kCount;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) group.R_WL[i][j][lane] = R_WL(at(i), at(j));
    group.p_OCom_W[i][lane] = p_OCom_W[at(i)];
    group.v_WCom_W[i][lane] = v_WCom_W[at(i)];
    group.w_W[i][lane] = w_W[at(i)];
  }
}

void LinkInertias::write(mechanics::JointSpace& tree) {
  for (Group& group : groups_) compute(group);
  for (std::size_t b = 0; b < bodies_; ++b) {
    const Group& group = groups_[b / Lanes::kCount];
    const std::size_t lane = b % Lanes::kCount;
    mechanics::JointSpace::Body& body = tree.body(b);
    body.inertia.mass_kg = group.mass_kg[kX][lane];
    for (std::size_t i = 0; i < 3; ++i) {
      body.inertia.moment_kg_m[at(i)] = group.moment_kg_m[i][lane];
      for (std::size_t j = 0; j < 3; ++j) body.inertia.I_O(at(i), at(j)) = group.I_O[i][j][lane];
      body.momentum[at(i)] = group.angular[i][lane];
      body.momentum[at(3 + i)] = group.linear[i][lane];
    }
  }
}

// The order of the operations is that of Eigen's products and inverse, on which the bits of a run depend:
// with registers of two doubles, it computes the first two elements of a column together, and sums their
// products from the first on; those of the third element from the last on.
KOBOSHI_VECTOR_CLONES void LinkInertias::compute(Group& g) const {
  const auto sum = [](std::size_t row, const Four& a, const Four& b, const Four& c, Lanes& result) {
    if (row < 2) {
      result.all = (a + b) + c;
    } else {
      result.all = a + (b + c);
    }
  };
  const auto apply = [&sum](const Matrix& A, const Vector& x, Vector& result) {
    for (std::size_t i = 0; i < 3; ++i)
      sum(i, A[i][0].all * x[0].all, A[i][1].all * x[1].all, A[i][2].all * x[2].all, result[i]);
  };
  // I = R I_L R'
  Matrix half;
  Matrix I;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      sum(i, g.R_WL[i][0].all * g.I_L[0][j].all, g.R_WL[i][1].all * g.I_L[1][j].all,
          g.R_WL[i][2].all * g.I_L[2][j].all, half[i][j]);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      sum(i, half[i][0].all * g.R_WL[j][0].all, half[i][1].all * g.R_WL[j][1].all,
          half[i][2].all * g.R_WL[j][2].all, I[i][j]);

  // M = I - h [L]x, and its inverse by the cofactors.
  Vector L;
  apply(I, g.w_W, L);
  Matrix M = I;
  M[0][1].all -= step_s_ * -L[kZ].all;
  M[0][2].all -= step_s_ * L[kY].all;
  M[1][0].all -= step_s_ * L[kZ].all;
  M[1][2].all -= step_s_ * -L[kX].all;
  M[2][0].all -= step_s_ * -L[kY].all;
  M[2][1].all -= step_s_ * L[kX].all;
  Matrix inverse;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      inverse[j][i].all = M[i1][j1].all * M[i2][j2].all - M[i1][j2].all * M[i2][j1].all;
    }
  }
  const Four determinant =
      (inverse[0][0].all * M[0][0].all + inverse[0][1].all * M[1][0].all) + inverse[0][2].all * M[2][0].all;
  const Four scale = 1.0 / determinant;
  for (auto& row : inverse)
    for (Lanes& element : row) element.all *= scale;

  Vector w_new;
  Vector L_new;
  apply(inverse, L, w_new);
  apply(I, w_new, L_new);
  Vector force;
  for (std::size_t i = 0; i < 3; ++i) {
    g.moment_kg_m[i].all = g.mass_kg[i].all * g.p_OCom_W[i].all;
    g.linear[i].all = g.mass_kg[i].all * (g.v_WCom_W[i].all + falling_m_per_s_[i]);
    force[i].all = L[i].all + step_s_ * ((L_new[i].all - L[i].all) / step_s_);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    g.angular[i].all =
        (g.p_OCom_W[j].all * g.linear[k].all - g.p_OCom_W[k].all * g.linear[j].all) + force[i].all;
  }
  const Four square = (g.moment_kg_m[0].all * g.p_OCom_W[0].all + g.moment_kg_m[1].all * g.p_OCom_W[1].all) +
                      g.moment_kg_m[2].all * g.p_OCom_W[2].all;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Four own = i == j ? I[i][j].all + square : I[i][j].all;
      g.I_O[i][j].all = own - g.moment_kg_m[i].all * g.p_OCom_W[j].all;
    }
}

}  // namespace koboshi::sim_board
