#pragma once

#include <vector>

#include "human/contact_plan.h"
#include "human/human_clip.h"
#include "quality/body_tracks.h"
#include "quality/draft.h"
#include "retarget/human.h"

namespace retarget {

/// A time in which the source is in the air.
struct SourceFlight {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  double peak = 0.0;       ///< Most that the lower foot rises above its standing height, metres.
};

/// The flights of a human: no toe and no ankle within ContactOptions::begin_height (scaled) of its
/// standing height for ContactOptions::shortest, while the hips rise and fall as what falls freely
/// does. The second keeps out feet that are lifted while something else carries the body.
///
/// With T the time of the flight and z the hips' height, free fall has z rise above the straight
/// line between its ends by g T^2 / 8; two fifths of that are asked for, as the hips are not the
/// centre of mass.
[[nodiscard]] std::vector<SourceFlight> find_flights(const HumanClip& human,
                                                     const ContactPlan& contacts, int frames,
                                                     const ContactOptions& options = {});

/// How high the robot's soles come in the source's flights.
/// @param scale  of the robot's foot paths against the source's.
void measure_flights(const ReportBuilder& draft, const BodyTracks& tracks,
                     const std::vector<SourceFlight>& flights, double scale);

}  // namespace retarget
