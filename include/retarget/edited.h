#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"

// Inputs and results of the edits in edit.h.

namespace RETARGET_API retarget {

/// A line of an edit's report: a short label and text. An empty label continues the previous line.
struct EditNote {
  std::string label, text;
};

/// An edited clip and a report about it.
struct Edited {
  Clip clip;
  std::vector<EditNote> notes = {};
  std::vector<Warning> doubts = {};  ///< Possible errors in the clip.
  /// Reason why a seam is bad (kRun). The clip can still be used.
  std::optional<Error> misfit = std::nullopt;
};

/// References to a clip and the human in it.
struct Subject {
  const Clip& clip;
  const BoneMap& map;
  const Calibration& calibration;
  std::string name = {};  ///< Name of the clip in messages about two clips.
};

/// Parameters of planting feet at their contacts.
struct PlantOptions {
  /// Duration of the blend between a foot's contact and its unplanted position, seconds.
  double release = 0.3;
  double pelvis_blend = 0.25;  ///< Blend before and after a frame with lowered hips, seconds.
};

/// Corrections of feet and hips that planted the feet, metres.
struct PlantSummary {
  double largest_correction = 0.0;  ///< Displacement of an ankle.
  double largest_drop = 0.0;        ///< Lowering of the hips.
  double largest_miss = 0.0;        ///< Distance to a position that a leg cannot reach.
};

}  // namespace retarget
