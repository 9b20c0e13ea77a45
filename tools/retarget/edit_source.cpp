#include <optional>
#include <string>
#include <utility>

#include "base/data_folder.h"
#include "base/suggest.h"
#include "edits.h"
#include "motion/clip_range.h"
#include "motion/lead_in.h"

namespace retarget::cli {

Result<HumanSource> understand(SourceMotion& motion, const SourceOptions& source,
                               const HumanOptions& human, const CommonOptions& common,
                               Console& console) {
  const auto data = find_data_folder(
      common.data_dir.empty() ? std::nullopt : std::optional<std::string>(common.data_dir));
  if (!data) return failure(data.error());
  auto found = find_human(motion, source, human, *data / "configs" / "skeletons");
  if (!found) return found;
  console.line("taken as", found->calibration.mapping.description);
  for (const std::string& note : found->map.notes) console.line("", note);
  console.warn(found->calibration.mapping.doubts, source_name(source));
  return found;
}

Result<Clip> choose_part(Clip clip, const PartOptions& part) {
  const bool times = part.start_s >= 0.0 || part.end_s >= 0.0;
  if (part.frames.empty() && !times) return clip;
  if (!part.frames.empty() && times) {
    return usage_failure("--frames and --start/--end both choose a part of the clip",
                         "give one of them");
  }
  const auto given = [](double seconds) {
    return seconds < 0.0 ? std::nullopt : std::optional<double>(seconds);
  };
  const auto range = part.frames.empty()
                         ? frame_range_from_seconds(given(part.start_s), given(part.end_s),
                                                    clip.rate(), clip.frame_count())
                         : frame_range_from_text(part.frames, clip.frame_count());
  if (!range) return failure(range.error());
  return cut(clip, range->begin, range->end);
}

Clip to_skeleton(const Clip& clip, const HumanMapping& mapping, const TransferTarget& target,
                 const std::string& file, Console& console) {
  const UncarriedJoints uncarried = uncarried_joints(clip, mapping, target);
  if (!uncarried.left_out.empty()) {
    console.line("left out", list_names(uncarried.left_out) +
                                 ": the target has no such joint below the same parent");
  }
  if (!uncarried.at_rest.empty()) {
    console.line("at rest", list_names(uncarried.at_rest) +
                                ": the source has no such joint below the same parent");
  }
  Clip moved = transfer(clip, mapping, target);
  const auto feet = plant_transferred_feet(moved, target, clip, mapping, {}, file);
  console.line("feet", feet ? planted_text(*feet) : "not planted: " + feet.error().message);
  return moved;
}

std::string planted_text(const PlantSummary& feet) {
  return "moved by up to " + number_text(100.0 * feet.largest_correction, 1) +
         " cm to stand, hips lowered by up to " + number_text(100.0 * feet.largest_drop, 1) + " cm";
}

std::vector<Warning> as_warnings(const std::vector<std::string>& faults) {
  std::vector<Warning> warnings;
  warnings.reserve(faults.size());
  for (const std::string& fault : faults) warnings.push_back({0, 0, fault});
  return warnings;
}

namespace {

// what is told or shown in metres needs a unit; all else is done in the file's own
bool needs_unit(const EditOptions& options) {
  return options.edit == Edit::kMove || options.edit == Edit::kPath ||
         (options.edit == Edit::kGround && !options.floor.empty());
}

// what looks at the motion as a whole must not take a T-pose in front for a part of it
bool looks_at_motion(Edit edit) {
  return edit == Edit::kPath || edit == Edit::kLoop || edit == Edit::kConcat ||
         edit == Edit::kGround;
}

// frames in front of a part that are none of the motion, unless the user says where it begins
Clip without_lead_in(Clip part, const EditOptions& options, Console& console) {
  const bool begun = !options.part.frames.empty() || options.part.start_s >= 0.0;
  if (begun || !looks_at_motion(options.edit)) return part;
  const int count = count_lead_in_frames(part);
  if (count == 0) return part;
  // clips that are joined have no --start
  const std::string take = options.edit == Edit::kConcat
                               ? std::string()
                               : std::string("; --start 0 takes ") + (count == 1 ? "it" : "them");
  console.line("lead-in", count_text(count, "frame") +
                              " in front left out, from which the motion jumps away" + take);
  return cut(part, count, part.frame_count());
}

}  // namespace

Result<EditSource> read_edit_source(const EditOptions& options, Console& console) {
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  HumanOptions how = options.human;
  how.unit_optional = !needs_unit(options);
  auto human = understand(*motion, options.source, how, options.common, console);
  if (!human) return failure(human.error());
  auto part = choose_part(std::move(motion->clip), options.part);
  if (!part) return failure(part.error());
  return EditSource{without_lead_in(std::move(*part), options, console), std::move(*human)};
}

}  // namespace retarget::cli
