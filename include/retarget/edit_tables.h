#pragma once

#include <optional>
#include <string>

#include "retarget/edit.h"
#include "retarget/export.h"
#include "retarget/option_table.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

/// Settings of edits in addition to their clips, as given by options.
struct EditSettings {
  std::string fps;  ///< Text of TimingOptions::rate; empty: not given.
  TimingOptions timing;
  Interpolation interpolation = Interpolation::kCubic;
  bool no_antialias = false;
  std::optional<double> floor;  ///< Floor height, metres; nothing: estimated.
  LoopOptions loop;
  std::string search;  ///< Seconds, or `all`; empty: 2, extended if no good seam is found.
  ConcatenateOptions concat;
  double threshold_cm = 20.0;  ///< Seam distance threshold, cm.
  bool force = false;
  PathChange path;
  FollowPathOptions follow_path;

  /// Returns the complete options of each edit. Errors (kUsage): an invalid rate or search.
  [[nodiscard]] Result<TimingOptions> timing_options() const;
  [[nodiscard]] LoopOptions loop_options() const;
  [[nodiscard]] Result<ConcatenateOptions> concatenate_options() const;
};

/// Returns the option tables of the edits that have options.
[[nodiscard]] OptionTable resample_table(EditSettings& settings);
[[nodiscard]] OptionTable ground_table(EditSettings& settings);
[[nodiscard]] OptionTable loop_table(EditSettings& settings);
[[nodiscard]] OptionTable concatenate_table(EditSettings& settings);
[[nodiscard]] OptionTable path_table(EditSettings& settings);

}  // namespace retarget
