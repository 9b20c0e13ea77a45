#pragma once

#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "human/skeleton/human_clip.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/report_parts.h"
#include "retarget/human.h"

namespace retarget {

/// A flight phase of the source.
struct SourceFlight {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  double peak = 0.0;       ///< Maximum height of the lower foot above its standing height, metres.
};

/// Finds the flights of a human: no toe and no ankle is within ContactOptions::begin_height
/// (scaled) of its standing height for ContactOptions::shortest, while the hips rise and fall as in
/// free fall. The second condition excludes feet that are lifted while another body part is
/// supported.
///
/// With T the duration of the flight and z the height of the hips, free fall raises z above the
/// straight line between its ends by g T^2 / 8. Two fifths of that are required, because the hips
/// are not the centre of mass.
/// centre of mass.
[[nodiscard]] std::vector<SourceFlight> find_flights(const HumanClip& human,
                                                     const ContactPlan& contacts, int frames,
                                                     const ContactOptions& options = {});

/// Measures the height of the robot's soles during the source's flights.
/// @param scale  of the robot's foot paths relative to the source's.
void measure_flights(const ReportBuilder& draft, const BodyTracks& tracks,
                     const std::vector<SourceFlight>& flights, double scale);

/// Height of the lowest part of the source above the height at which such a part supports a body:
/// feet above their standing heights; knees, elbows, hands, seat and back above the heights at
/// which they rest. Metres, at least 0.
[[nodiscard]] double source_clearance(const SourceFeet& source, const ContactPlan& contacts,
                                      int frame);

/// Measures in how many frames the robot hovers: its lowest point is more than 2 cm above the
/// source's clearance times the scale, while the source is not in flight.
/// @param touches_scene  by frame: the robot touches a body of its scene and does not hover; empty:
///     no scene.
/// @param scale  of the robot's foot paths relative to the source's.
void measure_hovering(const ReportBuilder& draft, const BodyTracks& tracks,
                      const SourceFeet& source, const ContactPlan& contacts,
                      const std::vector<SourceFlight>& flights,
                      const std::vector<char>& touches_scene, double scale);

}  // namespace retarget
