#include <cstddef>
#include <vector>

#include "edit/body_mirror.h"
#include "edit/ground_pose.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"
#include "retarget/trigonometry.h"
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

// The canonical axes of a bone of the mirrored body result from those of its counterpart. With the
// world rotation W of its joint, the joint's reflection S and the canonical axes J in the joint,
// M W J N = (M W S^-1) S J N. N reflects the canonical axes.
Calibration mirrored_calibration(const Calibration& calibration, const BodyMirror& body) {
  constexpr double kSame = 1e-9;
  const Eigen::DiagonalMatrix<double, 3> across(1.0, -1.0, 1.0);
  Calibration result = calibration;
  for (const Bone bone : kAllBones) {
    const BoneSource& from = calibration.bones[bone];
    BoneSource& to = result.bones[mirrored(bone)];
    if (from.rotation_joint < 0 || to.rotation_joint != body.mates[from.rotation_joint]) continue;
    const auto axes = [](const BoneSource& of) -> Eigen::Matrix3d {
      return of.joint_from_bone.value_or(Eigen::Quaterniond::Identity()).toRotationMatrix();
    };
    const auto image_of = [&](int joint, const Eigen::Matrix3d& joint_from_bone) {
      return Eigen::Matrix3d(body.mate_axes[joint] * joint_from_bone *
                             canonical_t_pose(bone).transpose() * across *
                             canonical_t_pose(mirrored(bone)));
    };
    const Eigen::Matrix3d image = image_of(from.rotation_joint, axes(from));
    if ((image - axes(to)).norm() > kSame) to.joint_from_bone = Eigen::Quaterniond(image);
    if (from.twist_joint >= 0 && to.twist_joint == body.mates[from.twist_joint]) {
      to.twist_from_bone =
          Eigen::Quaterniond(image_of(from.twist_joint, from.twist_from_bone.toRotationMatrix()));
    }
  }
  return result;
}

// Moves a mirrored clip back to the start position and heading of the original.
Result<void> move_to_start(const Clip& clip, const Calibration& calibration, Clip& image) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  if (clip.frame_count() == 0) return {};
  const GroundPose was = hips_over_ground(to_human(cut(clip, 0, 1), calibration)).front();
  const GroundPose is = hips_over_ground(to_human(cut(image, 0, 1), calibration)).front();
  mover.move_all(image, (was * is.inverse()).in_space());
  return {};
}

// Turns the image at the plane y = 0 into that at another plane.
Result<void> move_to_plane(const Clip& clip, const Calibration& calibration,
                           const MirrorPlane& plane, Clip& image) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  const double heading = portable::atan2(-plane.normal.x(), plane.normal.y());
  const GroundPose on_plane{plane.point.head<2>(), heading};
  const GroundPose at_image{{plane.point.x(), -plane.point.y()}, -heading};
  mover.move_all(image, (on_plane * at_image.inverse()).in_space());
  return {};
}

}  // namespace

Result<Clip> mirror(const Clip& clip, const Calibration& calibration) {
  RETARGET_TRY_ASSIGN(const auto body, body_mirror(clip.skeleton(), calibration));
  Clip result = Mirroring(clip, calibration, body).run();
  RETARGET_TRY(move_to_start(clip, calibration, result));
  return result;
}

Result<MirroredHuman> mirror_human(const Clip& clip, const Calibration& calibration,
                                   const MirrorPlane& plane) {
  RETARGET_TRY_ASSIGN(const auto body, body_mirror(clip.skeleton(), calibration));
  MirroredHuman result{Mirroring(clip, calibration, body).run(),
                       mirrored_calibration(calibration, body)};
  RETARGET_TRY(move_to_plane(clip, calibration, plane, result.clip));
  return result;
}

MirrorPlane mirror_plane(const Clip& clip, const Calibration& calibration) {
  const Pose hips = hips_over_ground(to_human(cut(clip, 0, 1), calibration)).front().in_space();
  return {hips.translation, hips.rotation * Eigen::Vector3d::UnitY()};
}

}  // namespace retarget
