#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "edit/rest_frames.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/pose.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Returns the index in the source of each target joint's counterpart.
Result<std::vector<int>> match_joints(const Skeleton& source, const Skeleton& target,
                                      const std::string& file, const std::string& target_file) {
  std::vector<int> twins;
  for (const Joint& joint : target.joints()) {
    for (const auto& [skeleton, name] :
         {std::pair(&source, &file), std::pair(&target, &target_file)}) {
      if (std::ranges::count(skeleton->joints(), joint.name, &Joint::name) > 1) {
        return input_failure(*name, "several joints are called \"" + joint.name + "\"",
                             "rename all but one of them");
      }
    }
    const auto twin = source.find(joint.name);
    if (!twin) {
      return input_failure(file, "no joint \"" + joint.name + "\" as in " + target_file +
                                     did_you_mean(joint.name, source.names()));
    }
    const int parent = source.joint(*twin).parent;
    const std::string above = parent < 0 ? "" : source.joint(parent).name;
    if (above != (joint.parent < 0 ? "" : target.joint(joint.parent).name)) {
      return input_failure(
          file, "the joint \"" + joint.name + "\" has a different parent than in " + target_file,
          "use retarget edit transfer for different joint trees");
    }
    twins.push_back(*twin);
  }
  if (source.joint_count() != target.joint_count()) {
    for (const Joint& joint : source.joints()) {
      if (target.find(joint.name)) continue;
      return input_failure(target_file, "no joint \"" + joint.name + "\" as in " + file);
    }
  }
  return twins;
}

class RestChanger {
 public:
  RestChanger(const Clip& clip, const std::shared_ptr<const Skeleton>& target,
              std::vector<int> twins)
      : clip_(clip), target_(target), twins_(std::move(twins)) {
    for (int joint = 0; joint < target_->joint_count(); ++joint) {
      turns_.push_back(rest_turn(leaving_of(clip.skeleton(), *target, twins_, joint)));
    }
  }

  RestChange run() const;

 private:
  [[nodiscard]] Eigen::Quaterniond turn_above(int joint) const {
    const int parent = target_->joint(joint).parent;
    return parent < 0 ? Eigen::Quaterniond::Identity() : turns_[parent];
  }
  [[nodiscard]] double distance(const Clip& changed, int frame) const;

  const Clip& clip_;
  const std::shared_ptr<const Skeleton>& target_;
  const std::vector<int> twins_;  // By target joint: index of its counterpart in the source.
  std::vector<Eigen::Quaterniond> turns_;  // Rotation Q by target joint.
};

RestChange RestChanger::run() const {
  RestChange result{{Clip(target_, clip_.rate(), clip_.frame_count())}};
  for (int frame = 0; frame < clip_.frame_count(); ++frame) {
    const auto source = clip_.rotations(frame);
    const auto rotations = result.clip.rotations(frame);
    const auto translations = result.clip.translations(frame);
    for (int joint = 0; joint < target_->joint_count(); ++joint) {
      const int twin = twins_[joint];
      rotations[joint] = turn_above(joint) * source[twin] * turns_[joint].conjugate();
      const int slot = target_->translation_slot(joint);
      if (slot < 0) continue;
      const bool moves = clip_.skeleton().translation_slot(twin) >= 0;
      translations[slot] = moves
                               ? Eigen::Vector3d(turn_above(joint) * clip_.translation(frame, twin))
                               : target_->joint(joint).offset;
    }
    result.largest_distance = std::max(result.largest_distance, distance(result.clip, frame));
  }
  result.notes = {
      {"moved", "no joint by more than " + number_text(result.largest_distance, 6) + " units"}};
  return result;
}

double RestChanger::distance(const Clip& changed, int frame) const {
  std::vector<Pose> before(clip_.skeleton().joint_count()), after(target_->joint_count());
  forward_kinematics(clip_, frame, before);
  forward_kinematics(changed, frame, after);
  double largest = 0.0;
  for (int joint = 0; joint < target_->joint_count(); ++joint) {
    const Pose& was = before[twins_[joint]];
    largest = std::max(largest, (was.translation - after[joint].translation).norm());
    const auto& sites = clip_.skeleton().joint(twins_[joint]).end_sites;
    const auto& target_sites = target_->joint(joint).end_sites;
    for (std::size_t i = 0; i < std::min(sites.size(), target_sites.size()); ++i) {
      largest = std::max(largest, (was * sites[i] - after[joint] * target_sites[i]).norm());
    }
  }
  return largest;
}

}  // namespace

Result<RestChange> change_rest(const Clip& clip, const std::shared_ptr<const Skeleton>& target,
                               const std::string& file, const std::string& target_file) {
  RETARGET_TRY_ASSIGN(auto twins, match_joints(clip.skeleton(), *target, file, target_file));
  return RestChanger(clip, target, std::move(twins)).run();
}

}  // namespace retarget
