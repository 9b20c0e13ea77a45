// `retarget edit`: BVH in, BVH out.

#include <memory>
#include <utility>

#include "commands.h"
#include "human_source.h"
#include "retarget/base/data_folder.h"
#include "retarget/base/file.h"
#include "retarget/bvh/read_bvh.h"
#include "retarget/bvh/write_bvh.h"
#include "retarget/edit/change_rest.h"
#include "retarget/edit/lafan1_clip.h"
#include "retarget/edit/transfer.h"

namespace retarget::cli {
namespace {

Result<HumanSource> understand(const SourceMotion& motion, const SourceOptions& source,
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

Result<Clip> to_rest(const EditOptions& options, Console& console) {
  const auto motion = read_source(options.source, false, console);
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
  const auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  const auto human = understand(*motion, options.source, options.human, options.common, console);
  if (!human) return failure(human.error());
  return lafan1_clip(to_human(motion->clip, human->calibration.mapping),
                     source_name(options.source));
}

Result<Clip> to_other(const EditOptions& options, Console& console) {
  const auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  const auto human = understand(*motion, options.source, options.human, options.common, console);
  if (!human) return failure(human.error());
  SourceOptions target_options;
  target_options.file = options.like;
  const auto target = read_source(target_options, true, console);
  if (!target) return failure(target.error());
  const auto of_target = understand(*target, target_options, {}, options.common, console);
  if (!of_target) return failure(of_target.error());
  return transfer(to_human(motion->clip, human->calibration.mapping),
                  {target->clip.shared_skeleton(), of_target->map, of_target->calibration.mapping});
}

}  // namespace

ExitCode edit(const EditOptions& options, Console& console) {
  if (auto folder = check_output_folder(options.output); !folder) {
    return console.fail(folder.error());
  }
  const auto clip = options.edit == Edit::kRest       ? to_rest(options, console)
                    : options.edit == Edit::kTransfer ? to_other(options, console)
                                                      : to_lafan1(options, console);
  if (!clip) return console.fail(clip.error());
  const auto written = save_bvh(options.output, *clip);
  if (!written) return console.fail(written.error());
  console.line("wrote", options.output == "-" ? "standard output" : options.output);
  return kDone;
}

}  // namespace retarget::cli
