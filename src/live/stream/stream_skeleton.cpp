#include "live/stream/stream_skeleton.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "live/stream/human_bones.h"
#include "retarget/try.h"

namespace retarget {
namespace {

bool same_units(const Clip& a, const Clip& b) {
  return a.origin().metres_per_unit == b.origin().metres_per_unit && a.origin().up == b.origin().up;
}

double bone_length(const Skeleton& skeleton) {
  double length = 0.0;
  for (const Joint& joint : skeleton.joints())
    length += joint.parent < 0 ? 0.0 : joint.offset.norm();
  return length;
}

}  // namespace

std::vector<Channel> all_channels() {
  using enum Channel;
  return {kXPosition, kYPosition, kZPosition, kZRotation, kYRotation, kXRotation};
}

bool have_same_joints(const Skeleton& a, const Skeleton& b) {
  return std::ranges::equal(a.joints(), b.joints(), [](const Joint& one, const Joint& other) {
    return one.name == other.name && one.parent == other.parent && one.channels == other.channels;
  });
}

bool is_same(const Clip& a, const Clip& b) {
  return same_units(a, b) && a.origin().body_height == b.origin().body_height &&
         have_same_joints(a.skeleton(), b.skeleton()) &&
         std::ranges::equal(a.skeleton().joints(), b.skeleton().joints(), {}, &Joint::offset,
                            &Joint::offset);
}

bool is_like(const Clip& a, const Clip& b) {
  constexpr double kMostRatio = 1.25;
  if (a.shared_skeleton() == b.shared_skeleton()) return true;
  if (!same_units(a, b) || !have_same_joints(a.skeleton(), b.skeleton())) return false;
  const double one = bone_length(a.skeleton()), other = bone_length(b.skeleton());
  return one <= kMostRatio * other && other <= kMostRatio * one;
}

void StreamSkeleton::set_joints(std::vector<StreamJoint> joints, const Eigen::Vector3d& up,
                                bool is_rest_pose, StreamSink& sink, std::optional<double> height) {
  joints_ = std::move(joints);
  // The user's file has more information about the same skeleton.
  if (use_known(up)) return;
  use_received();
  std::vector<Joint> skeleton;
  for (const StreamJoint& joint : joints_) {
    skeleton.push_back({joint.name, joint.parent, joint.offset, {}, all_channels()});
  }
  // A zero pose that is not a rest pose carries no information; the first frame determines the
  // body.
  const int poses = is_rest_pose ? 1 : 0;
  Clip clip(std::make_shared<const Skeleton>(std::move(skeleton)), FrameRate{}, poses);
  ClipOrigin origin;
  origin.name = "stream";
  origin.metres_per_unit = 1.0;
  origin.up = up;
  origin.body_height = height;
  clip.set_origin(std::move(origin));
  sink.take_skeleton(std::move(clip), is_rest_pose);
}

// Requires that each joint of the file is one of the stream's with the same parent.
bool StreamSkeleton::use_known(const Eigen::Vector3d& up) {
  if (!known_) return false;
  sources_.clear();
  parents_.clear();
  slots_.clear();
  std::vector<Eigen::Vector3d> of_file, of_stream;
  for (int i = 0; i < known_->joint_count(); ++i) {
    const Joint& joint = known_->joint(i);
    const auto found = std::ranges::find(joints_, joint.name, &StreamJoint::name);
    if (found == joints_.end() || (joint.parent < 0) != (found->parent < 0)) return false;
    if (joint.parent >= 0) {
      const StreamJoint& parent = joints_[static_cast<std::size_t>(found->parent)];
      if (parent.name != known_->joint(joint.parent).name) return false;
      of_file.push_back(joint.offset);
      of_stream.push_back(found->offset);
    }
    sources_.push_back(static_cast<std::size_t>(found - joints_.begin()));
    parents_.push_back(joint.parent);
    slots_.push_back(known_->translation_slot(i));
  }
  constexpr double kMetres = 1.0;
  axes_ = FileAxes({of_stream, up}, kMetres, {of_file, known_up_});
  frame_.translations.assign(static_cast<std::size_t>(known_->translated_count()),
                             Eigen::Vector3d::Zero());
  return true;
}

void StreamSkeleton::use_received() {
  sources_.clear();
  parents_.clear();
  slots_.clear();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    sources_.push_back(i);
    parents_.push_back(joints_[i].parent);
    slots_.push_back(static_cast<int>(i));
  }
  axes_ = FileAxes();
  frame_.translations.assign(joints_.size(), Eigen::Vector3d::Zero());
}

void StreamSkeleton::give(double time, std::span<const Pose> world_from_joint, StreamSink& sink) {
  frame_.time = time;
  frame_.rotations.resize(sources_.size());
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const int parent =
        parents_[i] < 0 ? -1 : static_cast<int>(sources_[static_cast<std::size_t>(parents_[i])]);
    const Pose pose = parent_from_joint(world_from_joint, parent, world_from_joint[sources_[i]]);
    const Pose in_file = parent < 0 ? axes_.root(pose) : axes_.child(pose);
    frame_.rotations[i] = in_file.rotation.normalized();
    if (slots_[i] < 0) continue;
    frame_.translations[static_cast<std::size_t>(slots_[i])] = in_file.translation;
  }
  sink.take_frame(frame_);
}

Result<MadeBody> BodyMaker::make(const BodyTask& task, bool is_first) const {
  Options run = run_;
  if (run.human.rest == RestPose::kAuto && run.human.tpose_file.empty()) {
    run.human.rest = task.rest;
  }
  Clip clip = task.clip;
  if (clip.frame_count() == 0) clip.resize(1);
  MadeBody made;
  RETARGET_TRY_ASSIGN(made.plan, make_plan(std::move(clip), robot_, run));
  if (is_first) return made;
  RETARGET_TRY_ASSIGN(made.body, LiveSession::prepare(made.plan, live_, *made.plan.robot.robot));
  return made;
}

void BodyMaker::start(BodyTask task) {
  task_ = std::move(task);
  result_ = std::async(std::launch::async, [this] { return make(*task_, false); });
}

bool BodyMaker::is_ready() const {
  return is_busy() && result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace retarget
