// `retarget inspect`: joints, rate, duration and extents of a motion file.

#include "base/file.h"
#include "base/printable.h"
#include "base/try.h"
#include "commands.h"
#include "human_source.h"
#include "inspect/inspect_clip.h"
#include "run_setup.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

Result<HumanSource> understand(SourceMotion motion, const InspectOptions& options) {
  TRY_ASSIGN(const auto data, data_folder_of(options.common));
  return find_human(motion, options.source, options.human, data / "configs" / "skeletons");
}

Result<void> inspect_checked(const InspectOptions& options, Console& console) {
  if (options.json && options.positions == "-") {
    return usage_failure("--json and --positions - both want standard output",
                         "give --positions a file name");
  }
  RunOptions read;
  read.common = options.common;
  read.source = options.source;
  read.human = options.human;
  TRY(check_written({options.positions, options.human.write_map}, files_of(read)));
  TRY_ASSIGN(const auto file, read_source(options.source, options.skeleton_only, console));
  const auto human = understand(file, options);
  // what the user asked for must be possible; what was only looked at need not be a human
  if (!human && human.error().kind != ErrorKind::kInput) return failure(human.error());

  if (!options.positions.empty()) {
    TRY(write_file(options.positions, positions_csv(file.clip)));
    if (options.positions == "-") return {};
  }
  Inspection found{source_name(options.source), file.clip, file.warnings};
  found.spelling = option_as_flag;
  if (human) {
    found.map = &human->map;
    found.calibration = &human->calibration;
  } else {
    found.reason = &human.error();
  }
  return write_file("-", options.json ? inspection_json(found) : printable(inspection_text(found)));
}

}  // namespace

ExitCode inspect(const InspectOptions& options, Console& console) {
  const auto done = inspect_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
