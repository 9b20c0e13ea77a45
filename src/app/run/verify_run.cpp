// Repeats the run of a sidecar and compares the bytes, the facts and the metrics.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/run/sidecar.h"
#include "base/try.h"
#include "retarget/certificate.h"
#include "retarget/check_options.h"
#include "retarget/enum_names.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/scene.h"
#include "retarget/text.h"
#include "retarget/version.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

Result<FileContent> read_record(const std::string& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    return input_failure(
        file, "expected a run's sidecar, found a directory",
        "give a sidecar in it, such as " + (fs::path(file) / "walk.csv.json").string());
  }
  return read_file(file, ErrorKind::kInput, kMaxTextBytes);
}

// Returns the inputs whose content has changed, one line each.
std::vector<std::string> changes(const Sidecar& sidecar, const std::vector<ReadFile>& now) {
  std::vector<std::string> changed;
  if (sidecar.version != version_number()) {
    changed.push_back("the tool has version " + version_number() + ", the sidecar's tool had " +
                      sidecar.version);
  }
  for (const ReadFile& then : sidecar.files) {
    const auto found = std::ranges::find(now, then.role, &ReadFile::role);
    if (found == now.end()) {
      changed.push_back("the " + then.role + " " + then.file + " is no longer used");
    } else if (found->hash != then.hash && !then.hash.empty()) {
      changed.push_back("the " + then.role + " " + found->file + " has changed");
    }
  }
  return changed;
}

// Reconstructs the sidecar's run.
Result<Run> run_of(const Sidecar& sidecar, const fs::path& beside, const std::string& file,
                   const DataFolder& data_folder) {
  Run run = sidecar.run;
  if (run.motion == "-") {
    return input_failure(file, "the motion came from standard input and cannot be read again");
  }
  for (auto check :
       {check_robot_choice(run.robot), check_config_choice(run.robot, run.options.solve),
        check_solving_options(run.options)}) {
    if (check) continue;
    check.error().kind = ErrorKind::kInput;
    check.error().location.file = file;
    return failure(check.error());
  }
  find_moved(run.motion, beside);
  find_moved_robot(run.robot.name, beside, data_folder);
  find_moved_robot(run.options.source.from_robot, beside, data_folder);
  for (const Option& row : run_table(run)) {
    if (row.info.file == OptionFile::kNone) continue;
    std::string named = to_text(row.get());
    find_moved(named, beside);
    TRY(row.set(named));
  }
  for (std::string& track : run.options.solve.object_tracks) {
    std::string named = object_track_file(track);
    const std::string body = track.substr(0, track.size() - named.size());
    find_moved(named, beside);
    track = body + named;
  }
  const auto format = enum_from_name<MotionFormat>(sidecar.format);
  if (!format) {
    return input_failure(file, "unknown format in the sidecar: \"" + sidecar.format + "\"",
                         "it may come from a newer version of this tool");
  }
  // All formats, because the motion depends on how their files print numbers.
  std::vector<MotionFormat>& formats = run.options.save.formats;
  if (std::ranges::find(formats, *format) == formats.end()) formats = {*format};
  run.output = sidecar.output;
  const std::string_view ending = format_long_ending(*format);
  if (formats.size() > 1 && run.output.ends_with(ending)) {
    run.output.erase(run.output.size() - ending.size());
    run.output += format_long_ending(MotionFormat::kCsv);
  }
  return run;
}

// The motion that a sidecar describes: the file that has the sidecar's name without the ending, or
// the one with the recorded name.
Result<fs::path> motion_of(const Sidecar& sidecar, const std::string& file) {
  const fs::path recorded = fs::path(file).parent_path() / sidecar.output;
  std::error_code ignored;
  for (const fs::path& motion : {fs::path(file).replace_extension(), recorded}) {
    if (motion != fs::path(file) && fs::exists(motion, ignored)) return motion;
  }
  return run_failure(recorded.string(), "the motion of the sidecar is missing",
                     "put it next to the sidecar");
}

// Why the repeated run has no file in the sidecar's format.
Error missing_format(const Sidecar& sidecar, const std::vector<Error>& left_out) {
  const auto found = std::ranges::find_if(
      left_out, [&](const Error& error) { return error.location.file == sidecar.output; });
  if (found != left_out.end()) return *found;
  return run_failure(sidecar.output, "the repeated run has no file in the format " + sidecar.format)
      .value();
}

}  // namespace

Result<void> verify_run(const std::string& file, const DataFolder& data_folder,
                        Observer& observer) {
  // It may be a pipe, which can be read once.
  TRY_ASSIGN(const auto content, read_record(file));
  if (is_certificate(content.view())) {
    return verify_certificate(content.view(), file, data_folder, observer);
  }
  TRY_ASSIGN(const Sidecar sidecar, read_sidecar(content.view(), file));
  const fs::path beside = fs::path(file).parent_path();
  TRY_ASSIGN(const Run run, run_of(sidecar, beside, file, data_folder));
  TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, data_folder, observer));
  TRY_ASSIGN(const RobotSetup setup, set_up_robot(std::move(robot), run.options));
  RunRequest request;
  request.hashes_only = true;
  request.partial = true;
  request.sidecar = true;
  request.dynamics = sidecar.has_dynamics;
  request.mirror = sidecar.mirror;
  const auto outcome = run_to_files(run, request, setup, observer);
  // The configuration depends on the source, so it is known only after the run.
  const auto files = files_read(run, setup.loaded, outcome ? outcome->config : setup.config.file);
  if (!files) return failure(outcome ? files.error() : outcome.error());
  const std::vector<std::string> changed = changes(sidecar, *files);
  for (const std::string& change : changed) observer.line("changed", change);
  if (!outcome) return failure(outcome.error());

  TRY_ASSIGN(const fs::path output, motion_of(sidecar, file));
  TRY_ASSIGN(const std::string there, motion_hash(output.string()));
  if (there != sidecar.hash) {
    return run_failure(output.string(), "the file has changed since the sidecar was written");
  }
  const auto file_of_sidecar =
      std::ranges::find_if(outcome->motions, [&](const WrittenFile& written) {
        return format_name(written.item.format) == sidecar.format;
      });
  if (file_of_sidecar == outcome->motions.end()) {
    return failure(missing_format(sidecar, outcome->left_out));
  }
  const WrittenFile& repeated = *file_of_sidecar;
  const std::string hint = changed.empty()
                               ? "all recorded inputs match; a different machine or build?"
                               : list_names(changed);
  if (repeated.hash != sidecar.hash) {
    return run_failure(file, "the output differs from " + output.filename().string(), hint);
  }
  const auto altered = altered_members(content.view(), repeated.sidecar);
  if (altered && !altered->empty()) {
    return run_failure(
        file,
        "the output is identical, but the sidecar differs from the repeated run in " +
            list_names(*altered),
        changed.empty() ? "" : hint);
  }
  observer.line("verified", output.filename().string() +
                                (altered ? ": the output and its report are identical"
                                         : ": the output is identical; another build wrote the "
                                           "sidecar, so its report was not compared"));
  return {};
}

}  // namespace retarget
