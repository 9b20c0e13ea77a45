#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Result of cleaning a clip.
struct CleanReport {
  std::vector<std::string> notes;  ///< Sentences with numbers; empty if nothing changed.
  /// Apparent speed of standing feet after smoothing, in m/s for a body with legs of
  /// kUsualSourceLeg; 0 if there was no joint noise. Slower feet may be in contact.
  double foot_speed = 0.0;
  double root_moved = 0.0;  ///< Largest displacement of the root, metres.

  [[nodiscard]] bool acted() const { return !notes.empty(); }
};

/// Removes the noise of video estimates and IMU suits where it is measured. Does not
/// change other clips.
///
/// The steps, in this order: interpolate lost and frozen frames, lost joints and spikes. If half of
/// the joints or a limb have large noise (joint_jitter.h), smooth all noisy joints or those of the
/// limb as strongly as their noise requires (measure_noise); if that moves the feet, set varying
/// bone lengths to their medians. If standing feet move, translate the whole body so that they do
/// not (root_drift.h); the legs keep their poses, except where the joints had noise: then the feet
/// are held in their stances (plant_noisy_feet.h).
/// @param jittery  whether the clip's positions had noise (clean_positions)
CleanReport clean_clip(Clip& clip, FrameRange part, const Calibration& calibration,
                       bool jittery = false);

/// Interpolates over spikes of a clip made from joint positions alone (bridge_spikes for tracks).
/// Then recomputes the rotations. Does not change other clips.
/// @return sentences: `LeftFoot jumped away in 3 frames`; empty if nothing changed
std::vector<std::string> bridge_position_spikes(Clip& clip);

/// Smooths the joints of a clip made from joint positions alone (ClipOrigin::unknown_rotations) if
/// half of them have noise above 0.3 % of the body's size per frame. Then recomputes the rotations,
/// because noisy positions make them spin about nearly straight limbs. Does not change other
/// clips.
/// @return a sentence with numbers; empty if nothing changed
std::string clean_positions(Clip& clip);

}  // namespace retarget
