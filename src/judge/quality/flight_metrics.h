#pragma once

#include <vector>

#include "human/gait/seats.h"
#include "human/gait/source_feet.h"
#include "judge/quality/body_tracks.h"
#include "judge/quality/report_parts.h"
#include "retarget/human.h"

namespace retarget {

/// A flight phase of the source.
struct SourceFlight {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  double peak = 0.0;       ///< Maximum height of the lower foot above its standing height, metres.
};

/// Finds the flights of a human. A flight is an interval of at least ContactOptions::shortest in
/// which all toes and ankles are more than ContactOptions::begin_height (scaled) above their
/// standing heights, and the hips move as in free fall. The second condition excludes lifted feet
/// while another body part carries the body.
///
/// In free fall of duration T, the height of the hips exceeds the straight line between its end
/// points by up to g T^2 / 8. The test requires two fifths of this, because the hips are not the
/// centre of mass.
/// @param frames  number of frames to search.
[[nodiscard]] std::vector<SourceFlight> find_flights(const HumanClip& human,
                                                     const ContactPlan& contacts, int frames);

/// Measures the peak height of the robot's soles in the source's flights.
/// @param scale  scale from the source's to the robot's foot paths.
void measure_flights(const ReportBuilder& draft, const BodyTracks& tracks,
                     const std::vector<SourceFlight>& flights, double scale);

/// Clearance of the lowest part of the source, metres; at least 0. The clearance of a foot is its
/// height above its standing height; that of knees, elbows, hands, seat and back is their height
/// above the height at which they rest on the floor.
[[nodiscard]] double source_clearance(const SourceFeet& source, const ContactPlan& contacts,
                                      int frame);

/// Measures in how many frames the robot hovers: its lowest point is more than 2 cm above the
/// source's clearance times `scale`, while the source is not in flight.
/// @param touches_scene  one entry per frame: whether the robot touches a body of its scene, and
///   therefore does not hover; empty: no scene.
/// @param scale          scale from the source's to the robot's foot paths.
void measure_hovering(const ReportBuilder& draft, const BodyTracks& tracks,
                      const SourceFeet& source, const ContactPlan& contacts,
                      const std::vector<SourceFlight>& flights,
                      const std::vector<char>& touches_scene, double scale);

/// Measures in how many frames only surfaces that the scene lacks carry the source: an end of a
/// foot is in contact above the floor without another part on the floor, or the human sits on a
/// raised seat; and the robot touches no body of its scene. Flights of at most a second from such a
/// frame to another one are included. Frames are compared with those in which the body is carried
/// at all, or flies between contacts of the same kind: the higher a run is above the floor, the
/// fewer contacts are known. These are at least a quarter of all frames: few known frames say
/// little about a motion. Frames without a known support count as well while the robot stays in the
/// air, more than 2 cm above the floor, for longer than a second.
/// @param touches_scene  see measure_hovering().
/// @return by frame: whether no support of the source is known
std::vector<char> measure_missing_surfaces(const ReportBuilder& draft, const BodyTracks& tracks,
                                           const ContactPlan& contacts, int frames,
                                           const std::vector<SeatRest>& seats,
                                           const std::vector<char>& touches_scene);

}  // namespace retarget
