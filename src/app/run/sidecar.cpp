#include "app/run/sidecar.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/options/options_json.h"
#include "app/plan/robot_source.h"
#include "app/run/scene_hash.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/data_folder.h"
#include "retarget/enum_names.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/human.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/robots.h"
#include "retarget/scene.h"
#include "retarget/version.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

// Files that belong to the robot, regardless of the option that names them.
constexpr std::array<std::string_view, 3> kOfTheRobot = {"robot-xml", "robot-profile", "ik-config"};

Result<void> add_file(std::vector<ReadFile>& files, const std::string& role,
                      const std::string& path, const std::string& data_folder) {
  if (path.empty()) return {};
  ReadFile file{role, recorded_name(path, data_folder), path, {}};
  // A pipe has already been consumed; every other file must be hashable.
  std::error_code ignored;
  if (path != "-" && !fs::is_fifo(path, ignored)) {
    TRY_ASSIGN(file.hash, motion_hash(path));
  }
  files.push_back(std::move(file));
  return {};
}

// Adds the shapes of the scene, which may come from other files, and the object tracks.
Result<void> add_surroundings(std::vector<ReadFile>& files, const SolveOptions& solve,
                              const std::string& data_folder) {
  if (is_file(solve.scene)) {
    TRY_ASSIGN(std::string hash, scene_hash(solve.scene));
    files.push_back(
        {"scene geometry", recorded_name(solve.scene, data_folder), solve.scene, std::move(hash)});
  }
  for (const auto& [role, file] : object_track_files(solve)) {
    TRY(add_file(files, role, file, data_folder));
  }
  return {};
}

// The pace from its first coefficient above 1 to its last.
Json time_scale_json(const TimeScale& scale) {
  const auto slowed = [](double pace) { return pace > 1.0; };
  const auto first = std::ranges::find_if(scale.pace, slowed);
  auto last = scale.pace.end();
  while (last != first && !slowed(*(last - 1))) --last;
  return {{"knot_s", scale.knot_time},
          {"first_knot", first - scale.pace.begin()},
          {"pace", std::vector<double>(first, last)},
          {"longer_s", scale.longer}};
}

double number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : -1.0;
}

// The parts of a time scale, as in a report.
std::vector<SlowedStretch> stretches_from(const Json& report, const char* key) {
  std::vector<SlowedStretch> stretches;
  const auto list = report.find(key);
  if (list == report.end() || !list->is_array()) return stretches;
  for (const Json& each : *list) {
    if (!each.is_object()) continue;
    stretches.push_back({number_of(each, "begin"), number_of(each, "end"),
                         number_of(each, "factor"), text_at(each, "cause")});
  }
  return stretches;
}

// The same read back; damaged members count as absent.
std::optional<TimeScale> time_scale_from(const Json& found) {
  constexpr double kMaxKnots = 1e6;
  const auto json = found.find("time_scale");
  if (json == found.end() || !json->is_object()) return std::nullopt;
  const double knot_time = number_of(*json, "knot_s");
  const double first = number_of(*json, "first_knot");
  const auto pace = json->find("pace");
  if (!(knot_time >= 1e-3 && knot_time <= 1e3) || !(first >= 0.0 && first <= kMaxKnots) ||
      pace == json->end() || !pace->is_array()) {
    return std::nullopt;
  }
  TimeScale scale;
  scale.knot_time = knot_time;
  scale.longer = number_of(*json, "longer_s");
  scale.pace.assign(static_cast<std::size_t>(first), 1.0);
  for (const Json& each : *pace) {
    const double value = each.is_number() ? each.get<double>() : 0.0;
    if (!(value >= 1.0 && value <= 1.0 / kLeastTimeScale)) return std::nullopt;
    scale.pace.push_back(value);
  }
  return scale;
}

// Facts detected in the motion or chosen for it.
Json found_json(const Plan& plan) {
  const Calibration& calibration = plan.human.calibration;
  Json found;
  found["skeleton"] = calibration.description;
  found["dialect"] = calibration.profile;
  found["unit"] = calibration.unit;
  found["metres_per_unit"] = calibration.metres_per_unit;
  found["up"] = to_text(calibration.up);
  found["forward"] = to_text(calibration.forward);
  found["rest_pose"] = calibration.rest_pose;
  found["height"] = calibration.height;
  found["scale"] = enum_name(plan.scale);
  if (const auto& travel = plan.travel) {
    found["travel"] = {
        {"factor", travel->factor}, {"least", travel->least}, {"greatest", travel->greatest}};
  }
  if (plan.time_scale) found["time_scale"] = time_scale_json(*plan.time_scale);
  found["limits"] = plan.limits.name;
  found["fps"] = plan.rate.fps();
  found["lead_in_frames"] = plan.lead_in_frames;
  Json doubts = Json::array();
  for (const Warning& doubt : plan.doubts()) {
    doubts.push_back(spell_options(doubt.message, option_as_flag));
  }
  found["doubts"] = doubts;
  return found;
}

Json build_json() {
  Json build = Json::array();
  const std::string text = version_text();
  for (std::string_view facts = text; !facts.empty();) build.push_back(take_until(facts, '\n'));
  return build;
}

// The robot is recorded by name or folder; the report has the name of its profile.
std::string robot_from(const Json& report, const RobotChoice& choice) {
  if (choice.name.empty()) return {};
  if (std::string name = text_at(report, "robot"); !name.empty()) return name;
  return fs::path(choice.name).filename().string();
}

}  // namespace

Json report_in(const Json& sidecar) {
  const auto quality = sidecar.find("quality");
  if (quality == sidecar.end() || !quality->is_object()) return Json::object();
  const Json motions = quality->value("motions", Json::array());
  const bool sound = motions.is_array() && !motions.empty() && motions[0].is_object();
  return sound ? motions[0] : Json::object();
}

std::vector<std::pair<std::string, std::string>> object_track_files(const SolveOptions& options) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const std::string& track : options.object_tracks) {
    files.emplace_back("object-track " + std::to_string(files.size() + 1),
                       object_track_file(track));
  }
  return files;
}

Result<std::vector<ReadFile>> files_read(const Run& run, const LoadedRobot& robot,
                                         const std::string& config) {
  const std::string& data_folder = robot.data_folder;
  std::vector<ReadFile> files;
  TRY(add_file(files, "motion", run.motion, data_folder));
  if (const std::string& source = run.options.source.from_robot; !source.empty()) {
    TRY_ASSIGN(const SourceRobot from, load_source_robot(source, {data_folder}));
    TRY(add_file(files, "source_model", from.loaded.model, data_folder));
    TRY(add_file(files, "source_profile", from.loaded.profile, data_folder));
    TRY(add_file(files, "source_mapping", from.config.file, data_folder));
  }
  TRY(add_file(files, "model", robot.model, data_folder));
  TRY(add_file(files, "variant_model", robot.robot->variant().model, data_folder));
  TRY(add_file(files, "profile", robot.profile, data_folder));
  TRY(add_file(files, "mapping", config, data_folder));
  Run copy = run;
  for (const Option& row : run_table(copy)) {
    if (row.info.file == OptionFile::kNone || std::ranges::count(kOfTheRobot, row.name)) continue;
    const std::string path = to_text(row.get());
    std::error_code ignored;
    // The value may be the name of a set instead of a file.
    if (row.info.file == OptionFile::kOrName && !fs::is_regular_file(path, ignored)) continue;
    TRY(add_file(files, row.name, path, data_folder));
  }
  TRY(add_surroundings(files, run.options.solve, data_folder));
  const fs::path profiles = fs::path(data_folder) / "configs" / "skeletons";
  TRY_ASSIGN(std::string hash, folder_hash(profiles, ".json"));
  files.push_back(
      {"skeletons", recorded_name(profiles, data_folder), profiles.string(), std::move(hash)});
  return files;
}

std::string sidecar_text(const Run& run, const Motion& motion, const WrittenFile& output,
                         const QualityReport& report, const std::vector<ReadFile>& files,
                         bool mirror) {
  Json json;
  json["retarget"] = version_number();
  json["build"] = build_json();
  json["output"] = Json::object();
  put_name(json["output"], "file", fs::path(output.item.path).filename().string());
  json["output"]["format"] = format_name(output.item.format);
  json["output"]["hash"] = output.hash;
  Json inputs = Json::array();
  for (const ReadFile& file : files) {
    Json& input = inputs.emplace_back(Json::object());
    input["role"] = file.role;
    put_name(input, "file", file.file);
    input["hash"] = file.hash.empty() ? Json() : Json(file.hash);
  }
  json["inputs"] = inputs;
  Run copy = run;
  json["options"] = options_json(run_table(copy));
  if (mirror) json["mirror"] = true;
  json["found"] = found_json(motion.plan);
  json["quality"] = Json::parse(report_json({&report, 1}), nullptr, false);
  // Skeleton names may contain invalid UTF-8, which is replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<Sidecar> read_sidecar(std::string_view text, const std::string& file) {
  const auto as_input = [](Error error) {
    error.kind = ErrorKind::kInput;
    return failure(std::move(error));
  };
  if (auto bounds = check_json_bounds(text, file); !bounds) return as_input(bounds.error());
  const Json json = Json::parse(text, nullptr, false);
  const bool sound = json.is_object() && json.contains("output") && json["output"].is_object() &&
                     json.contains("options") && json.contains("inputs") &&
                     json["inputs"].is_array();
  if (!sound) {
    return input_failure(file, "the file is not a run's sidecar",
                         "a run writes the sidecar next to its output, such as walk.csv.json");
  }
  Sidecar sidecar;
  sidecar.version = text_at(json, "retarget");
  sidecar.output = name_from(json["output"], "file");
  // The output must be in the folder of the sidecar.
  if (!is_plain_name(sidecar.output)) {
    return input_failure(file, "the sidecar's output \"" + sidecar.output +
                                   "\" is not the name of a file in the same folder");
  }
  sidecar.format = text_at(json["output"], "format");
  sidecar.hash = text_at(json["output"], "hash");
  if (const auto found = json.find("found"); found != json.end() && found->is_object()) {
    if (const auto fps = found->find("fps"); fps != found->end() && fps->is_number()) {
      sidecar.fps = fps->get<double>();
    }
    sidecar.time_scale = time_scale_from(*found);
    sidecar.limits = text_at(*found, "limits");
  }
  const Json report = report_in(json);
  sidecar.has_dynamics = std::ranges::any_of(quality_metrics(), [&](const Metric& metric) {
    return needs_dynamics(metric) && report.contains(std::string(metric.key));
  });
  const auto pace = report.find("time_scale");
  if (sidecar.time_scale && pace != report.end() && pace->is_object()) {
    sidecar.time_scale->stretches = stretches_from(*pace, "stretches");
    sidecar.time_scale->left = stretches_from(*pace, "not_slowed");
  }
  // Sidecars from before these options existed describe runs that used all frames, uncleaned.
  sidecar.run.options.part.lead_in = LeadIn::kKeep;
  sidecar.run.options.human.clean = CleanRule::kOff;
  auto options =
      read_options(json["options"], run_table(sidecar.run), file, "the sidecar's options");
  if (!options) {
    options.error().hint = "it may come from a newer version of this tool";
    return as_input(options.error());
  }
  sidecar.robot = robot_from(report, sidecar.run.robot);
  const auto mirror = json.find("mirror");
  sidecar.mirror = mirror != json.end() && mirror->is_boolean() && mirror->get<bool>();
  for (const Json& each : json["inputs"]) {
    if (!each.is_object()) continue;
    sidecar.files.push_back(
        {text_at(each, "role"), name_from(each, "file"), {}, text_at(each, "hash")});
  }
  return sidecar;
}

void find_moved(std::string& file, const fs::path& beside) {
  std::error_code ignored;
  if (file.empty() || file == "-" || fs::exists(file, ignored)) return;
  const fs::path near = beside / fs::path(file).filename();
  const fs::path below = beside / file;
  if (fs::exists(below, ignored)) {
    file = below.string();
  } else if (fs::exists(near, ignored)) {
    file = near.string();
  }
}

void find_moved_robot(std::string& robot, const fs::path& beside, const DataFolder& data_folder) {
  const auto folder = find_data_folder(data_folder);
  if (folder) {
    const std::vector<std::string> known = list_robots(robot_folders(*folder));
    if (std::ranges::find(known, robot) != known.end()) return;
  }
  find_moved(robot, beside);
}

}  // namespace retarget
