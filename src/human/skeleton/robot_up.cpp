#include "human/skeleton/robot_up.h"

#include <utility>

#include "human/skeleton/body_axes.h"
#include "human/skeleton/free_fall.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/up_axis.h"

namespace retarget {

void settle_robot_up(const Clip& clip, const BoneMap& map, const std::optional<SignedAxis>& told,
                     Calibration& calibration) {
  if (told) {
    calibration.up = *told;
  } else {
    const Body body(clip.skeleton(), map);
    std::vector<JointPoses> poses;
    for (const int frame : sampled_frames(clip)) poses.push_back(frame_pose(clip, frame));
    KnownUp known;
    known.of_file = SignedAxis{2, false};
    known.of_fall = free_fall_axis(clip, body, 0);
    UpChoice choice = choose_up(body, poses, known);
    calibration.up = choice.axis;
    if (!choice.doubt.empty()) calibration.doubts.push_back({0, 0, std::move(choice.doubt)});
  }
  if (calibration.up == SignedAxis{2, false}) return;
  calibration.human_from_source = z_up_from_file(calibration.up);
  calibration.description += ", " + to_text(calibration.up) + " up";
}

}  // namespace retarget
