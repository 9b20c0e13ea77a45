#pragma once

#include <array>
#include <vector>

#include "human/human_clip.h"
#include "human/source_feet.h"
#include "retarget/human.h"

namespace retarget {

/// Of a foot on its sole the ankle is so far above where the toes begin, metres, at least.
inline constexpr double kUprightRise = 0.03;
/// Height of the unit vector that points up from a foot with its whole sole down, at least: it is at
/// most 41 degrees from the vertical.
inline constexpr double kSoleUp = 0.75;

/// When a foot is in contact. Speeds and lengths are those of a body whose leg (hip to knee to ankle)
/// is kUsualSourceLeg long; others are measured with theirs scaled in proportion.
struct ContactOptions {
  double begin_speed = 0.15;    ///< A contact begins below this speed, m/s (all three axes),
  double begin_height = 0.04;   ///< and this near the standing height, metres;
  double end_speed = 0.25;      ///< it lasts until the foot is faster than this
  double end_height = 0.06;     ///< or this far from it.
  double shortest = 0.1;        ///< Shorter contacts are none, seconds.
  double support_time = 0.15;   ///< A foot above the floor stands when it is slow for so long,
  double support_drift = 0.02;  ///< and moves no farther than this, metres.
  bool goes_on = false;         ///< More is to come: what lasts to the end may be shorter so far.
};

/// Those that stand on the floor, not on something above it.
[[nodiscard]] std::vector<ContactPhase> on_floor(std::vector<ContactPhase> phases);

/// Heights at which the source's feet stand on the floor.
struct StandingHeights {
  double ankle = 0.0, toe = 0.0;  ///< World, metres.
  bool found = false;             ///< False: no foot stands long enough; a guess.
  double ankle_over_heel = 0.0;   ///< Metres, of feet whose soles are known; else ankles are heels.

  [[nodiscard]] double of(int end) const { return end == kHeelEnd ? ankle - ankle_over_heel : toe; }
};

/// When one end of a foot is in contact.
struct EndContacts {
  std::vector<ContactPhase> phases;  ///< In order of time.
  /// By frame, in phases: the end is as high as it stands, and not on its side, edge or tip.
  std::vector<char> level;
};

/// When each of kSupportBones lies on the floor.
using BodyContacts = std::array<std::vector<ContactPhase>, kSupportBones.size()>;

/// When and on what the feet of a human stand, heel and toe apart. Feet: 0 left, 1 right.
struct ContactPlan {
  double scale = 1.0;  ///< Of lengths and speeds: leg length / kUsualSourceLeg.
  StandingHeights standing;
  std::array<std::array<EndContacts, 2>, 2> ends;  ///< By foot, and kHeelEnd or kToeEnd.
  /// Whole feet: both ends in contact with one thing for ContactOptions::shortest, the ankle no lower than
  /// it stands, where that is known (a foot that lies has it lower). Of a foot without a toe joint:
  /// its heel.
  std::array<std::vector<ContactPhase>, 2> phases;
  /// The parts of these in which the foot is on its sole.
  std::array<std::vector<ContactPhase>, 2> soles;
  /// When what else may carry the body (kSupportBones) lies on the floor.
  BodyContacts bodies;

  /// Whether a whole foot is in contact in a frame.
  [[nodiscard]] bool in_contact(int foot, int frame) const;
  /// Whether one end of it is.
  [[nodiscard]] bool in_contact(int foot, int end, int frame) const;
  /// What is written out with a motion.
  [[nodiscard]] SourceContacts of_ends() const;
};

/// When knees, elbows, hands, seat and back lie on the floor: they are as slow as feet in contact, and as low
/// as these joints are in a body that kneels, leans, sits or lies on them.
/// @param scale     of lengths and speeds, as ContactPlan's.
/// @param contacts  overwritten, with the memory that it has.
void find_body_contacts(const SourceFeet& source, const StandingHeights& standing, double scale,
                        const ContactOptions& options, BodyContacts& contacts);

/// Heights at which feet stand. Learned from slow feet near the lowest height that have the pitch of
/// a standing foot: clips in which people lie have lower toes than those they stand on. Where there
/// are too few, a guess: the toes' is a low percentile of the lower toe, the ankle's is over it by
/// the median of slow and low feet, or by a usual rise. Of feet without toe joints: a low percentile
/// of the lower ankle, toes by the usual rise below it.
[[nodiscard]] StandingHeights find_standing_heights(const SourceFeet& source,
                                                    const ContactOptions& options = {});

/// Finds when the feet of a body stand.
///
/// One end of a foot is in contact with the floor from when it is slower than begin_speed and less than
/// begin_height above its standing height until it passes end_speed or end_height (all times the
/// scale), for at least `shortest`. That is 3 frames at 30 fps, so no clip of fewer has a contact
/// unless `shortest` is made so. Thresholds with hysteresis are in use everywhere (Holden's motion
/// matching: 0.15 m/s; HuMoR: 4 cm).
///
/// A foot above the floor stands on something, a box or a stair, when it is as still as feet are
/// that carry a body, for nothing but the foot itself tells of what it stands on: upright, both ends
/// slow for support_time and at one place within support_drift. Feet that are held in the air hardly
/// ever are; those that are lose nothing when they stay where they are. Heel and toe have one height
/// where they differ by little: the sole lies flat. Frames around it in which an end has come or not
/// yet gone belong to it. Again and again, of a clip that grows: ContactPlanner (contact_planner.h).
[[nodiscard]] ContactPlan find_contacts(const SourceFeet& source,
                                        const ContactOptions& options = {});
[[nodiscard]] ContactPlan find_contacts(const HumanClip& human, const ContactOptions& options = {});

/// The parts of a foot's phases in which the direction that is up when it stands is at most 41
/// degrees from the vertical, as far as they last `shortest` yet; a phase that is whole stays as it
/// is. Where nobody stands, as in crawling, heights of feet that lie on the instep pass for those of
/// standing ones, and feet on their edge are as high as some.
/// @param soles  overwritten, with the memory that it has.
void phases_on_sole(const SourceFeet& source, int foot, const std::vector<ContactPhase>& phases,
                    double shortest, std::vector<ContactPhase>& soles);

}  // namespace retarget
