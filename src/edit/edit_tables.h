#pragma once

#include <optional>
#include <string>

#include "options/option_table.h"
#include "retarget/edit.h"
#include "retarget/options.h"

namespace retarget {

/// What edits are told beside their clips, as options have it.
struct EditSettings {
  std::string fps;  ///< Of TimingOptions::rate; empty: not given.
  TimingOptions timing;
  Interpolation interpolation = Interpolation::kCubic;
  bool no_antialias = false;
  std::optional<double> floor;  ///< Its height, metres; nothing: found.
  LoopOptions loop;
  std::string search;  ///< Seconds, or `all`; empty: 2, and more without a good seam.
  ConcatenateOptions concat;
  double threshold_cm = 20.0;  ///< Of a seam.
  bool force = false;
  PathChange path;
  FollowPathOptions follow_path;

  /// The options of each edit with all that was told. Errors (kUsage): an unreadable rate or search.
  [[nodiscard]] Result<TimingOptions> timing_options() const;
  [[nodiscard]] LoopOptions loop_options() const;
  [[nodiscard]] Result<ConcatenateOptions> concatenate_options() const;
};

/// The rows of each edit that has some.
[[nodiscard]] OptionTable resample_table(EditSettings& settings);
[[nodiscard]] OptionTable ground_table(EditSettings& settings);
[[nodiscard]] OptionTable loop_table(EditSettings& settings);
[[nodiscard]] OptionTable concatenate_table(EditSettings& settings);
[[nodiscard]] OptionTable path_table(EditSettings& settings);

}  // namespace retarget
