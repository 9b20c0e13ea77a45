#pragma once

#include <array>
#include <vector>

#include "human/gait/source_feet.h"
#include "human/skeleton/human_clip.h"
#include "retarget/human.h"

namespace retarget {

/// Least height of the ankle above the start of the toes when the foot is on its sole, metres.
inline constexpr double kUprightRise = 0.03;
/// Least z component of the foot's up vector (unit length) when the whole sole is down: the vector
/// is at most 41 degrees from the vertical.
inline constexpr double kSoleUp = 0.75;

/// Thresholds for foot contacts. Speeds and lengths apply to a body whose leg (hip to knee to
/// ankle) is kUsualSourceLeg long; for other bodies they scale with the leg length.
struct ContactOptions {
  double begin_speed = 0.15;    ///< A contact begins below this speed, m/s (all three axes),
  double begin_height = 0.04;   ///< and within this distance of the standing height, metres.
  double end_speed = 0.25;      ///< A contact ends above this speed, m/s,
  double end_height = 0.06;     ///< or beyond this distance from the standing height, metres.
  double shortest = 0.1;        ///< Contacts shorter than this are ignored, seconds.
  double support_time = 0.15;   ///< A foot above the floor is in contact if it is slow for this
                                ///< time, seconds,
  double support_drift = 0.02;  ///< and moves no farther than this, metres.
  bool goes_on = false;         ///< The clip still grows: a contact that reaches its end may be too
                                ///< short so far.
};

/// Returns the phases on the floor, without those on raised surfaces.
[[nodiscard]] std::vector<ContactPhase> on_floor(std::vector<ContactPhase> phases);

/// Heights of the source's feet when they stand on the floor.
struct StandingHeights {
  double ankle = 0.0, toe = 0.0;  ///< World, metres.
  bool found = false;             ///< False: no foot stands long enough, and the heights are
                                  ///< guesses.
  double ankle_over_heel = 0.0;   ///< Metres, for feet with known soles; otherwise the ankle serves
                                  ///< as heel.

  [[nodiscard]] double of(int end) const { return end == kHeelEnd ? ankle - ankle_over_heel : toe; }
};

/// Contact phases of one end of a foot.
struct EndContacts {
  std::vector<ContactPhase> phases;  ///< Sorted by time.
  /// Per frame of the phases: the end is at its standing height, and the foot does not rest on its
  /// side, edge or tip.
  std::vector<char> level;
};

/// Floor contacts of each of kSupportBones.
using BodyContacts = std::array<std::vector<ContactPhase>, kSupportBones.size()>;

/// Foot contacts of a human, separately for heel and toe. Feet: 0 left, 1 right.
struct ContactPlan {
  double scale = 1.0;  ///< Scale of lengths and speeds: leg length / kUsualSourceLeg.
  StandingHeights standing;
  std::array<std::array<EndContacts, 2>, 2> ends;  ///< Indexed by foot, then by kHeelEnd or
                                                   ///< kToeEnd.
  /// Contact phases of whole feet: both ends touch the same surface for at least
  /// ContactOptions::shortest, and the ankle, where known, is not below its standing height (it is
  /// in a foot that lies down). For a foot without a toe joint: the phases of its heel.
  std::array<std::vector<ContactPhase>, 2> phases;
  /// The parts of `phases` in which the foot rests on its sole.
  std::array<std::vector<ContactPhase>, 2> soles;
  /// Floor contacts of the other bodies that may carry weight (kSupportBones).
  BodyContacts bodies;

  /// Returns whether a whole foot is in contact in a frame.
  [[nodiscard]] bool in_contact(int foot, int frame) const;
  /// Returns whether one end of a foot is in contact in a frame.
  [[nodiscard]] bool in_contact(int foot, int end, int frame) const;
  /// Returns the contacts that are written with a motion.
  [[nodiscard]] SourceContacts of_ends() const;
};

/// Finds when knees, elbows, hands, seat and back rest on the floor. Such a part is as slow as a
/// foot in contact, and its joint is as low as in a body that kneels, leans, sits or lies on it.
/// @param scale     scale of lengths and speeds, as ContactPlan::scale.
/// @param contacts  overwritten; its memory is reused.
void find_body_contacts(const SourceFeet& source, const StandingHeights& standing, double scale,
                        const ContactOptions& options, BodyContacts& contacts);

/// Finds the standing heights of the feet. They are learned from slow feet near the lowest height
/// that have the pitch of a standing foot: toes of people who lie are lower than toes they stand
/// on. With too few such feet the heights are guesses: the toe height is a low percentile of the
/// lower toe, and the ankle is above it by the median over slow, low feet or by a usual rise.
/// Without toe joints: the ankle height is a low percentile of the lower ankle, and the toes are
/// the usual rise below it.
[[nodiscard]] StandingHeights find_standing_heights(const SourceFeet& source,
                                                    const ContactOptions& options = {});

/// Finds the contacts of a human's feet.
///
/// A contact of one end of a foot with the floor begins when the end is slower than begin_speed and
/// within begin_height of its standing height. It lasts until the end passes end_speed or
/// end_height, and for at least `shortest` (all lengths and speeds times the scale). `shortest` is
/// 3 frames at 30 fps, so shorter clips have no contacts unless it is reduced. Thresholds with
/// hysteresis are common practice (Holden's motion matching: 0.15 m/s; HuMoR: 4 cm).
///
/// The source does not describe raised surfaces such as boxes and stairs, so only the foot's motion
/// can reveal a raised stance: the foot is upright, and both ends are slow for support_time and
/// stay within support_drift. Feet held in the air rarely meet this test, and holding those that do
/// at their position does no harm. If the heights of heel and toe differ by little, both get one
/// height: the sole lies flat. Frames around the stance in which only one end is in contact belong
/// to it.
///
/// For a clip that grows, use ContactPlanner (contact_planner.h).
[[nodiscard]] ContactPlan find_contacts(const SourceFeet& source,
                                        const ContactOptions& options = {});
[[nodiscard]] ContactPlan find_contacts(const HumanClip& human, const ContactOptions& options = {});

/// Finds the parts of a foot's phases in which its up vector is at most 41 degrees from the
/// vertical, if they last at least `shortest`. A phase that satisfies this throughout is kept
/// unchanged. The test is needed in clips without standing, such as crawling: there the heights of
/// feet that lie on the instep pass for standing heights, and feet on their edge are at similar
/// heights.
/// @param soles  overwritten; its memory is reused.
void phases_on_sole(const SourceFeet& source, int foot, const std::vector<ContactPhase>& phases,
                    double shortest, std::vector<ContactPhase>& soles);

}  // namespace retarget
