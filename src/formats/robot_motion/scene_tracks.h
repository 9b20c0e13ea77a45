#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "formats/containers/npz.h"
#include "retarget/clip.h"
#include "retarget/motion_io.h"
#include "retarget/scene.h"
#include "retarget/solved_scene.h"

namespace retarget {

/// The moving bodies of a scene at the samples of a motion, sampled like the root in
/// make_tracking_motion; empty: there are none.
/// @param scene  scene in the frames of the motion's clip.
[[nodiscard]] std::optional<TrackedObjects> tracked_objects(const SceneClip& scene,
                                                            const TrackingMotion& motion);

/// Contacts at the samples of a motion: 1 from the first to the last frame of a contact, falling
/// linearly to 0 in the 0.15 s before and after, in which the fit approaches and leaves surfaces.
[[nodiscard]] TrackedContacts tracked_contacts(const ContactLabels& labels, const FrameRate& clip,
                                               const TrackingMotion& motion);

/// Appends `width` numbers of a row.
void append_row(std::vector<double>& to, const std::vector<double>& from, std::size_t begin,
                std::size_t width);

/// Adds the arrays that only motions in scenes have; see format_tracking_npz.
void add_scene_arrays(const TrackingMotion& motion, NpzWriter& npz);

}  // namespace retarget
