#include "smpl/generic_hand.h"

namespace retarget {

// Bones: A. Buryanov, V. Kotiuk, Proportions of hand segments, International Journal of Morphology 28
// (2010); the thumb's first is its metacarpal. Knuckles are assumed: metacarpals of that table behind
// carpal bones of 25 mm.
const std::array<GenericFinger, kFingerCount>& generic_hand() {
  static const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();
  static const std::array<GenericFinger, kFingerCount> kHand = {
      {{{0.025, 0.022, 0.012},
        Eigen::Vector3d(0.75, 0.55, 0.35).normalized(),
        {0.0462, 0.0316, 0.0256}},
       {{0.090, 0.025, 0.0}, kAhead, {0.0398, 0.0224, 0.0197}},
       {{0.092, 0.005, 0.0}, kAhead, {0.0446, 0.0263, 0.0214}},
       {{0.085, -0.014, 0.0}, kAhead, {0.0414, 0.0257, 0.0213}},
       {{0.078, -0.032, 0.0}, kAhead, {0.0327, 0.0181, 0.0197}}}};
  return kHand;
}

}  // namespace retarget
