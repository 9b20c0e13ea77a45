#pragma once

#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "edit/transfer.h"
#include "edit_options.h"
#include "human_source.h"
#include "retarget/clip.h"

namespace retarget::cli {

/// A clip that is edited, and the human in it.
struct EditSource {
  Clip clip;  ///< The part that was asked for.
  HumanSource human;

  [[nodiscard]] const HumanMapping& mapping() const { return human.calibration.mapping; }
};

/// Recognises the human of a clip and says what was found.
[[nodiscard]] Result<HumanSource> understand(SourceMotion& motion, const SourceOptions& source,
                                             const HumanOptions& human, const CommonOptions& common,
                                             Console& console);

/// The part of a clip that was asked for.
[[nodiscard]] Result<Clip> choose_part(Clip clip, const PartOptions& part);

/// The file that is edited, cut to the part that was asked for after the human was recognised.
/// Edits that look at the motion as a whole (path, loop, concat, ground) get it without frames in
/// front that are none of it (count_lead_in_frames), unless the part's beginning was asked for.
[[nodiscard]] Result<EditSource> read_edit_source(const EditOptions& options, Console& console);

/// A clip on another skeleton, its feet planted; says what is not carried over.
[[nodiscard]] Clip to_skeleton(const Clip& clip, const HumanMapping& mapping,
                               const TransferTarget& target, const std::string& file,
                               Console& console);

/// Faults of a seam or a path, as what is said without stopping.
[[nodiscard]] std::vector<Warning> as_warnings(const std::vector<std::string>& faults);

/// What was done to plant feet.
[[nodiscard]] std::string planted_text(const PlantSummary& feet);

/// Edits of time and place: resample, trim, mirror, ground, turn, move, loop.
[[nodiscard]] Result<Clip> edit_time_or_place(const EditOptions& options, Console& console);

/// `edit concat`.
[[nodiscard]] Result<Clip> edit_concat(const EditOptions& options, Console& console);

/// `edit path`; nothing when the path is only fitted or drawn.
[[nodiscard]] Result<std::optional<Clip>> edit_path(const EditOptions& options, Console& console);

}  // namespace retarget::cli
