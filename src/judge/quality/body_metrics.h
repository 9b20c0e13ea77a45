#pragma once

#include <Eigen/Geometry>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/joint_demand.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Measures limits, speeds, jumps and accelerations of the output joints, and jerk and jumps of the
/// root.
/// @param limits  limit set of limit_pct; the other sets of the robot go to limit_sets.
void measure_joints(const ReportBuilder& draft, const LimitSet& limits);

/// Measures the accelerations of the root and, for a robot with mass, of the centre of mass.
void measure_body_accelerations(const ReportBuilder& draft);

/// Measures the share of the upright frames in which joints are at a limit, and finds the joint
/// with the most such frames: separately for frames in which the human's pose demands the limit,
/// and for the others. Adds no metric if the body is never upright.
/// @param limits  joint ranges.
/// @param demand  null: unknown; no frame then counts as demanded.
void measure_at_limits(const ReportBuilder& draft, const LimitSet& limits, const Posture& posture,
                       JointDemand* demand);

/// Measures floor penetration, floating, slip of flat feet and self-collision. Uses no source.
void measure_bodies(const ReportBuilder& draft, const BodyTracks& tracks);

/// Measures slip, drift, height and agreement of the robot's foot contacts while the source's feet
/// are in contact with the floor.
/// @param frames  number of frames that motion and source share.
void measure_contacts(const ReportBuilder& draft, const BodyTracks& tracks,
                      const ContactPlan& contacts, int frames);

/// Measures slip, drift and height of the robot's soles while the source's feet stand on the floor
/// and its body is upright.
void measure_stances(const ReportBuilder& draft, const BodyTracks& tracks,
                     const ContactPlan& contacts, const Posture& posture);

/// Measures slip, drift and height of the robot's knees, elbows, hands, seat and back while those
/// of the source rest on the floor; 0 if they never do. Slip and drift are relative to the slide of
/// the source (SlideTracker). Adds no metric for a robot without collision shapes on these parts.
/// @param robot_from_human  constant yaw that aligns the source with the robot.
/// @param scale             scale from the source's to the robot's foot paths.
void measure_supports(const ReportBuilder& draft, const ResolvedConfig& config,
                      const SourceFeet& source, const Eigen::Quaterniond& robot_from_human,
                      const ContactPlan& contacts, double scale);

}  // namespace retarget
