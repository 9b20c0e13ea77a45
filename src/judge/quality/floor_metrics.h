#pragma once

#include "human/gait/contact_plan.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/posture.h"
#include "judge/quality/report_parts.h"

namespace retarget {

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

}  // namespace retarget
