#pragma once

#include <utility>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// Compares the limbs of frames with those of the calibrated body: positions of a performer of
/// another size, or in another unit, have other lengths.
class BodyMatch {
 public:
  enum class Fit {
    kSame,
    kOther,     ///< The latest frames are of a body of another size; returned once.
    kNoPerson,  ///< The frame is not of a person: its unit differs.
  };

  /// @param body  a pose of the calibrated body.
  BodyMatch(const Calibration& calibration, const HumanPose& body);

  /// Adds the next frame.
  [[nodiscard]] Fit add(const HumanPose& human);
  /// Length of the limbs of the latest frame, relative to those of the calibrated body.
  [[nodiscard]] double ratio() const { return ratio_; }

 private:
  [[nodiscard]] double length_of(const HumanPose& human) const;

  std::vector<std::pair<Bone, Bone>> segments_;  // Of the bones that the body has.
  double length_ = 0.0;                          // Metres; 0: unknown.
  double ratio_ = 1.0;
  int others_ = 0;  // Consecutive frames of another size.
  bool is_reported_ = false;
};

}  // namespace retarget
