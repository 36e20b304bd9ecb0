#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::balance {

// Where the soles and the centre of mass are, by the joints: robot/kinematics.h at a price that fits into a
// tick. Each limb is a recursion from its end to the trunk over a few vectors only,
//   m_i = k_i + sum over children c of R_c m_c,   p_CoM = k_B + sum over limbs of R m,
// where k_i is the constant part of link i's moment of mass in its own frame (its own mass, and the masses
// beyond at the anchors of the joints it carries), over the mass of the robot, so that moments are lengths.
// A turn about a principal axis costs four products a vector.
//
// Each update takes in one leg and one of the other limbs, in turn: with two arms and a head a leg is at most
// 10 ms old, and an arm 20.
class Posture {
 public:
  static constexpr std::size_t kLegs = 2;

  // The model must outlive this.
  explicit Posture(const robot::RobotModel& model);

  // In each 100 Hz cycle. `angle_of` gives the angle of a joint of the model; it is asked only for those of
  // the limbs whose turn it is.
  template <typename AngleOf>
  void update(AngleOf angle_of) {
    if (limb_count_ == 0) return;
    for (const std::size_t number : {next_leg_, next_other_}) {
      Limb& limb = limbs_[number];
      for (std::size_t place = limb.first; place < limb.end; ++place) {
        joints_[place].angle = angle_of(std::size_t{joints_[place].index});
      }
      update_limb(number);
    }
    next_leg_ = (next_leg_ + 1) % kLegs;
    next_other_ = next_other_ + 1 < limb_count_ ? next_other_ + 1 : kLegs;
  }

  // The sole in the trunk's frame. Its rotation is the one into axes of the sole, R_SoleB.
  struct Sole {
    robot::Position p_BSole;
    robot::Rotation R_SoleB;
  };
  const Sole& sole(hal::Side side) const { return soles_[static_cast<std::size_t>(side)]; }

  // Centre of mass of the whole robot in the frame of a sole.
  robot::Position centre_of_mass(hal::Side side) const;

 private:
  // Coordinates by axis, in LSB of whatever they are.
  using Raw = std::array<std::int32_t, 3>;

  struct Joint {
    std::uint8_t index = 0;   // in the model
    std::int8_t parent = -1;  // place in joints_; -1: the trunk
    // A turn about a principal axis leaves it alone and turns the next two, from the first to the second.
    // 3 where the axis is none of them.
    std::uint8_t axis = 3;
    bool negative = false;    // turns about the negative principal axis
    bool bears_foot = false;  // on the way from the trunk to a sole
    fixed::Angle angle;
    Raw anchor{};
    Raw constant{};  // k
    Raw moment{};    // m; of the first of a limb, once that is done, R m
  };
  // Joints that hang on one joint of the trunk, which is the first: places first..end-1 of joints_, each
  // after its parent.
  struct Limb {
    std::uint8_t first = 0;
    std::uint8_t end = 0;
  };

  Joint make_joint(std::size_t index, std::size_t first, std::size_t end) const;
  std::size_t collect_limb(std::size_t first, std::size_t root);
  void collect_constants();
  void update_limb(std::size_t number);
  void turn(const Joint& joint, std::span<Raw> vectors) const;
  void turn_obliquely(const Joint& joint, std::span<Raw> vectors) const;

  const robot::RobotModel& model_;
  std::array<Joint, robot::kMaxJoints> joints_{};
  // The legs by Side, then the others.
  std::array<Limb, robot::kMaxJoints> limbs_{};
  std::size_t limb_count_ = 0;
  std::size_t next_leg_ = 0;
  std::size_t next_other_ = kLegs;
  Raw trunk_constant_{};
  std::array<Sole, 2> soles_{};
};

}  // namespace koboshi::balance
