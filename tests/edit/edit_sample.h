#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "edit/transfer.h"
#include "formats/bvh/read_bvh.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "retarget/bvh.h"
#include "retarget/clip.h"
#include "retarget/edit_paths.h"
#include "support/angles.h"
#include "support/recorded_clip.h"

namespace retarget::edit_test {

inline const std::vector<SkeletonProfile>& all_profiles() {
  static const std::vector<SkeletonProfile> kProfiles =
      load_skeleton_profiles(std::string(RETARGET_SOURCE_DIR) + "/configs/skeletons").value();
  return kProfiles;
}

/// A clip and the human that is recognised in it.
struct EditSample {
  Clip clip;
  BoneMap map;
  Calibration calibration;

  explicit EditSample(Clip from)
      : clip(std::move(from)),
        map(recognise_skeleton(clip, all_profiles()).value()),
        calibration(calibrate(clip, map, {}).value()) {}

  [[nodiscard]] HumanClip human() const { return to_human(clip, calibration); }
  [[nodiscard]] HumanClip human_of(const Clip& edited) const {
    return to_human(edited, calibration);
  }
  [[nodiscard]] TransferTarget as_target() const {
    return {clip.shared_skeleton(), map, calibration};
  }
};

inline const EditSample& data_sample(const std::string& name) {
  static std::vector<std::pair<std::string, EditSample>> samples;
  for (const auto& [known, found] : samples) {
    if (known == name) return found;
  }
  samples.reserve(16);
  return samples.emplace_back(name, EditSample(recorded_clip(name))).second;
}

/// Largest distance between the joints of two clips of one skeleton, metres.
inline double largest_distance(const Clip& a, const Clip& b, double metres_per_unit) {
  EXPECT_EQ(a.frame_count(), b.frame_count());
  std::vector<Pose> in_a(a.skeleton().joint_count()), in_b(b.skeleton().joint_count());
  double largest = 0.0;
  for (int frame = 0; frame < std::min(a.frame_count(), b.frame_count()); ++frame) {
    forward_kinematics(a, frame, in_a);
    forward_kinematics(b, frame, in_b);
    for (std::size_t joint = 0; joint < in_a.size(); ++joint) {
      largest = std::max(largest, (in_a[joint].translation - in_b[joint].translation).norm());
      // Error of the descendants of a joint, at a tenth of a metre.
      const auto& p = in_a[joint].rotation.coeffs();
      const auto& q = in_b[joint].rotation.coeffs();
      largest = std::max(largest, 0.2 / metres_per_unit * std::min((p - q).norm(), (p + q).norm()));
    }
  }
  return largest * metres_per_unit;
}

/// The clip after a round trip through BVH text.
inline Clip through_bvh(const Clip& clip) {
  return read_bvh(format_bvh(clip).value(), "written").value().clip;
}

inline PathMotion path_of(const EditSample& sample) {
  return fit_path(sample.clip, sample.calibration).value();
}

inline double angle_between(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * kPi));
}

}  // namespace retarget::edit_test
