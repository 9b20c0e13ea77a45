#include "retarget/edit/mirror.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include "edit/rest_frames.h"
#include "retarget/edit/ground_pose.h"
#include "retarget/human/bone_map.h"
#include "retarget/motion/forward_kinematics.h"

namespace retarget {
namespace {

// the mirror image of a rotation, in the mirror that left and right have in the T-pose (y = 0)
Eigen::Quaterniond mirrored(const Eigen::Quaterniond& q) {
  return {q.w(), -q.x(), q.y(), -q.z()};
}

Eigen::Vector3d mirrored(const Eigen::Vector3d& v) {
  return {v.x(), -v.y(), v.z()};
}

int mirrored_bone(int bone) {
  const std::string name(kBoneNames[static_cast<std::size_t>(bone)]);
  if (name.starts_with("Left")) return find_bone("Right" + name.substr(4)).value();
  if (name.starts_with("Right")) return find_bone("Left" + name.substr(5)).value();
  return bone;
}

// pairs the joints of a skeleton
class JointPairing {
 public:
  JointPairing(const Skeleton& skeleton, const HumanMapping& mapping, const std::string& file)
      : skeleton_(skeleton),
        mapping_(mapping),
        file_(file),
        t_pose_(t_pose_rotations(skeleton, mapping)),
        children_(static_cast<std::size_t>(skeleton.joint_count())),
        mates_(static_cast<std::size_t>(skeleton.joint_count()), -1) {
    for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
      children_[skeleton.joint(joint).parent].push_back(joint);
    }
  }

  Result<std::vector<int>> run() {
    for (int bone = 0; bone < kMappedBoneCount; ++bone) {
      if (auto paired = pair_bones(bone); !paired) return failure(paired.error());
    }
    for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
      // what hangs from nothing that is paired hangs from the root
      if (mates_[joint] < 0 && skeleton_.joint(joint).parent < 0) mates_[joint] = joint;
      if (mates_[joint] < 0) return lonely(joint);
      if (auto paired = pair_children(joint); !paired) return failure(paired.error());
    }
    return mates_;
  }

 private:
  [[nodiscard]] Failure lonely(int joint) const {
    return input_failure(file_, "the joint \"" + skeleton_.joint(joint).name +
                                    "\" has no counterpart on the other side of the body");
  }

  // the bone's joint with the other side's, and what lies above both
  Result<void> pair_bones(int bone) {
    const auto joint_of = [this](int b) {
      return mapping_.bones[static_cast<std::size_t>(b)].position_joint;
    };
    int joint = joint_of(bone), mate = joint_of(mirrored_bone(bone));
    if (joint < 0) return {};
    while (joint >= 0 || mate >= 0) {
      if (joint < 0 || mate < 0) return lonely(joint < 0 ? mate : joint);
      if (mates_[joint] == mate && mates_[mate] == joint) return {};
      if (mates_[joint] >= 0 || mates_[mate] >= 0) return lonely(mates_[joint] >= 0 ? mate : joint);
      mates_[joint] = mate;
      mates_[mate] = joint;
      joint = skeleton_.joint(joint).parent;
      mate = skeleton_.joint(mate).parent;
    }
    return {};
  }

  // what hangs from a paired joint and is not paired yet
  Result<void> pair_children(int joint) {
    const int mate = mates_[joint];
    const auto ours = unpaired(joint), theirs = unpaired(mate);
    for (const int child : ours) {
      if (mates_[child] >= 0) continue;
      int best = -1;
      double least = std::numeric_limits<double>::infinity();
      for (const int other : theirs) {
        if (mates_[other] >= 0) continue;
        const double cost = difference(child, other);
        if (cost < least) {
          least = cost;
          best = other;
        }
      }
      if (best < 0) return lonely(child);
      mates_[child] = best;
      mates_[best] = child;
    }
    for (const int other : theirs) {
      if (mates_[other] < 0) return lonely(other);
    }
    return {};
  }

  [[nodiscard]] std::vector<int> unpaired(int joint) const {
    std::vector<int> result;
    std::ranges::copy_if(children_[joint], std::back_inserter(result),
                         [this](int child) { return mates_[child] < 0; });
    return result;
  }

  // how far two subtrees are from being mirror images, file units; infinite: not of one shape
  [[nodiscard]] double difference(int a, int b) const {
    if (children_[a].size() != children_[b].size()) return std::numeric_limits<double>::infinity();
    double sum = (mirrored(offset_in_t_pose(a)) - offset_in_t_pose(b)).norm();
    std::vector<int> left(children_[b]);
    for (const int child : children_[a]) {
      std::size_t best = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < left.size(); ++i) {
        const double cost = difference(child, left[i]);
        if (cost < least) {
          least = cost;
          best = i;
        }
      }
      sum += least;
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return sum;
  }

  // from the parent, in the canonical human's axes
  [[nodiscard]] Eigen::Vector3d offset_in_t_pose(int joint) const {
    return t_pose_[skeleton_.joint(joint).parent] * skeleton_.joint(joint).offset;
  }

  const Skeleton& skeleton_;
  const HumanMapping& mapping_;
  const std::string& file_;
  const std::vector<Eigen::Quaterniond> t_pose_;
  std::vector<std::vector<int>> children_;
  std::vector<int> mates_;
};

class Mirroring {
 public:
  Mirroring(const Clip& clip, const HumanMapping& mapping, std::vector<int> mates)
      : clip_(clip),
        skeleton_(clip.skeleton()),
        human_from_source_(mapping.human_from_source),
        t_pose_(t_pose_rotations(clip.skeleton(), mapping)),
        mates_(std::move(mates)),
        before_(static_cast<std::size_t>(skeleton_.joint_count())),
        after_(before_.size()) {}

  // in the mirror y = 0
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
    const Eigen::Quaterniond from_t_pose =
        human_from_source_ * before_[mate].rotation * t_pose_[mate].conjugate();
    after_[joint] = human_from_source_.conjugate() * mirrored(from_t_pose) * t_pose_[joint];
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
      translation = human_from_source_.conjugate() *
                    mirrored(human_from_source_ * clip_.translation(frame, mate));
      return;
    }
    // what the other side has beyond its offset, so that the body keeps its measures
    const Eigen::Vector3d beyond = clip_.translation(frame, mate) - skeleton_.joint(mate).offset;
    translation = skeleton_.joint(joint).offset +
                  t_pose_[parent].conjugate() * mirrored(t_pose_[mates_[parent]] * beyond);
  }

  const Clip& clip_;
  const Skeleton& skeleton_;
  const Eigen::Quaterniond human_from_source_;
  const std::vector<Eigen::Quaterniond> t_pose_;
  const std::vector<int> mates_;
  std::vector<Pose> before_;               // of the frame
  std::vector<Eigen::Quaterniond> after_;  // world rotations, file axes
};

}  // namespace

Result<std::vector<int>> mirrored_joints(const Skeleton& skeleton, const HumanMapping& mapping,
                                         const std::string& file) {
  return JointPairing(skeleton, mapping, file).run();
}

Result<Clip> mirror(const Clip& clip, const HumanMapping& mapping, const std::string& file) {
  auto mates = mirrored_joints(clip.skeleton(), mapping, file);
  if (!mates) return failure(mates.error());
  const auto mover = BodyMover::of(clip.skeleton(), mapping, file);
  if (!mover) return failure(mover.error());
  Clip result = Mirroring(clip, mapping, std::move(*mates)).run();
  if (clip.frame_count() == 0) return result;
  // to where it began
  const GroundPose was = hips_over_ground(to_human(cut(clip, 0, 1), mapping)).front();
  const GroundPose is = hips_over_ground(to_human(cut(result, 0, 1), mapping)).front();
  mover->move_all(result, (was * is.inverse()).in_space());
  return result;
}

}  // namespace retarget
