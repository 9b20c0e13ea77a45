#include "bvh/joint_positions.h"

#include <algorithm>
#include <iterator>

namespace retarget {
namespace {

// of the OFFSET: positions that stay nearer to 0 than this are none
constexpr double kNearZero = 0.05;

// the position channels of a joint that has an OFFSET in the same components
class JointPositions {
 public:
  JointPositions(const Clip& clip, int joint)
      : clip_(&clip), joint_(joint), slot_(clip.skeleton().translation_slot(joint)) {
    if (slot_ < 0) return;
    for (const Channel channel : clip.skeleton().joint(joint).channels) {
      if (is_position(channel)) has_channel_[axis_of(channel)] = 1.0;
    }
    offset_ = has_channel_.cwiseProduct(clip.skeleton().joint(joint).offset);
    length_ = offset_.norm();
  }

  [[nodiscard]] int joint() const { return joint_; }
  [[nodiscard]] int slot() const { return slot_; }
  [[nodiscard]] const Eigen::Vector3d& offset() const { return offset_; }
  [[nodiscard]] bool has_offset() const { return length_ > 0.0; }

  // whether no position is farther from 0 than that; most files say no in their first frame
  [[nodiscard]] bool stay_below(double distance) const {
    for (int frame = 0; frame < clip_->frame_count(); ++frame) {
      if (position(frame).norm() > distance) return false;
    }
    return true;
  }
  [[nodiscard]] bool stay_near_zero() const { return stay_below(kNearZero * length_); }

  // on the mean
  [[nodiscard]] bool are_nearer_to_zero() const {
    double difference = 0.0;
    for (int frame = 0; frame < clip_->frame_count(); ++frame) {
      difference += position(frame).norm() - (position(frame) - offset_).norm();
    }
    return difference < 0.0;
  }

 private:
  [[nodiscard]] Eigen::Vector3d position(int frame) const {
    return has_channel_.cwiseProduct(clip_->translations(frame)[slot_]);
  }

  const Clip* clip_;
  int joint_;
  int slot_;
  Eigen::Vector3d has_channel_ = Eigen::Vector3d::Zero();  // 1 for components that have one
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  double length_ = 0.0;
};

}  // namespace

PositionReading read_positions_beside_offsets(Clip& clip) {
  PositionReading reading;
  if (clip.frame_count() == 0) return reading;
  std::vector<JointPositions> near_zero, others;
  for (int joint = 1; joint < clip.skeleton().joint_count(); ++joint) {
    const JointPositions positions(clip, joint);
    if (!positions.has_offset()) continue;
    (positions.stay_near_zero() ? near_zero : others).push_back(positions);
  }
  const bool most_are_changes = near_zero.size() > others.size();
  std::vector<JointPositions> added = near_zero;
  if (most_are_changes) {
    std::ranges::copy_if(others, std::back_inserter(added), &JointPositions::are_nearer_to_zero);
  }
  std::ranges::sort(added, {}, &JointPositions::joint);
  for (const JointPositions& positions : added) {
    (positions.stay_below(0.0) ? reading.unmoved : reading.changes).push_back(positions.joint());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      clip.translations(frame)[positions.slot()] += positions.offset();
    }
  }
  return reading;
}

bool has_positions_near_zero(const Clip& clip, int joint) {
  const JointPositions positions(clip, joint);
  return joint > 0 && clip.frame_count() > 0 && positions.has_offset() &&
         positions.stay_near_zero();
}

}  // namespace retarget
