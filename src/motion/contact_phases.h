#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// World positions of a foot's joints, one per frame, metres, z up.
struct FootTrack {
  std::vector<Eigen::Vector3d> ankle;
  std::vector<Eigen::Vector3d> toe;  ///< Where the toes begin; empty: the foot has no such joint.
};

/// When a foot counts as planted. Speeds and lengths are those of a body whose leg (hip to knee to
/// ankle) is reference_leg long; others are measured with theirs scaled in proportion.
struct ContactOptions {
  double begin_speed = 0.15;      ///< A contact begins below this speed, m/s (all three axes),
  double begin_height = 0.04;     ///< and this near the standing heights, metres;
  double end_speed = 0.25;        ///< it lasts until the foot is faster than this
  double end_height = 0.06;       ///< or this far from them.
  double shortest = 0.1;          ///< Shorter contacts are none, seconds.
  double reference_leg = 0.85;    ///< Metres.
  double floor_percentile = 2.0;  ///< Of the lower toe's height: the standing height of toes.
  double upright_rise = 0.03;     ///< Of a foot on its sole the ankle is this far above the toe.
  double usual_rise = 0.06;       ///< The ankle above the toe where no such foot is found.
};

/// Frames [begin, end) in which a foot is planted.
struct ContactPhase {
  int begin = 0;
  int end = 0;

  friend bool operator==(const ContactPhase&, const ContactPhase&) = default;
};

/// Contacts of both feet with the floor.
struct FootContacts {
  double scale = 1.0;                  ///< Leg length / reference_leg.
  double standing_toe_height = 0.0;    ///< World z of the toe joints of planted feet, metres.
  double standing_ankle_height = 0.0;  ///< World z of their ankles, metres.
  std::array<std::vector<ContactPhase>, 2> phases;  ///< Left, right; in order of time.

  /// Whether a foot (0: left, 1: right) is planted in a frame.
  [[nodiscard]] bool planted(int foot, int frame) const;
};

/// Finds when the feet of a body stand.
///
/// A foot is planted while toe and ankle are slow and near the heights that they have when
/// standing: with the speed v = max of both (central differences, one-sided at the ends; a clip of
/// one frame stands still) and h = max(toe - standing toe height, |ankle - standing ankle height|),
/// from v < begin_speed and h < begin_height until v > end_speed or h > end_height (all times the
/// scale), for at least `shortest`. That is 3 frames at 30 fps, so no clip of fewer has a contact
/// unless `shortest` is made so.
///
/// The standing toe height is floor_percentile of the lower toe; the standing ankle height is that
/// plus the median rise of the ankle over the toe of feet that are upright, slow and low: a foot
/// that lies on its side has its ankle too low to be planted. Thresholds with hysteresis are in
/// use everywhere (Holden's motion matching: 0.15 m/s; HuMoR: 4 cm); toe and ankle both, and the
/// learned height, keep toe-offs, heel strikes and lying feet out.
///
/// A foot without a toe joint is judged by its ankle alone, so that feet on their side and on
/// tiptoe are not told apart; if neither has one, the standing ankle height is floor_percentile of
/// the lower ankle, and toes are taken to stand usual_rise below it.
///
/// @param feet        left and right; all tracks that are not empty have one length.
/// @param leg_length  metres, above 0; human/foot_contacts.h measures it.
[[nodiscard]] FootContacts find_contact_phases(const std::array<FootTrack, 2>& feet,
                                               double leg_length, const FrameRate& rate,
                                               const ContactOptions& options = {});

}  // namespace retarget
