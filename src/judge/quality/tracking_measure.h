#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "human/gait/source_feet.h"
#include "human/skeleton/limb_segments.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/limb_directions.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "judge/quality/similarity_metrics.h"
#include "retarget/human.h"
#include "retarget/measure.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "solve/targets/limb_lengths.h"

namespace retarget {

/// The bodies whose poses TrackingMeasure uses: the root and the bodies of the tables, without
/// duplicates.
[[nodiscard]] std::vector<int> tracked_bodies(const ResolvedConfig& config);

/// A row of a retargeting configuration whose bone the source has.
struct TrackedRow {
  const ConfigTask* task = nullptr;
  int table = 0;  ///< Index of the table, 0 or 1.
  int body = 0;   ///< Index into BodyTracks::kept_bodies.
  Bone bone = Bone::kHips;
  double scale = 1.0;  ///< Scale of the bone's position relative to the root.
};

/// Measures how closely a robot's bodies, limbs, trunk and root follow its source.
class TrackingMeasure {
 public:
  /// All arguments must outlive the result.
  /// @param tracks  contains the poses of tracked_bodies().
  /// @param limits  joint ranges.
  /// @param frames  number of frames that motion and source share, at least one.
  TrackingMeasure(const ReportBuilder& draft, const BodyTracks& tracks, const QualitySource& source,
                  const LimitSet& limits, const Posture& posture, int frames)
      : draft_(draft),
        tracks_(tracks),
        human_(*source.human),
        config_(*source.config),
        limits_(limits),
        posture_(posture),
        frames_(frames),
        leg_(leg_length(human_)) {
    const double ratio = size_ratio(source);
    collect_rows(ratio);
    collect_root_path(ratio);
    root_body_ = kept(config_.root_body).value_or(0);
    if (source.scale == ScaleRule::kLimbs) collect_limb_targets();
    find_yaw();
  }

  void measure() const;
  /// The constant yaw that aligns the human with the robot.
  [[nodiscard]] const Eigen::Quaterniond& robot_from_human() const { return robot_from_human_; }

 private:
  [[nodiscard]] double size_ratio(const QualitySource& source) const;
  void collect_rows(double ratio);
  void collect_root_path(double ratio);
  void collect_limb_targets();
  void find_yaw();
  void measure_rows() const;
  void measure_limbs() const;
  void measure_root_path() const;

  [[nodiscard]] std::optional<int> kept(int body) const {
    const auto found = std::ranges::find(tracks_.kept_bodies, body);
    if (found == tracks_.kept_bodies.end()) return std::nullopt;
    return static_cast<int>(found - tracks_.kept_bodies.begin());
  }
  [[nodiscard]] const Pose& bone_pose(int frame, Bone bone) const {
    return human_.frame(frame)[bone];
  }
  // Position of the body relative to the root, world axes, metres.
  [[nodiscard]] Eigen::Vector3d have(int frame, const TrackedRow& row) const {
    return tracks_.kept(frame, row.body).translation - tracks_.kept(frame, root_body_).translation;
  }
  [[nodiscard]] const Pose& limb_target(int frame, const TrackedRow& row) const {
    return limb_targets_[static_cast<std::size_t>(frame) * limb_target_count_ +
                         static_cast<std::size_t>(target_of_bone_[row.bone])];
  }
  // Target of have(), before the yaw robot_from_human_.
  [[nodiscard]] Eigen::Vector3d want(int frame, const TrackedRow& row) const {
    if (!limb_targets_.empty()) return limb_target(frame, row).translation;
    return row.scale * (bone_pose(frame, row.bone).translation -
                        bone_pose(frame, config_.root_bone).translation);
  }
  [[nodiscard]] Eigen::Quaterniond wanted_rotation(int frame, const TrackedRow& row) const {
    return robot_from_human_ *
           (limb_targets_.empty() ? bone_pose(frame, row.bone).rotation * row.task->rotation_offset
                                  : limb_target(frame, row).rotation);
  }
  [[nodiscard]] bool has_position(const TrackedRow& row) const {
    return row.task->position_weight > 0.0 && row.bone != config_.root_bone;
  }
  // Index of the table that the metrics use: the second, or the first if there is no second.
  [[nodiscard]] int judged_table() const {
    return std::ranges::any_of(rows_, [](const TrackedRow& row) { return row.table == 1; }) ? 1 : 0;
  }
  [[nodiscard]] std::vector<double> position_errors(const TrackedRow& row) const;
  [[nodiscard]] std::vector<double> rotation_errors(const TrackedRow& row) const;
  [[nodiscard]] std::vector<double> limb_angles(const LimbDirections& limb) const;
  [[nodiscard]] std::optional<LimbDirections> directions_of(const LimbSegment& segment,
                                                            const RobotLimbs* limbs) const;
  [[nodiscard]] bool rests(int frame, std::span<const Bone> bones) const;
  [[nodiscard]] std::vector<LimbDirections> hand_directions() const;
  [[nodiscard]] double mean_while_upright(const std::vector<double>& values) const;
  [[nodiscard]] const TrackedRow* row_of(Bone bone) const;
  [[nodiscard]] std::optional<TrunkBodies> trunk_bodies() const;

  const ReportBuilder& draft_;
  const BodyTracks& tracks_;
  const HumanClip& human_;
  const ResolvedConfig& config_;
  const LimitSet& limits_;
  const Posture& posture_;
  const int frames_;
  const double leg_;  // Leg length of the human, metres.
  std::vector<TrackedRow> rows_;
  // By frame and target, relative to the root; empty: no limb scaling.
  std::vector<Pose> limb_targets_;
  std::size_t limb_target_count_ = 0;       // Per frame.
  BoneArray<int> target_of_bone_;           // Every row with a weight has a target.
  std::vector<Eigen::Vector3d> root_path_;  // Target positions of the root by frame.
  int root_body_ = 0;                       // Index into BodyTracks::kept_bodies.
  Eigen::Quaterniond robot_from_human_ = Eigen::Quaterniond::Identity();
};

}  // namespace retarget
