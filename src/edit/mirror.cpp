#include <cstddef>
#include <vector>

#include "edit/body_mirror.h"
#include "edit/ground_pose.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/try.h"

namespace retarget {
namespace {

class Mirroring {
 public:
  Mirroring(const Clip& clip, const Calibration& calibration, const BodyMirror& body)
      : clip_(clip),
        skeleton_(clip.skeleton()),
        world_mirror_(calibration.human_from_source.transpose() *
                      Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal() * calibration.human_from_source),
        mates_(body.mates),
        mate_axes_(body.mate_axes),
        before_(static_cast<std::size_t>(skeleton_.joint_count())),
        after_(before_.size()) {}

  // Mirrors at the plane y = 0.
  Clip run() {
    Clip result(clip_.shared_skeleton(), clip_.rate(), clip_.frame_count());
    for (int frame = 0; frame < clip_.frame_count(); ++frame) {
      forward_kinematics(clip_, frame, before_);
      for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
        set_rotation(result, frame, joint);
        set_translation(result, frame, joint);
      }
    }
    return result;
  }

 private:
  void set_rotation(Clip& result, int frame, int joint) {
    const int mate = mates_[joint];
    after_[joint] = Eigen::Quaterniond(Eigen::Matrix3d(
        world_mirror_ * before_[mate].rotation.toRotationMatrix() * mate_axes_[mate].transpose()));
    const int parent = skeleton_.joint(joint).parent;
    const Eigen::Quaterniond local =
        parent < 0 ? after_[joint] : after_[parent].conjugate() * after_[joint];
    result.rotations(frame)[joint] = local.normalized();
  }

  void set_translation(Clip& result, int frame, int joint) const {
    const int slot = skeleton_.translation_slot(joint);
    const int mate = mates_[joint];
    if (slot < 0) return;
    Eigen::Vector3d& translation = result.translations(frame)[slot];
    const int parent = skeleton_.joint(joint).parent;
    if (parent < 0) {
      translation = world_mirror_ * clip_.translation(frame, mate);
      return;
    }
    // Mirror only the difference from the offset, so that bone lengths do not change.
    const Eigen::Vector3d beyond = clip_.translation(frame, mate) - skeleton_.joint(mate).offset;
    translation = skeleton_.joint(joint).offset + mate_axes_[mates_[parent]] * beyond;
  }

  const Clip& clip_;
  const Skeleton& skeleton_;
  const Eigen::Matrix3d world_mirror_;  // In file axes.
  const std::vector<int>& mates_;
  const std::vector<Eigen::Matrix3d>& mate_axes_;
  std::vector<Pose> before_;               // Poses of the current frame.
  std::vector<Eigen::Quaterniond> after_;  // World rotations, file axes.
};

}  // namespace

Result<Clip> mirror(const Clip& clip, const Calibration& calibration) {
  RETARGET_TRY_ASSIGN(const auto body, body_mirror(clip.skeleton(), calibration));
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  Clip result = Mirroring(clip, calibration, body).run();
  if (clip.frame_count() == 0) return result;
  // Move the clip back to its original start position and heading.
  const GroundPose was = hips_over_ground(to_human(cut(clip, 0, 1), calibration)).front();
  const GroundPose is = hips_over_ground(to_human(cut(result, 0, 1), calibration)).front();
  mover.move_all(result, (was * is.inverse()).in_space());
  return result;
}

}  // namespace retarget
