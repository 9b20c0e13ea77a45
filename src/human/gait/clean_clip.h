#pragma once

#include <string>
#include <vector>

#include "human/gait/side_swaps.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Noise of the feet that remains after smoothing, for a body with legs of kUsualSourceLeg.
/// Computed from the noise of the joints, not from the movement of the feet, which also roll.
struct FootNoise {
  double speed = 0.0;   ///< RMS, m/s; 0: the joints that move the feet had no noise.
  double wander = 0.0;  ///< RMS distance of errors that accumulate, metres; 0: there are none.
};

/// Result of cleaning a clip.
struct CleanReport {
  std::vector<std::string> notes;  ///< Sentences with numbers; empty if nothing changed.
  FootNoise foot_noise;            ///< Feet that are hardly faster than this may be in contact.
  double root_moved = 0.0;         ///< Largest displacement of the root, metres.

  [[nodiscard]] bool acted() const { return !notes.empty(); }
};

enum class RootRule {
  kFollowsFeet,  ///< Standing feet are at rest.
  kKept,         ///< They may stand on bodies that move.
};

/// Removes the noise of video estimates and IMU suits where it is measured. Does not
/// change other clips.
///
/// The steps, in this order: interpolate lost and frozen frames, lost joints and spikes. If half of
/// the joints or a limb have large noise (joint_jitter.h), smooth all noisy joints or those of the
/// limb as strongly as their noise requires (best_cutoff); if that moves the feet, set varying
/// bone lengths to their medians. If the position of the body has independent errors, smooth it
/// (root_jitter.h). If standing feet move, translate the whole body so that they do
/// not (root_drift.h); the legs keep their poses, except where their errors accumulate: then the
/// feet are held in their stances (plant_noisy_feet.h).
/// @param foot_noise  of the clip's positions (clean_positions)
CleanReport clean_clip(Clip& clip, FrameRange part, const Calibration& calibration,
                       const FootNoise& foot_noise = {}, RootRule root = RootRule::kFollowsFeet);

/// Undoes exchanges of left and right in a clip made from joint positions alone (undo_side_swaps).
/// Then recomputes the rotations. Does not change other clips.
[[nodiscard]] SideSwaps undo_position_swaps(Clip& clip);

/// Interpolates over spikes of a clip made from joint positions alone (bridge_spikes for tracks).
/// Then recomputes the rotations. Does not change other clips.
/// @return sentences: `LeftFoot jumped away in 3 frames`; empty if nothing changed
std::vector<std::string> bridge_position_spikes(Clip& clip);

/// Result of clean_positions().
struct PositionJitter {
  std::string note;  ///< A sentence with numbers; empty if nothing changed.
  FootNoise foot_noise;
};
/// Smooths the joints of a clip made from joint positions alone (ClipOrigin::unknown_rotations) if
/// half of them have noise above 0.3 % of the body's size per frame. Then recomputes the rotations,
/// because noisy positions make them spin about nearly straight limbs. Does not change other
/// clips.
[[nodiscard]] PositionJitter clean_positions(Clip& clip);

}  // namespace retarget
