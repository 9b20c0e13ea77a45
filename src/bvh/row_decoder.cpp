#include "bvh/row_decoder.h"

#include <algorithm>

#include "bvh/euler_angles.h"

namespace retarget {
namespace {

// whether the position channels of a joint hold nothing but zeros
bool positions_are_zero(const Clip& clip, int joint) {
  const Skeleton& skeleton = clip.skeleton();
  const int slot = skeleton.translation_slot(joint);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const Eigen::Vector3d& translation = clip.translations(frame)[slot];
    for (const Channel channel : skeleton.joint(joint).channels) {
      if (is_position(channel) && translation[axis_of(channel)] != 0.0) return false;
    }
  }
  return true;
}

}  // namespace

RowDecoder::RowDecoder(const Skeleton& skeleton, int first_column) {
  int column = first_column;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    for (const Channel channel : skeleton.joint(joint).channels) {
      if (is_rotation(channel)) {
        rotations_.push_back({column, joint, axis_of(channel)});
      } else if (is_position(channel)) {
        positions_.push_back({column, skeleton.translation_slot(joint), axis_of(channel)});
      }
      ++column;
    }
  }
}

void RowDecoder::decode(std::span<const double> row, Clip& clip, int frame) const {
  const auto rotations = clip.rotations(frame);
  std::ranges::fill(rotations, Eigen::Quaterniond::Identity());
  for (const Step& step : rotations_) {
    rotate_about(rotations[step.target], step.axis, row[step.column]);
  }
  const auto translations = clip.translations(frame);
  for (const Step& step : positions_) translations[step.target][step.axis] = row[step.column];
}

std::vector<int> keep_offsets_of_unmoved_joints(Clip& clip) {
  std::vector<int> kept;
  if (clip.frame_count() == 0) return kept;
  const Skeleton& skeleton = clip.skeleton();
  for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
    const int slot = skeleton.translation_slot(joint);
    const Eigen::Vector3d& offset = skeleton.joint(joint).offset;
    if (slot < 0 || offset.isZero(0.0) || !positions_are_zero(clip, joint)) continue;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      clip.translations(frame)[slot] = offset;
    }
    kept.push_back(joint);
  }
  return kept;
}

}  // namespace retarget
