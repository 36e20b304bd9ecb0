#include "sim_board/engine/ode/saved_bodies.h"

#include <algorithm>

namespace koboshi::sim_board {
namespace {

template <std::size_t kSize>
void copy(const dReal* from, std::array<dReal, kSize>& to) {
  std::copy_n(from, kSize, to.begin());
}

// ODE's setters of quaternion and rotation normalise their argument and compute the other from it, which
// changes the last bits. The arrays are members of a non-const body, so writing to them is permitted.
template <std::size_t kSize>
void write(const std::array<dReal, kSize>& from, const dReal* to) {
  std::ranges::copy(from, const_cast<dReal*>(to));
}

}  // namespace

void SavedBodies::save(std::span<const OdeBody> bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const dBodyID body = bodies[i].get();
    copy(dBodyGetPosition(body), bodies_[i].position);
    copy(dBodyGetQuaternion(body), bodies_[i].quaternion);
    copy(dBodyGetRotation(body), bodies_[i].rotation);
    copy(dBodyGetLinearVel(body), bodies_[i].velocity);
    copy(dBodyGetAngularVel(body), bodies_[i].rate);
    copy(dBodyGetForce(body), bodies_[i].force);
    copy(dBodyGetTorque(body), bodies_[i].torque);
  }
}

void SavedBodies::restore(std::span<const OdeBody> bodies) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const dBodyID body = bodies[i].get();
    const Saved& saved = bodies_[i];
    write(saved.quaternion, dBodyGetQuaternion(body));
    write(saved.rotation, dBodyGetRotation(body));
    // Also marks the body's boxes as moved.
    dBodySetPosition(body, saved.position[0], saved.position[1], saved.position[2]);
    dBodySetLinearVel(body, saved.velocity[0], saved.velocity[1], saved.velocity[2]);
    dBodySetAngularVel(body, saved.rate[0], saved.rate[1], saved.rate[2]);
    dBodySetForce(body, saved.force[0], saved.force[1], saved.force[2]);
    dBodySetTorque(body, saved.torque[0], saved.torque[1], saved.torque[2]);
  }
}

void SavedBodies::archive(StateArchive& archive) { archive(bodies_); }

}  // namespace koboshi::sim_board
