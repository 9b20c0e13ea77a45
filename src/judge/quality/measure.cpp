#include "retarget/measure.h"
#include "judge/quality/body_metrics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/edit_contacts.h"
#include "human/gait/seats.h"
#include "human/gait/source_feet.h"
#include "human/gait/standing_heights.h"
#include "human/gait/surface_contacts.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/flight_metrics.h"
#include "judge/quality/joint_demand.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "judge/quality/scene_metrics.h"
#include "judge/quality/similarity_metrics.h"
#include "judge/quality/tracking_measure.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/limit_diagnosis.h"
#include "solve/targets/targets.h"

namespace retarget {
namespace {

// Scale from the human's to the robot's foot paths: rise of a foot's target per metre of rise of
// the human's foot. Empty without a foot target.
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

// Measures a robot with a fixed base against the human in its base frame (HeldBase). It has no
// floor.
void measure_held(const ReportBuilder& draft, const BodyTracks& tracks, const QualitySource& source,
                  const LimitSet& limits) {
  const int frames = std::min(draft.clip.frame_count(), source.human->frame_count);
  draft.report.source_frames = frames;
  const HumanClip seen = seen_by(HeldBase(draft.clip.robot(), *source.config),
                                 source.config->root_bone, *source.human);
  QualitySource held = source;
  held.human = &seen;
  if (frames == 0) return;
  const Posture posture = upright_posture(draft.clip.frame_count());
  TrackingMeasure(draft, tracks, held, limits, posture, frames).measure();
}

// The feet of a source and the ground on which they stand. The source may be longer; only the
// frames of the motion matter.
struct SourceGround {
  SourceGround(const QualitySource& source, int frames) : feet(*source.human, frames) {
    const SourceFeet at_source_speed = feet.before_pace(source.pace);
    contacts = source.scene == nullptr ? find_contacts(at_source_speed)
                                       : find_contacts_on_ground(*source.scene, at_source_speed);
    edit_contacts(source.contact_edits, feet, contacts);
    if (source.scene == nullptr && feet.foot_count > 0) floor = floor_height(contacts);
  }

  SourceFeet feet;
  ContactPlan contacts;
  double floor = 0.0;  // Height, metres. The floor of a scene is at 0.
};

// Whether a body that is upright has no known support for seconds.
bool stands_on_nothing(const std::vector<char>& unsupported, const Posture& posture,
                       const FrameRate& rate) {
  constexpr double kSeconds = 2.0;
  int frames = 0;
  for (std::size_t i = 0; i < unsupported.size(); ++i) {
    if (unsupported[i] != 0 && posture.is_upright(static_cast<int>(i))) ++frames;
  }
  return frames * rate.frame_time() >= kSeconds;
}

// Compares the robot's contacts with floor and scene with those of its source.
void measure_on_floor(const ReportBuilder& draft, const BodyTracks& tracks,
                      const QualitySource& source, const SourceGround& ground,
                      const Eigen::Quaterniond& robot_from_human, const Posture& posture,
                      int frames) {
  const HumanClip& human = *source.human;
  const bool tracked = source.config != nullptr;
  const SourceFeet& feet = ground.feet;
  const ContactPlan& contacts = ground.contacts;
  draft.report.contacts = contacts.of_ends();
  measure_contacts(draft, tracks, contacts, frames);
  measure_stances(draft, tracks, contacts, posture);
  const auto scale = tracked ? foot_scale(source, draft.clip.robot()) : std::nullopt;
  if (tracked) {
    measure_supports(draft, *source.config, feet, robot_from_human, contacts, scale.value_or(1.0));
  }
  std::vector<char> touches_scene;
  if (tracked && scale && source.scene != nullptr) {
    touches_scene = measure_scene(
        draft, *source.config,
        {*source.scene, human, feet, contacts, *scale, source.around_robot, source.pace}, frames);
  }
  const std::vector<SourceFlight> flights = find_flights(human, contacts, frames);
  if (scale) measure_flights(draft, tracks, flights, *scale);
  measure_hovering(draft, tracks, feet, contacts, flights, touches_scene, scale.value_or(1.0));
  if (feet.foot_count > 0) {
    const std::vector<SeatRest> seats = find_seats(human, poses_of(human), contacts);
    const std::vector<char> unsupported =
        measure_missing_surfaces(draft, tracks, contacts, frames, seats, touches_scene);
    draft.report.lost_stances =
        !tracks.soles.empty() && draft.report.find("stance_pct") == nullptr &&
        (source.up_is_uncertain || stands_on_nothing(unsupported, posture, human.rate));
  }
}

}  // namespace

std::shared_ptr<const SceneWorld> robot_world(const QualitySource& source, const Robot& robot) {
  if (source.scene == nullptr || source.config == nullptr) return nullptr;
  const auto scale = foot_scale(source, robot);
  if (!scale) return nullptr;
  return std::make_shared<const SceneWorld>(scaled_world(*source.scene, *scale));
}

void add_limited_joints(const RobotClip& clip, const LimitSet& limits, const QualitySource& source,
                        QualityReport& report) {
  constexpr double kMinShare = 0.05;
  const HumanClip& human = *source.human;
  if (source.config == nullptr || human.frame_count < clip.frame_count()) return;
  const HumanPoseSource poses = poses_of(human);
  const auto targets =
      make_targets(human, poses, clip.robot(), *source.config, source.scale, source.trunk, &limits);
  // Without the bones that the configuration requires, there are no targets.
  if (!targets) return;
  for (const JointAtLimit& found :
       joints_at_limits(clip, *source.config, *targets, poses, limits, kMinShare)) {
    report.limited_joints.push_back(limited_joint(found, clip.robot(), clip.frame_count()));
  }
}

QualityReport measure_quality(const RobotClip& clip, const LimitSet& limits,
                              const QualitySource* source, const QualityOptions& options) {
  QualityReport report;
  report.robot = clip.robot().name();
  report.frames = clip.frame_count();
  report.fps = clip.rate().fps();
  report.limits = limits.name;
  const RobotProfile& profile = clip.robot().profile();
  if (profile.soles_estimated && !clip.robot().fixed_base()) {
    report.estimated_soles = profile.soles_source.empty() ? "estimated" : profile.soles_source;
  }
  const bool tracked = source != nullptr && source->config != nullptr;
  if (tracked) {
    if (const auto leg = robot_leg_length(clip.robot(), *source->config)) report.leg = *leg;
  }
  const ReportBuilder draft{clip, options, report};
  measure_joints(draft, limits);
  measure_body_accelerations(draft);
  const BodyTracks tracks =
      track_bodies(clip, tracked ? tracked_bodies(*source->config) : std::vector<int>(),
                   options.self_collision_stride);
  measure_bodies(draft, tracks);
  const bool held = tracked && clip.robot().fixed_base();
  const int frames =
      source != nullptr ? std::min(clip.frame_count(), source->human->frame_count) : 0;
  std::optional<SourceGround> ground;
  Posture posture = upright_posture(clip.frame_count());
  if (source != nullptr && !held) {
    ground.emplace(*source, frames);
    posture =
        find_posture(*source->human, clip.frame_count(), frames, ground->floor, source->scene);
  }
  if (posture.lying_pct) draft.set("lying_pct", *posture.lying_pct);
  std::optional<JointDemand> demand;
  if (tracked && frames > 0) demand.emplace(clip, limits, *source, frames);
  measure_at_limits(draft, limits, posture, demand ? &*demand : nullptr);
  if (held) {
    measure_held(draft, tracks, *source, limits);
  } else if (source != nullptr) {
    report.source_frames = frames;
    measure_source_slide(draft, *source->human, frames);
    std::optional<TrackingMeasure> tracking;
    if (tracked && frames > 0) tracking.emplace(draft, tracks, *source, limits, posture, frames);
    const Eigen::Quaterniond robot_from_human =
        tracking ? tracking->robot_from_human() : Eigen::Quaterniond::Identity();
    measure_on_floor(draft, tracks, *source, *ground, robot_from_human, posture, frames);
    if (tracking) tracking->measure();
  }
  std::ranges::sort(report.values, {}, &MetricValue::metric);
  return report;
}

}  // namespace retarget
