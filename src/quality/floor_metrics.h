#pragma once

#include "human/contact_plan.h"
#include "quality/body_tracks.h"
#include "quality/draft.h"

namespace retarget {

/// Penetration of the floor, floating, slip of flat feet, self-collision: what needs no source.
void measure_bodies(const ReportBuilder& draft, const BodyTracks& tracks);

/// What the robot's feet do while the source's are in contact with the floor.
/// @param frames  of both.
void measure_contacts(const ReportBuilder& draft, const BodyTracks& tracks,
                      const ContactPlan& contacts, int frames);

/// Slip, drift and height of the robot's soles while the source's feet are on theirs, on the floor.
void measure_stances(const ReportBuilder& draft, const BodyTracks& tracks,
                     const ContactPlan& contacts);

}  // namespace retarget
