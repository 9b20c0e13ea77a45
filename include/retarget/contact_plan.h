#pragma once

#include <array>
#include <vector>

#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// The ends of a foot. The heel moves with the ankle.
inline constexpr int kHeelEnd = 0, kToeEnd = 1;

/// Length of thigh plus shank of the body to which ContactOptions apply, metres.
inline constexpr double kUsualSourceLeg = 0.85;

/// Parts other than the feet that may support the body, by the joint that they surround: knees,
/// elbows, hands, seat and back.
inline constexpr std::array kSupportBones = {
    Bone::kLeftLeg,  Bone::kRightLeg,  Bone::kLeftForeArm, Bone::kRightForeArm,
    Bone::kLeftHand, Bone::kRightHand, Bone::kHips,        Bone::kSpine2};

/// Smallest height of the ankle above the toe joint of a foot that stands on its sole, metres.
inline constexpr double kUprightRise = 0.03;

/// Thresholds for foot contacts. Speeds and lengths apply to a body whose leg (hip to knee to
/// ankle) is kUsualSourceLeg long; for other bodies they scale with the leg length.
struct ContactOptions {
  double begin_speed = 0.15;    ///< Speed (3D) below which a contact may begin, m/s.
  double begin_height = 0.04;   ///< Distance from the standing height within which a contact may
                                ///< begin, metres.
  double end_speed = 0.25;      ///< Speed (3D) above which a contact ends, m/s.
  double end_height = 0.06;     ///< Distance from the standing height beyond which a contact ends,
                                ///< metres.
  double shortest = 0.1;        ///< Shortest contact, seconds.
  double support_time = 0.15;   ///< Time for which a foot above the floor must be slow to be in
                                ///< contact, seconds.
  double support_drift = 0.02;  ///< Largest displacement of such a foot in this time, metres.
  /// Whether the clip is still growing, so that a contact at its end may become longer.
  bool goes_on = false;
};

/// The phases on the floor, without those on raised surfaces.
[[nodiscard]] std::vector<ContactPhase> on_floor(std::vector<ContactPhase> phases);

/// Heights of the source's feet when they stand on the floor.
struct StandingHeights {
  double ankle = 0.0, toe = 0.0;  ///< World, metres.
  bool found = false;             ///< False: no foot stands long enough; the heights are estimates.
  double ankle_over_heel = 0.0;   ///< Height of the ankle above the heel for feet with known soles,
                                  ///< metres; else 0, and the ankle serves as the heel.
  bool from_body = false;  ///< True if the heights were inferred from a body part that rests lower
                           ///< than the feet.

  /// Standing height of a foot end, kHeelEnd or kToeEnd.
  [[nodiscard]] double of(int end) const { return end == kHeelEnd ? ankle - ankle_over_heel : toe; }
};

/// Contact phases of one end of a foot.
struct EndContacts {
  std::vector<ContactPhase> phases;  ///< Sorted by time.
  /// One entry per frame of the clip: whether the end is at its standing height and the foot does
  /// not rest on its side, edge or tip.
  std::vector<char> level;
};

/// For each of kSupportBones, its contacts with the surface below it.
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
  /// In a scene: the contacts of these bodies with surfaces above the floor.
  BodyContacts bodies_above_floor;

  /// Whether a whole foot is in contact in a frame.
  [[nodiscard]] bool in_contact(int foot, int frame) const;
  /// Whether one end of a foot is in contact in a frame.
  [[nodiscard]] bool in_contact(int foot, int end, int frame) const;
  /// The contacts in the form that motion files store.
  [[nodiscard]] SourceContacts of_ends() const;
};

/// Finds the contacts of a human's feet.
///
/// A contact of one end of a foot with the floor begins when the end is slower than begin_speed and
/// within begin_height of its standing height. It lasts until the end passes end_speed or
/// end_height, and for at least `shortest` (all lengths and speeds times the scale). `shortest` is
/// 3 frames at 30 fps, so shorter clips have no contacts unless it is reduced. Thresholds with
/// hysteresis are common practice (Holden's motion matching: 0.15 m/s; HuMoR: 4 cm).
///
/// The source does not describe raised surfaces such as boxes and stairs. A raised stance is
/// therefore detected from the foot's motion: the foot is upright, and both ends are slow for
/// support_time and stay within support_drift. Feet in swing rarely meet these conditions, and
/// holding such a foot does little harm. A body that does not fall and has no other support may
/// also have two further kinds of raised stances: the longest interval of at least half a second in
/// which a slow foot stays within support_drift, and a single toe at least 10 cm (scaled) above its
/// standing height that meets the conditions, as on stairs. If the heights of heel and toe differ
/// little, both get the same height, so that the sole is level. Frames around the stance in which
/// only one end is in contact belong to it.
[[nodiscard]] ContactPlan find_contacts(const HumanClip& human, const ContactOptions& options = {});

/// Contact phases of a sole of a robot's profile.
struct SoleContacts {
  const Sole* sole = nullptr;  ///< Belongs to the robot, which must outlive this.
  std::vector<ContactPhase> phases;
};

/// Finds the contact phases of a robot's soles, one element per sole of its profile: the lowest
/// point of the sole is less than 2 cm above the floor, and its middle is slower than 0.25 m/s.
[[nodiscard]] std::vector<SoleContacts> sole_contacts(const RobotClip& clip);

}  // namespace retarget
