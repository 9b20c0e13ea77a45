#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Target of the end of a limb while it is in contact.
struct ContactMove {
  int begin = 0, end = 0;  ///< Frames.
  /// World rotation of a foot, about its ankle; hands keep their orientation.
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  /// Displacement of the ankle or wrist in frames [begin, end); world, metres.
  std::vector<Eigen::Vector3d> offsets;
};

/// Moves of both feet, both hands and the trunk; sorted by time, without overlap.
struct ContactMoves {
  std::array<std::vector<ContactMove>, 2> feet, hands;
  std::vector<ContactMove> trunk;  ///< Of contacts of the seat, back and knees.

  [[nodiscard]] bool empty() const;
};

/// Moves contacts of a human, and the human with them.
///
/// Each foot moves as given while it stands, and smoothly from one stance to the next in between;
/// in a swing to a higher stance it rises early, to a lower one it sinks late. The body moves by
/// the mean of the feet, or with the trunk while that rests on something, smoothed over 0.6 s; it
/// is lower, as smoothly, where standing legs would not reach the ground. Hands move as given in
/// contact, else with the body. Two-bone inverse kinematics of legs and arms supplies the
/// differences. A clip without moves stays identical.
/// @param first  frames before it stay.
void move_contacts(Clip& clip, int first, const Calibration& calibration,
                   const ContactMoves& moves);

}  // namespace retarget
