#include "quality/tracking_metrics.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "human/limb_segments.h"
#include "math/so3.h"
#include "math/statistics.h"
#include "math/trigonometry.h"
#include "pipeline/limb_lengths.h"
#include "pipeline/targets.h"
#include "quality/trunk_lean.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/report.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// a row that can be measured: its bone is there
struct Row {
  const ConfigTask* task = nullptr;
  int table = 0;  // 0 or 1
  int body = 0;   // index among the kept bodies
  Bone bone = Bone::kHips;
  double scale = 1.0;
};

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// degrees; of a limb of the robot that has no length, and so points nowhere, a right angle
double limb_angle(const Vector3d& of_human, const Vector3d& of_robot) {
  constexpr double kNoLength = 0.02;  // of the human's
  if (of_robot.norm() < kNoLength * of_human.norm()) return 90.0;
  return kDegreesPerRadian * angle_between(of_human, of_robot);
}

class TrackingMeasure {
 public:
  TrackingMeasure(const ReportBuilder& draft, const BodyTracks& tracks, const QualitySource& source,
                  int frames)
      : draft_(draft),
        tracks_(tracks),
        human_(*source.human),
        config_(*source.config),
        frames_(frames) {
    collect_rows(size_ratio(source));
    root_body_ = kept(config_.root_body).value_or(0);
    if (source.scale == ScaleRule::kLimbs) collect_limb_targets();
    find_yaw();
  }

  void measure() const;

 private:
  [[nodiscard]] double size_ratio(const QualitySource& source) const;
  void collect_rows(double ratio);
  void collect_limb_targets();
  void find_yaw();
  void measure_rows() const;
  void measure_limbs() const;

  [[nodiscard]] std::optional<int> kept(int body) const {
    const auto found = std::ranges::find(tracks_.kept_bodies, body);
    if (found == tracks_.kept_bodies.end()) return std::nullopt;
    return static_cast<int>(found - tracks_.kept_bodies.begin());
  }
  [[nodiscard]] const Pose& bone_pose(int frame, Bone bone) const {
    return human_.frame(frame)[bone];
  }
  // from the root: where the body is, and where its bone wants it
  [[nodiscard]] Vector3d have(int frame, const Row& row) const {
    return tracks_.kept(frame, row.body).translation - tracks_.kept(frame, root_body_).translation;
  }
  [[nodiscard]] const Pose& limb_target(int frame, const Row& row) const {
    return limb_targets_[static_cast<std::size_t>(frame)][row.bone];
  }
  [[nodiscard]] Vector3d want(int frame, const Row& row) const {
    if (!limb_targets_.empty()) return limb_target(frame, row).translation;
    return row.scale * (bone_pose(frame, row.bone).translation -
                        bone_pose(frame, config_.root_bone).translation);
  }
  [[nodiscard]] bool has_position(const Row& row) const {
    return row.task->position_weight > 0.0 && row.bone != config_.root_bone;
  }
  // the table that is judged by: the second, or the first where there is no second
  [[nodiscard]] int judged_table() const {
    return std::ranges::any_of(rows_, [](const Row& row) { return row.table == 1; }) ? 1 : 0;
  }
  [[nodiscard]] std::vector<double> position_errors(const Row& row) const;
  [[nodiscard]] std::vector<double> rotation_errors(const Row& row) const;
  [[nodiscard]] const Row* row_of(Bone bone) const;
  [[nodiscard]] std::optional<TrunkBodies> trunk_bodies() const;

  const ReportBuilder& draft_;
  const BodyTracks& tracks_;
  const HumanClip& human_;
  const ResolvedConfig& config_;
  const int frames_;
  std::vector<Row> rows_;
  std::vector<HumanPose> limb_targets_;  // by frame, from the root; empty: not by limbs
  int root_body_ = 0;
  Eigen::Quaterniond robot_from_human_ = Eigen::Quaterniond::Identity();  // a yaw
};

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

// limb by limb a target is no multiple of its bone's way from the root
void TrackingMeasure::collect_limb_targets() {
  const auto targets = make_targets(human_, poses_of(human_), draft_.clip.robot(), config_,
                                    ScaleRule::kLimbs, TrunkRule::kLines);
  // limbs that cannot be measured: as by height
  if (!targets) return;
  std::vector<Pose> world_from_target(static_cast<std::size_t>(targets->target_count()));
  limb_targets_.resize(static_cast<std::size_t>(frames_));
  const std::vector<Bone> bones = targets->bones();
  for (int frame = 0; frame < frames_; ++frame) {
    targets->build(human_.frame(frame), world_from_target);
    for (std::size_t i = 0; i < bones.size(); ++i) {
      const Pose& pose = world_from_target[i];
      limb_targets_[static_cast<std::size_t>(frame)][bones[i]] = {
          pose.rotation, pose.translation - world_from_target.front().translation};
    }
  }
}

// some data sets turn the motion as a whole: the yaw that brings bones to bodies best
void TrackingMeasure::find_yaw() {
  double sine = 0.0, cosine = 0.0;
  for (const Row& row : rows_) {
    if (row.table != judged_table() || !has_position(row)) continue;
    for (int frame = 0; frame < frames_; ++frame) {
      const Vector3d wanted = want(frame, row), found = have(frame, row);
      sine += wanted.x() * found.y() - wanted.y() * found.x();
      cosine += wanted.x() * found.x() + wanted.y() * found.y();
    }
  }
  const double half = 0.5 * portable::atan2(sine, cosine);
  const auto [half_sine, half_cosine] = portable::sin_cos(half);
  robot_from_human_ = Eigen::Quaterniond(half_cosine, 0.0, 0.0, half_sine);
}

std::vector<double> TrackingMeasure::position_errors(const Row& row) const {
  std::vector<double> errors;
  errors.reserve(frames_);
  for (int frame = 0; frame < frames_; ++frame) {
    errors.push_back(kInCm * (have(frame, row) - robot_from_human_ * want(frame, row)).norm());
  }
  return errors;
}

std::vector<double> TrackingMeasure::rotation_errors(const Row& row) const {
  std::vector<double> errors;
  errors.reserve(frames_);
  for (int frame = 0; frame < frames_; ++frame) {
    const Eigen::Quaterniond wanted =
        robot_from_human_ * (limb_targets_.empty()
                                 ? bone_pose(frame, row.bone).rotation * row.task->rotation_offset
                                 : limb_target(frame, row).rotation);
    const Eigen::Quaterniond between = wanted.conjugate() * tracks_.kept(frame, row.body).rotation;
    errors.push_back(2.0 * kDegreesPerRadian *
                     portable::atan2(between.vec().norm(), std::abs(between.w())));
  }
  return errors;
}

void TrackingMeasure::measure_rows() const {
  std::vector<double> positions, rotations;
  for (const Row& row : rows_) {
    TrackingRow result;
    result.table = row.table + 1;
    result.body = draft_.clip.robot().bodies()[row.task->body].name;
    result.bone = bone_name(row.bone);
    const bool judged = row.table == judged_table();
    const bool is_last = std::none_of(&row + 1, rows_.data() + rows_.size(),
                                      [&](const Row& later) { return later.body == row.body; });
    if (has_position(row)) {
      const std::vector<double> errors = position_errors(row);
      if (judged) append(positions, errors);
      if (is_last) result.position_errors_cm.assign(errors.begin(), errors.end());
      result.position_cm = mean(errors);
      result.position_p95_cm = percentile(errors, 95.0);
    }
    if (row.task->rotation_weight > 0.0) {
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

// the first row of a bone; of feet, which follow either of two bones, of one of them
const Row* TrackingMeasure::row_of(Bone bone) const {
  const auto found = std::ranges::find(rows_, bone, &Row::bone);
  if (found != rows_.end()) return &*found;
  const bool is_foot = limb_bone(bone) == LimbBone::kFoot;
  return is_foot ? row_of(side_bone(side_of(bone), LimbBone::kFootMod)) : nullptr;
}

void TrackingMeasure::measure_limbs() const {
  // between the joints' centres where the robot's tree tells them, else between the bodies' origins
  const Robot& robot = draft_.clip.robot();
  const auto limbs = robot.fixed_base() ? robot_arms(robot, config_) : robot_limbs(robot, config_);
  std::vector<double> all;
  double worst = 0.0;
  for (const LimbSegment& segment : kLimbSegments) {
    BoneArray<const Row*> rows{nullptr};
    bool known = true;
    for (const Bone bone : segment.bones()) {
      rows[bone] = human_.has(bone) ? row_of(bone) : nullptr;
      known = known && rows[bone] != nullptr;
    }
    if (!known) continue;
    std::vector<double> angles;
    angles.reserve(frames_);
    for (int frame = 0; frame < frames_; ++frame) {
      const Vector3d of_human =
          segment.direction([&](Bone bone) { return bone_pose(frame, bone).translation; });
      const Vector3d of_robot = segment.direction([&](Bone bone) -> Vector3d {
        const Pose& body = tracks_.kept(frame, rows[bone]->body);
        return limbs ? Vector3d(body * limbs->body_from_joint[rows[bone]->bone]) : body.translation;
      });
      angles.push_back(limb_angle(robot_from_human_ * of_human, of_robot));
    }
    worst = std::max(worst, mean(angles));
    draft_.report.segments.push_back({segment.name, mean(angles), percentile(angles, 95.0)});
    append(all, angles);
  }
  if (all.empty()) return;
  draft_.set("limb_angle_deg", mean(all), percentile(all, 95.0));
  draft_.set("worst_limb_angle_deg", worst);
}

// nothing where a hip or a shoulder follows no bone; as limbs, between origins where the tree does
// not tell where joints are
std::optional<TrunkBodies> TrackingMeasure::trunk_bodies() const {
  const auto limbs = robot_limbs(draft_.clip.robot(), config_);
  TrunkBodies trunk;
  std::size_t next = 0;
  for (const Bone bone : kTrunkBones) {
    const Row* row = row_of(bone);
    if (row == nullptr) return std::nullopt;
    trunk.bodies[next] = row->body;
    trunk.body_from_joint[next++] =
        limbs ? limbs->body_from_joint[row->bone] : Vector3d(Vector3d::Zero());
  }
  return trunk;
}

void TrackingMeasure::measure() const {
  measure_rows();
  measure_limbs();
  if (const auto trunk = trunk_bodies()) {
    measure_trunk_lean(draft_, tracks_, *trunk, human_, robot_from_human_, frames_);
  }
}

}  // namespace

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

void measure_tracking(const ReportBuilder& draft, const BodyTracks& tracks,
                      const QualitySource& source, int frames) {
  if (frames == 0 || tracks.kept_bodies.empty()) return;
  TrackingMeasure(draft, tracks, source, frames).measure();
}

}  // namespace retarget
