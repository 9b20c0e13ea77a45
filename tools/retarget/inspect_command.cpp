// `retarget inspect`: shows joints, rate, duration and extents of a motion file.

#include <filesystem>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "retarget/human.h"
#include "retarget/inspect.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

Result<HumanInClip> understand(Clip clip, const InspectArguments& arguments) {
  RETARGET_TRY_ASSIGN(const std::string data_folder, data_folder_of(arguments.run.common));
  RETARGET_TRY_ASSIGN(auto human, find_human_as_run(clip, arguments.run.run.options, data_folder));
  RETARGET_TRY(save_bone_map(arguments.run.request.write_map, human.map, clip.skeleton()));
  return human;
}

// Writes a page that includes the text that would otherwise be printed.
Result<void> write_page(const Inspection& found, const std::string& file) {
  SkeletonPage page;
  page.title = std::filesystem::path(found.file).filename().string();
  page.clip = &found.clip;
  page.calibration = found.calibration;
  Inspection named = found;
  named.file = page.title;
  page.facts = printable(inspection_text(named));
  if (found.calibration != nullptr) {
    for (const Warning& doubt : found.calibration->doubts) {
      page.doubts.push_back(spell_options(doubt.message, option_as_flag));
    }
  }
  if (found.reason != nullptr) page.doubts.push_back(describe(*found.reason, option_as_flag));
  RETARGET_TRY_ASSIGN(const std::string bytes, skeleton_page(page));
  return write_file(file, bytes);
}

}  // namespace

Result<void> inspect(const InspectArguments& arguments, Console& console) {
  if (arguments.html == "-") return usage_failure("--html needs a file");
  if (arguments.json && arguments.positions == "-") {
    return usage_failure("--json and --positions - cannot both use standard output",
                         "give --positions a file name");
  }
  const Run& run = arguments.run.run;
  RETARGET_TRY(check_written({arguments.positions, arguments.html, arguments.run.request.write_map},
                             files_read(run, arguments.run.common)));
  const DataFolder data_folder{arguments.run.common.data_dir};
  RETARGET_TRY_ASSIGN(const Clip clip,
                      arguments.skeleton_only
                          ? load_skeleton(run.motion, run.options.source)
                          : load_clip(run.motion, run.options.source, data_folder));
  console.warn(clip.origin().warnings, clip.name());
  const auto human = understand(clip, arguments);
  // Recognition failures are acceptable; invalid user options are not.
  if (!human && human.error().kind != ErrorKind::kInput) return failure(human.error());

  if (!arguments.positions.empty()) {
    RETARGET_TRY(write_file(arguments.positions, positions_csv(clip)));
    if (arguments.positions == "-") return {};
  }
  Inspection found{clip.name(), clip, clip.origin().warnings};
  found.spelling = option_as_flag;
  if (human) {
    found.map = &human->map;
    found.calibration = &human->calibration;
  } else {
    found.reason = &human.error();
  }
  if (!arguments.html.empty()) {
    RETARGET_TRY(write_page(found, arguments.html));
    console.line("wrote", arguments.html + " (open it in a browser)");
    return {};
  }
  return write_file("-",
                    arguments.json ? inspection_json(found) : printable(inspection_text(found)));
}

}  // namespace retarget::cli
