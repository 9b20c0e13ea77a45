#pragma once

#include <span>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Turns motion rows into frames of a clip.
///
/// Rotations compose their channels left to right (intrinsic), in degrees, about column vectors:
/// `Zrotation Yrotation Xrotation` is Rz * Ry * Rx. A position channel replaces its component of
/// the joint's offset; scale channels are ignored.
class RowDecoder {
 public:
  /// @param first_column  where the skeleton's channels begin in a row.
  RowDecoder(const Skeleton& skeleton, int first_column);

  /// @pre row holds at least first_column + skeleton.channel_count() values.
  void decode(std::span<const double> row, Clip& clip, int frame);

 private:
  struct Step {
    int column;
    int target;  // joint of a rotation, translation slot of a position
    int axis;
  };

  std::vector<Step> rotations_;
  std::vector<Step> positions_;
  // of the frame, by rotations_: apart from each other, so that loops over them are vector code
  std::vector<double> angles_;
  std::vector<double> sines_;
  std::vector<double> cosines_;
};

}  // namespace retarget
