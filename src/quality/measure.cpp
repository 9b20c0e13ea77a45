#include "quality/measure.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "human/contact_plan.h"
#include "human/human_clip.h"
#include "human/source_feet.h"
#include "pipeline/held_base.h"
#include "pipeline/limb_lengths.h"
#include "pipeline/limit_diagnosis.h"
#include "quality/acceleration_metrics.h"
#include "quality/at_limit_metrics.h"
#include "quality/body_tracks.h"
#include "quality/draft.h"
#include "quality/flight_metrics.h"
#include "quality/floor_metrics.h"
#include "quality/joint_metrics.h"
#include "quality/lying.h"
#include "quality/support_metrics.h"
#include "quality/tracking_metrics.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

// how far the target of a foot rises when the foot is lifted by a metre
std::optional<double> foot_scale(const QualitySource& source, const Robot& robot) {
  const HumanClip& human = *source.human;
  const HumanPoseSource poses = poses_of(human);
  const auto targets = make_targets(human, poses, robot, *source.config, source.scale);
  if (!targets) return std::nullopt;
  for (const Bone bone :
       {Bone::kLeftFootMod, Bone::kLeftFoot, Bone::kRightFootMod, Bone::kRightFoot}) {
    const int target = targets->target_of(bone);
    if (target < 0) continue;
    HumanPose low, high;
    high[bone].translation.z() = 1.0;
    std::vector<Pose> from(static_cast<std::size_t>(targets->target_count())), to = from;
    targets->build(low, from);
    targets->build(high, to);
    const auto index = static_cast<std::size_t>(target);
    return (to[index].translation - from[index].translation).z();
  }
  return std::nullopt;
}

LimitedJoint limited_joint(const JointAtLimit& found, const Robot& robot, int frames) {
  LimitedJoint joint;
  joint.joint = robot.joints()[static_cast<std::size_t>(found.joint)].name;
  joint.at_upper = found.at_upper;
  joint.frames = found.frames;
  joint.frames_pct = 100.0 * found.frames / frames;
  if (found.push) {
    joint.task = bone_name(found.push->bone);
    joint.rotation = found.push->rotation;
    joint.shortfall = (joint.rotation ? kDegreesPerRadian : 100.0) * found.push->shortfall;
  }
  joint.wider_set = found.wider_set;
  if (std::isfinite(found.wider_by)) joint.wider = found.wider_by;
  return joint;
}

// joints that stand at a limit, and the tasks that push them
void find_limited_joints(const ReportBuilder& draft, const LimitSet& limits,
                         const QualitySource& source) {
  constexpr double kMinShare = 0.05;
  const HumanClip& human = *source.human;
  if (human.frame_count < draft.clip.frame_count()) return;
  const HumanPoseSource poses = poses_of(human);
  const auto targets = make_targets(human, poses, draft.clip.robot(), *source.config, source.scale,
                                    TrunkRule::kLines, &limits);
  // a body that lacks what the configuration needs has no targets
  if (!targets) return;
  for (const JointAtLimit& found :
       joints_at_limits(draft.clip, *source.config, *targets, poses, limits, kMinShare)) {
    draft.report.limited_joints.push_back(
        limited_joint(found, draft.clip.robot(), draft.clip.frame_count()));
  }
}

// a robot whose base stands fast has its human before itself, and no floor
void measure_held(const ReportBuilder& draft, const BodyTracks& tracks,
                  const QualitySource& source) {
  const int frames = std::min(draft.clip.frame_count(), source.human->frame_count);
  draft.report.source_frames = frames;
  const HumanClip seen = seen_by(HeldBase(draft.clip.robot(), *source.config),
                                 source.config->root_bone, *source.human);
  QualitySource held = source;
  held.human = &seen;
  measure_tracking(draft, tracks, held, frames);
}

}  // namespace

QualityReport measure_quality(const RobotClip& clip, const LimitSet& limits,
                              const QualitySource* source, const QualityOptions& options) {
  QualityReport report;
  report.robot = clip.robot().name();
  report.frames = clip.frame_count();
  report.fps = clip.rate().fps();
  report.limits = limits.name;
  const ReportBuilder draft{clip, options, report};
  measure_joints(draft, limits);
  measure_body_accelerations(draft);
  measure_at_limits(draft, limits);

  const bool tracked = source != nullptr && source->config != nullptr;
  if (tracked) {
    if (const auto leg = robot_leg_length(clip.robot(), *source->config)) report.leg = *leg;
  }
  const BodyTracks tracks =
      track_bodies(clip, tracked ? tracked_bodies(*source->config) : std::vector<int>(),
                   options.self_collision_stride);
  measure_bodies(draft, tracks);
  if (tracked && clip.robot().fixed_base()) {
    measure_held(draft, tracks, *source);
  } else if (source != nullptr) {
    const int frames = std::min(clip.frame_count(), source->human->frame_count);
    report.source_frames = frames;
    // what stands is learned from the part that is compared
    const ContactPlan contacts = find_contacts(SourceFeet(*source->human, frames));
    report.contacts = contacts.of_ends();
    measure_lying(draft, *source->human, frames);
    measure_contacts(draft, tracks, contacts, frames);
    measure_stances(draft, tracks, contacts);
    if (tracked) measure_supports(draft, *source->config, contacts);
    const auto scale = tracked ? foot_scale(*source, clip.robot()) : std::nullopt;
    if (scale) {
      measure_flights(draft, tracks, find_flights(*source->human, contacts, frames), *scale);
    }
    if (tracked) measure_tracking(draft, tracks, *source, frames);
    if (tracked) find_limited_joints(draft, limits, *source);
  }
  std::ranges::sort(report.values, {}, &MetricValue::metric);
  return report;
}

}  // namespace retarget
