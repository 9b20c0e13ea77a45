#include <algorithm>
#include <cstddef>
#include <vector>

#include "judge/quality/similarity_metrics.h"
#include "judge/quality/tracking_measure.h"
#include "judge/quality/yaw_fit.h"
#include "retarget/statistics.h"
#include "retarget/trigonometry.h"
#include "solve/targets/targets.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

double TrackingMeasure::size_ratio(const QualitySource& source) const {
  constexpr double kPublishedHeight = 1.75;
  const double assumed = config_.human_height_assumption;
  return source.scale == ScaleRule::kTable
             ? human_.height / assumed
             : kPublishedHeight / assumed * (kPublishedHeight / human_.size);
}

void TrackingMeasure::collect_rows(double ratio) {
  for (int table = 0; table < 2; ++table) {
    const auto& [used, tasks] = config_.match_tables[table];
    if (!used) continue;
    for (const ConfigTask& task : tasks) {
      const auto index = kept(task.body);
      if (!index || !human_.has(task.bone)) continue;
      rows_.push_back({&task, table, *index, task.bone, ratio * config_.scales[task.bone]});
    }
  }
}

void TrackingMeasure::collect_root_path(double ratio) {
  if (!human_.has(config_.root_bone)) return;
  for (int frame = 0; frame < frames_; ++frame) {
    root_path_.push_back(ratio * config_.scales[config_.root_bone] *
                         bone_pose(frame, config_.root_bone).translation);
  }
}

// With limb scaling, the position of a target is not a multiple of its bone's position, so these
// targets come from TargetBuilder.
void TrackingMeasure::collect_limb_targets() {
  const auto targets = make_targets(human_, poses_of(human_), draft_.clip.robot(), config_,
                                    ScaleRule::kLimbs, TrunkRule::kLines);
  // Without measurable limbs, the targets remain scaled by height.
  if (!targets) return;
  limb_target_count_ = static_cast<std::size_t>(targets->target_count());
  limb_targets_.resize(static_cast<std::size_t>(frames_) * limb_target_count_);
  for (const Bone bone : kAllBones) target_of_bone_[bone] = targets->target_of(bone);
  for (int frame = 0; frame < frames_; ++frame) {
    const auto of_frame =
        std::span(limb_targets_)
            .subspan(static_cast<std::size_t>(frame) * limb_target_count_, limb_target_count_);
    targets->build(human_.frame(frame), of_frame);
    const Vector3d root = of_frame.front().translation;
    if (!root_path_.empty()) root_path_[static_cast<std::size_t>(frame)] = root;
    for (Pose& target : of_frame) target.translation -= root;
  }
}

// Finds the constant yaw that best aligns bones and bodies. Some data sets rotate the whole motion.
void TrackingMeasure::find_yaw() {
  YawFit yaw;
  for (const TrackedRow& row : rows_) {
    if (row.table != judged_table() || !has_position(row)) continue;
    for (int frame = 0; frame < frames_; ++frame) yaw.add(want(frame, row), have(frame, row));
  }
  robot_from_human_ = yaw.rotation();
}

std::vector<double> TrackingMeasure::position_errors(const TrackedRow& row) const {
  std::vector<double> errors;
  errors.reserve(frames_);
  for (int frame = 0; frame < frames_; ++frame) {
    errors.push_back(kInCm * (have(frame, row) - robot_from_human_ * want(frame, row)).norm());
  }
  return errors;
}

std::vector<double> TrackingMeasure::rotation_errors(const TrackedRow& row) const {
  std::vector<double> errors;
  errors.reserve(frames_);
  for (int frame = 0; frame < frames_; ++frame) {
    const Eigen::Quaterniond between =
        wanted_rotation(frame, row).conjugate() * tracks_.kept(frame, row.body).rotation;
    errors.push_back(2.0 * kDegreesPerRadian *
                     portable::atan2(between.vec().norm(), std::abs(between.w())));
  }
  return errors;
}

void TrackingMeasure::measure_rows() const {
  std::vector<double> positions, rotations;
  for (const TrackedRow& row : rows_) {
    TrackingRow result;
    result.table = row.table + 1;
    result.body = draft_.clip.robot().bodies()[row.task->body].name;
    result.bone = bone_name(row.bone);
    const bool judged = row.table == judged_table();
    const bool is_last =
        std::none_of(&row + 1, rows_.data() + rows_.size(),
                     [&](const TrackedRow& later) { return later.body == row.body; });
    if (has_position(row)) {
      const std::vector<double> errors = position_errors(row);
      if (judged) append(positions, errors);
      if (is_last) result.position_errors_cm.assign(errors.begin(), errors.end());
      result.position_cm = mean(errors);
      result.position_p95_cm = percentile(errors, 95.0);
    }
    if (row.task->compares_rotation()) {
      const std::vector<double> errors = rotation_errors(row);
      if (judged) append(rotations, errors);
      if (is_last) result.rotation_errors_deg.assign(errors.begin(), errors.end());
      result.rotation_deg = mean(errors);
      result.rotation_p95_deg = percentile(errors, 95.0);
    }
    if (result.position_cm || result.rotation_deg) draft_.report.tracking.push_back(result);
  }
  if (!positions.empty()) {
    draft_.set("track_pos_cm", mean(positions), percentile(positions, 95.0));
  }
  if (!rotations.empty()) {
    draft_.set("track_rot_deg", mean(rotations), percentile(rotations, 95.0));
  }
}

// The first row of a bone, or null. Configurations map a foot to one of two bones, so both are
// tried.
const TrackedRow* TrackingMeasure::row_of(Bone bone) const {
  const auto found = std::ranges::find(rows_, bone, &TrackedRow::bone);
  if (found != rows_.end()) return &*found;
  const bool is_foot = limb_bone(bone) == LimbBone::kFoot;
  return is_foot ? row_of(side_bone(side_of(bone), LimbBone::kFootMod)) : nullptr;
}

void TrackingMeasure::measure_root_path() const {
  if (draft_.clip.robot().fixed_base() || root_path_.empty()) return;
  std::vector<Vector3d> found, wanted;
  for (int frame = 0; frame < frames_; ++frame) {
    found.push_back(tracks_.kept(frame, root_body_).translation);
    wanted.push_back(robot_from_human_ * root_path_[static_cast<std::size_t>(frame)]);
  }
  if (const auto slide = root_slide(found, wanted, draft_.clip.rate().fps())) {
    draft_.set("root_slide_mean", *slide);
  }
  if (const auto kept = bounce_kept(found, wanted, draft_.clip.rate().fps())) {
    draft_.set("root_bounce_pct", 100.0 * *kept);
  }
}

void TrackingMeasure::measure() const {
  measure_rows();
  measure_limbs();
  measure_root_path();
  if (const auto trunk = trunk_bodies()) {
    measure_trunk_lean(draft_, tracks_, *trunk, human_, robot_from_human_, posture_, frames_);
  }
}

std::vector<int> tracked_bodies(const ResolvedConfig& config) {
  std::vector<int> bodies = {config.root_body};
  for (const auto& [used, tasks] : config.match_tables) {
    for (const ConfigTask& task : tasks) {
      if (task.body >= 0 && std::ranges::find(bodies, task.body) == bodies.end()) {
        bodies.push_back(task.body);
      }
    }
  }
  return bodies;
}

}  // namespace retarget
