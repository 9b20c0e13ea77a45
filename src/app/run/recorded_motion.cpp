// The facts that the sidecar of a motion file records.

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/plan/robot_source.h"
#include "app/run/sidecar.h"
#include "base/option_name.h"
#include "base/try.h"
#include "motion/clip.h"
#include "retarget/file.h"
#include "retarget/hash.h"
#include "retarget/load.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/text.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

// The sidecar of a motion. Returns nothing if it is missing or invalid.
std::optional<Sidecar> sidecar_beside(const std::string& path) {
  const std::string file = path + ".json";
  if (path == "-" || !is_file(file)) return std::nullopt;
  const auto content = read_file(file, ErrorKind::kInput, kMaxTextBytes);
  if (!content) return std::nullopt;
  auto sidecar = read_sidecar(content->view(), file);
  return sidecar ? std::optional<Sidecar>(*std::move(sidecar)) : std::nullopt;
}

// The sidecar of a motion if its hash matches the current content. Both may have been renamed.
std::optional<Sidecar> own_sidecar(const std::string& path) {
  auto sidecar = sidecar_beside(path);
  if (!sidecar || !is_file(path)) return std::nullopt;
  const auto hash = hash_file(path);
  if (!hash || *hash != sidecar->hash) return std::nullopt;
  return sidecar;
}

// Other formats are self-describing.
bool is_of_csv(const Sidecar& sidecar) {
  return sidecar.format == format_name(MotionFormat::kCsv);
}

std::string name_of_sidecar(const std::string& path) {
  return fs::path(path + ".json").filename().string();
}

// A model without a profile has the name of its file, which identifies no robot.
bool is_named(const Robot& robot) {
  return !robot.profile().joint_order.empty() || !robot.profile().description.empty();
}

Result<void> check_recorded_robot(const Sidecar& sidecar, const Robot& robot,
                                  const std::string& path) {
  if (sidecar.robot.empty() || !is_named(robot) || sidecar.robot == robot.name()) return {};
  return input_failure(
      path,
      "the motion is of the robot " + sidecar.robot + ", as " + name_of_sidecar(path) +
          " records, but is read for " + robot.name(),
      "give the robot " + sidecar.robot + "; without its sidecar, the file is read for any robot");
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

Result<SourceOptions> recorded_source(const std::string& path, SourceOptions options,
                                      const DataFolder& data_folder) {
  if (options.from_robot.empty()) return options;
  const auto sidecar = own_sidecar(path);
  if (!sidecar) return options;
  TRY_ASSIGN(const SourceRobot source, load_source_robot(options.from_robot, data_folder));
  TRY(check_recorded_robot(*sidecar, *source.loaded.robot, path));
  if (!is_of_csv(*sidecar)) return options;
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

std::optional<RecordedRun> recorded_run(const std::string& path) {
  auto sidecar = own_sidecar(path);
  if (!sidecar) return std::nullopt;
  RecordedRun recorded{std::move(sidecar->run),
                       sidecar->mirror,
                       {},
                       std::move(sidecar->limits),
                       std::move(sidecar->time_scale)};
  const auto source = std::ranges::find(sidecar->files, "motion", &ReadFile::role);
  if (source != sidecar->files.end()) recorded.source_hash = source->hash;
  return recorded;
}

Result<RobotMotion> load_recorded_motion(const std::string& path,
                                         const std::shared_ptr<const Robot>& robot,
                                         const ReadMotionOptions& options) {
  const auto sidecar = sidecar_beside(path);
  if (!sidecar || !is_file(path)) return load_robot_motion(path, robot, options);
  TRY_ASSIGN(const auto content,
             read_file(path, ErrorKind::kInput, options.max_bytes, kLargeFileHint));
  TRY_ASSIGN(const std::string hash, hash_bytes(content.view()));
  const std::string name = name_of_sidecar(path);
  if (hash != sidecar->hash) {
    TRY_ASSIGN(auto motion, parse_robot_motion(content.view(), robot, path, options));
    if (sidecar->output == fs::path(path).filename().string()) {
      motion.notes.push_back(name + " belongs to another version of this file and is ignored");
    }
    return motion;
  }
  TRY(check_recorded_robot(*sidecar, *robot, path));
  if (!is_of_csv(*sidecar)) return parse_robot_motion(content.view(), robot, path, options);
  TRY_ASSIGN(auto motion,
             parse_robot_motion(content.view(), robot, path, completed(options, *sidecar, *robot)));
  motion.notes.push_back("read as " + name + " records it");
  return motion;
}

void report_reading(const std::string& file, const RobotMotion& motion, Observer& observer,
                    const std::string& rate_option) {
  const std::string rate = rate_option.empty() ? OPTION("source-fps") : rate_option;
  const std::string remedy = motion.format == MotionFormat::kCsvSoma
                                 ? "SOMA's 120 fps are assumed, " + rate + " states another rate"
                                 : "set " + rate;
  observer.line("read", (file == "-" ? "standard input" : file) + ": " +
                            std::string(format_name(motion.format)) + ", " +
                            count_text(motion.clip.frame_count(), "frame") + " at " +
                            to_text(motion.clip.rate()) + " fps" +
                            (motion.rate_known ? "" : "; the file states no rate: " + remedy));
  for (const std::string& note : motion.notes) observer.line("", note);
  for (const std::string& warning : motion.warnings) observer.warn({{0, 0, warning}}, file);
}

}  // namespace retarget
