// Repeats the run of a sidecar and compares the bytes.

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/plan/set_up_robot.h"
#include "app/run/sidecar.h"
#include "base/option_name.h"
#include "base/try.h"
#include "motion/clip.h"
#include "retarget/certificate.h"
#include "retarget/check_options.h"
#include "retarget/enum_names.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/hash.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/run.h"
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

// Reconstructs the sidecar's run with only the output that the sidecar describes.
Result<Run> run_of(const Sidecar& sidecar, const fs::path& beside, const std::string& file) {
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
  find_moved(run.robot.name, beside);
  find_moved(run.options.source.from_robot, beside);
  for (const Option& row : run_table(run)) {
    if (row.info.file == OptionFile::kNone) continue;
    std::string named = to_text(row.get());
    find_moved(named, beside);
    TRY(row.set(named));
  }
  const auto format = enum_from_name<MotionFormat>(sidecar.format);
  if (!format) {
    return input_failure(file, "unknown format in the sidecar: \"" + sidecar.format + "\"",
                         "it may come from a newer version of this tool");
  }
  run.options.save.formats = {*format};
  run.output = sidecar.output;
  return run;
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
  TRY_ASSIGN(const Run run, run_of(sidecar, beside, file));
  TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, data_folder, observer));
  TRY_ASSIGN(const RobotSetup setup, set_up_robot(std::move(robot), run.options));
  RunRequest request;
  request.hashes_only = true;
  request.mirror = sidecar.mirror;
  const auto outcome = run_to_files(run, request, setup, observer);
  // The configuration depends on the source, so it is known only after the run.
  const auto files = files_read(run, setup.loaded, outcome ? outcome->config : setup.config.file);
  if (!files) return failure(outcome ? files.error() : outcome.error());
  const std::vector<std::string> changed = changes(sidecar, *files);
  for (const std::string& change : changed) observer.line("changed", change);
  if (!outcome) return failure(outcome.error());

  const std::string output = (beside / sidecar.output).string();
  std::error_code ignored;
  if (fs::exists(output, ignored)) {
    TRY_ASSIGN(const std::string there,
               fs::is_directory(output, ignored) ? folder_hash(output, "") : hash_file(output));
    if (there != sidecar.hash) {
      return run_failure(output, "the file has changed since the sidecar was written");
    }
  }
  if (outcome->motions.front().hash == sidecar.hash) {
    observer.line("verified", sidecar.output + ": the output is identical");
    return {};
  }
  return run_failure(file, "the output differs from " + sidecar.output,
                     changed.empty() ? "all recorded inputs match; a different machine or build?"
                                     : list_names(changed));
}

namespace fs = std::filesystem;

namespace {

// The sidecar of a CSV. Returns nothing if it is missing or belongs to another file.
std::optional<Sidecar> sidecar_beside(const std::string& path) {
  const std::string file = path + ".json";
  if (path == "-" || !is_file(file)) return std::nullopt;
  const auto content = read_file(file, ErrorKind::kInput, kMaxTextBytes);
  if (!content) return std::nullopt;
  auto sidecar = read_sidecar(content->view(), file);
  if (!sidecar || sidecar->format != format_name(MotionFormat::kCsv) ||
      sidecar->output != fs::path(path).filename().string()) {
    return std::nullopt;
  }
  return *std::move(sidecar);
}

// The sidecar of a CSV if its hash matches the current content.
std::optional<Sidecar> own_sidecar(const std::string& path) {
  auto sidecar = sidecar_beside(path);
  if (!sidecar || !is_file(path)) return std::nullopt;
  const auto hash = hash_file(path);
  if (!hash || *hash != sidecar->hash) return std::nullopt;
  return sidecar;
}

bool has_variant(const Robot& robot, const std::string& name) {
  return std::ranges::find(robot.profile().variants, name, &RobotVariant::name) !=
         robot.profile().variants.end();
}

// Fills in options from the sidecar that are not given.
ReadMotionOptions completed(ReadMotionOptions options, const Sidecar& sidecar, const Robot& robot) {
  const SaveOptions& csv = sidecar.run.options.save;
  if (!options.rate && sidecar.fps > 0.0) options.rate = frame_rate_from_fps(sidecar.fps);
  if (!options.degrees) options.degrees = csv.degrees;
  if (!options.metres_per_unit) options.metres_per_unit = csv.centimetres ? 0.01 : 1.0;
  // A header already states the order.
  if (!options.quaternion && (!csv.header || options.ignore_header)) {
    options.quaternion = csv.quaternion;
  }
  const std::string& variant = sidecar.run.robot.variant;
  if (options.variant.empty() && has_variant(robot, variant)) options.variant = variant;
  return options;
}

}  // namespace

SourceOptions recorded_source(const std::string& path, SourceOptions options) {
  if (options.from_robot.empty()) return options;
  const auto sidecar = own_sidecar(path);
  if (!sidecar) return options;
  const SaveOptions& csv = sidecar->run.options.save;
  MotionFileOptions& file = options.robot_file;
  if (options.source_fps == 0.0) options.source_fps = sidecar->fps;
  if (file.angles.empty()) file.angles = csv.degrees ? "deg" : "rad";
  if (file.unit.empty()) file.unit = csv.centimetres ? "cm" : "m";
  // A header already states the order.
  if (!file.quaternion && (!csv.header || file.ignore_header)) file.quaternion = csv.quaternion;
  if (file.dof.empty()) file.dof = sidecar->run.robot.variant;
  return options;
}

std::string recorded_variant(const std::string& path) {
  const auto sidecar = own_sidecar(path);
  return sidecar ? sidecar->run.robot.variant : std::string();
}

std::string recorded_travel(const std::string& path) {
  const auto sidecar = own_sidecar(path);
  return sidecar ? chosen_travel(sidecar->run.options.solve) : std::string();
}

std::optional<TimeScale> recorded_time_scale(const std::string& path) {
  const auto sidecar = own_sidecar(path);
  return sidecar ? sidecar->time_scale : std::nullopt;
}

std::string recorded_scene_move(const std::string& path) {
  const auto sidecar = own_sidecar(path);
  if (!sidecar) return {};
  const Options& options = sidecar->run.options;
  if (options.save.normalize_start) return OPTION("normalize-start");
  return options.solve.object_motion == ObjectMotion::kFitted ? OPTION("object-motion") " fitted"
                                                              : "";
}

Result<RobotMotion> load_recorded_motion(const std::string& path,
                                         const std::shared_ptr<const Robot>& robot,
                                         const ReadMotionOptions& options) {
  const auto sidecar = sidecar_beside(path);
  if (!sidecar || !is_file(path)) return load_robot_motion(path, robot, options);
  TRY_ASSIGN(const auto content,
             read_file(path, ErrorKind::kInput, options.max_bytes, kLargeFileHint));
  TRY_ASSIGN(const std::string hash, hash_bytes(content.view()));
  const std::string name = fs::path(path + ".json").filename().string();
  if (hash != sidecar->hash) {
    TRY_ASSIGN(auto motion, parse_robot_motion(content.view(), robot, path, options));
    motion.notes.push_back(name + " belongs to another version of this file and is ignored");
    return motion;
  }
  TRY_ASSIGN(auto motion,
             parse_robot_motion(content.view(), robot, path, completed(options, *sidecar, *robot)));
  motion.notes.push_back("read as " + name + " records it");
  return motion;
}

void report_reading(const std::string& file, const RobotMotion& motion, Observer& observer,
                    const std::string& rate_option) {
  const std::string rate = rate_option.empty() ? OPTION("source-fps") : rate_option;
  observer.line("read", (file == "-" ? "standard input" : file) + ": " +
                            std::string(format_name(motion.format)) + ", " +
                            count_text(motion.clip.frame_count(), "frame") + " at " +
                            to_text(motion.clip.rate()) + " fps" +
                            (motion.rate_known ? "" : ", not given in the file: " + rate));
  for (const std::string& note : motion.notes) observer.line("", note);
  for (const std::string& warning : motion.warnings) observer.warn({{0, 0, warning}}, file);
}

}  // namespace retarget
