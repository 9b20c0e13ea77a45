// Encodes a clip as MVN's network streamer does: its segments if the clip has them, otherwise those
// of the human found in it.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "live/stream/clip_axes.h"
#include "live/stream/human_bones.h"
#include "live/stream/mvn_protocol.h"
#include "live/stream/mvn_segments.h"
#include "live/stream/stream_formats.h"
#include "retarget/clip.h"

namespace retarget {
namespace {

using SegmentPoses = std::array<Pose, kMvnSegmentCount>;

// Joints of the segments; nothing if one is missing.
std::optional<std::array<int, kMvnSegmentCount>> segment_joints(const Skeleton& skeleton) {
  std::array<int, kMvnSegmentCount> joints;
  joints.fill(-1);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (const auto segment = mvn_segment(skeleton.joint(joint).name)) joints[*segment] = joint;
  }
  if (std::ranges::find(joints, -1) != joints.end()) return std::nullopt;
  return joints;
}

class MvnEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;
  [[nodiscard]] std::size_t packet_size(std::string_view bytes) const override;

 private:
  void pose_of_joints(const Clip& clip, int frame);
  void pose_of_bones();
  [[nodiscard]] std::string scale(const Clip& clip, int frame) const;

  std::optional<std::array<int, kMvnSegmentCount>> joints_;  // Nothing: bones are played.
  ClipAxes axes_;
  std::vector<Pose> world_from_joint_;
  BonePoses bones_;
  SegmentPoses world_from_segment_;
  std::array<Eigen::Vector3d, kMvnSegmentCount> t_pose_;
};

std::uint32_t milliseconds_of(const Clip& clip, int frame) {
  return static_cast<std::uint32_t>(std::lround(1e3 * clip.rate().time_of(frame)));
}

std::string MvnEncoder::begin(const Clip& clip) {
  joints_ = plays_human_as_mvn(clip) ? std::nullopt : segment_joints(clip.skeleton());
  if (joints_) {
    axes_ = ClipAxes(clip, Eigen::Vector3d::UnitZ());
    world_from_joint_.resize(static_cast<std::size_t>(clip.skeleton().joint_count()));
    pose_of_joints(Clip(clip.shared_skeleton(), clip.rate(), 1), 0);
  } else {
    bones_ = BonePoses(clip);
    pose_of_bones();
  }
  std::ranges::transform(world_from_segment_, t_pose_.begin(), &Pose::translation);
  return scale(clip, 0);
}

void MvnEncoder::pose_of_joints(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    world_from_segment_[i] =
        axes_.metric(world_from_joint_[static_cast<std::size_t>((*joints_)[i])]);
  }
}

// A missing bone is rigidly attached to its parent.
void MvnEncoder::pose_of_bones() {
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    const MvnSegment& segment = kMvnSegments[i];
    if (bones_.has(segment.bone)) {
      world_from_segment_[i] = bones_.world_from_bone(segment.bone);
    } else if (segment.parent >= 0) {
      world_from_segment_[i] = world_from_segment_[static_cast<std::size_t>(segment.parent)];
    }
  }
}

std::string MvnEncoder::scale(const Clip& clip, int frame) const {
  return mvn_scale_message(static_cast<std::uint32_t>(frame), milliseconds_of(clip, frame),
                           t_pose_);
}

Result<std::string> MvnEncoder::frame(const Clip& clip, int frame) {
  if (joints_) {
    pose_of_joints(clip, frame);
  } else {
    bones_.set_frame(clip, frame);
    pose_of_bones();
  }
  // Repeat the scale once per second for receivers that join later.
  const int second = std::max(1, static_cast<int>(std::lround(clip.rate().fps())));
  std::string bytes = frame > 0 && frame % second == 0 ? scale(clip, frame) : std::string();
  return bytes += mvn_pose_message(static_cast<std::uint32_t>(frame), milliseconds_of(clip, frame),
                                   world_from_segment_);
}

std::size_t MvnEncoder::packet_size(std::string_view bytes) const {
  return mvn_message_size(bytes).value_or(bytes.size());
}

}  // namespace

bool plays_human_as_mvn(const Clip& clip) {
  return !clip.origin().metres_per_unit || !clip.origin().up || !segment_joints(clip.skeleton());
}

std::unique_ptr<Encoder> make_mvn_encoder() {
  return std::make_unique<MvnEncoder>();
}

}  // namespace retarget
