#pragma once

#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/draft.h"
#include "judge/quality/flight_metrics.h"

namespace retarget {

/// Height of the lowest part of the source above the height at which such a part supports a body:
/// feet above their standing heights; knees, elbows, hands, seat and back above the heights at
/// which they rest. Metres, at least 0.
[[nodiscard]] double source_clearance(const SourceFeet& source, const ContactPlan& contacts,
                                      int frame);

/// Measures in how many frames the robot hovers: its lowest point is more than 2 cm above the
/// source's clearance times the scale, while the source is not in flight.
/// @param scale  of the robot's foot paths relative to the source's.
void measure_hovering(const ReportBuilder& draft, const BodyTracks& tracks,
                      const SourceFeet& source, const ContactPlan& contacts,
                      const std::vector<SourceFlight>& flights, double scale);

}  // namespace retarget
