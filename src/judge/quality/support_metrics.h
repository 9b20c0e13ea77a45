#pragma once

#include <Eigen/Geometry>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "judge/quality/report_parts.h"
#include "retarget/retargeting_config.h"

namespace retarget {

/// Measures slip, drift and height of the robot's knees, elbows, hands, seat and back while those
/// of the source rest on the floor; 0 if they never do. Slip and drift are relative to the slide of
/// the source (SlideTracker). Adds no metric for a robot without collision shapes on these parts.
/// @param robot_from_human  constant yaw that aligns the source with the robot.
/// @param scale             scale from the source's to the robot's foot paths.
void measure_supports(const ReportBuilder& draft, const ResolvedConfig& config,
                      const SourceFeet& source, const Eigen::Quaterniond& robot_from_human,
                      const ContactPlan& contacts, double scale);

}  // namespace retarget
