// `retarget edit`: BVH in, BVH out.

#include <memory>
#include <utility>

#include "base/file.h"
#include "bvh/read_bvh.h"
#include "bvh/write_bvh.h"
#include "commands.h"
#include "edit/change_rest.h"
#include "edit/lafan1_clip.h"
#include "edits.h"
#include "human_source.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

// of what brings one body to the size of another one
HumanOptions without_unit(HumanOptions options) {
  options.unit_optional = true;
  return options;
}

Result<Clip> to_rest(const EditOptions& options, Console& console) {
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  BvhReadOptions read_options;
  read_options.motion_optional = true;
  const auto like = load_bvh(options.like, read_options);
  if (!like) return failure(like.error());
  auto changed = change_rest(motion->clip, like->clip.shared_skeleton(),
                             source_name(options.source), options.like);
  if (!changed) return failure(changed.error());
  console.line("moved",
               "no joint by more than " + number_text(changed->largest_distance, 6) + " units");
  return std::move(changed->clip);
}

Result<Clip> to_lafan1(const EditOptions& options, Console& console) {
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  const auto human =
      understand(*motion, options.source, without_unit(options.human), options.common, console);
  if (!human) return failure(human.error());
  return lafan1_clip(to_human(motion->clip, human->calibration.mapping),
                     source_name(options.source));
}

Result<Clip> to_other(const EditOptions& options, Console& console) {
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  const auto human =
      understand(*motion, options.source, without_unit(options.human), options.common, console);
  if (!human) return failure(human.error());
  SourceOptions target_options;
  target_options.file = options.like;
  auto target = read_source(target_options, true, console);
  if (!target) return failure(target.error());
  const auto of_target =
      understand(*target, target_options, without_unit({}), options.common, console);
  if (!of_target) return failure(of_target.error());
  return to_skeleton(
      motion->clip, human->calibration.mapping,
      {target->clip.shared_skeleton(), of_target->map, of_target->calibration.mapping},
      options.like, console);
}

// nothing: what was asked for is written already
Result<std::optional<Clip>> edited(const EditOptions& options, Console& console) {
  switch (options.edit) {
    case Edit::kRest:
      return to_rest(options, console);
    case Edit::kTransfer:
      return to_other(options, console);
    case Edit::kLafan1:
      return to_lafan1(options, console);
    case Edit::kConcat:
      return edit_concat(options, console);
    case Edit::kPath:
      return edit_path(options, console);
    default:
      return edit_time_or_place(options, console);
  }
}

}  // namespace

ExitCode edit(const EditOptions& options, Console& console) {
  const auto good = check_written({options.output, options.concat.matrix, options.path.fit,
                                   options.path.svg, options.human.write_map},
                                  files_of(options));
  if (!good) return console.fail(good.error());
  const auto clip = edited(options, console);
  if (!clip) return console.fail(clip.error());
  if (!*clip) return kDone;
  const auto written = save_bvh(options.output, **clip);
  if (!written) return console.fail(written.error());
  console.line("wrote", options.output == "-" ? "standard output" : options.output);
  return kDone;
}

}  // namespace retarget::cli
