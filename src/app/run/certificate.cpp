#include "retarget/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "app/run/sidecar.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/hash.h"
#include "retarget/json.h"
#include "retarget/option_table.h"
#include "retarget/simulate.h"
#include "retarget/text.h"
#include "retarget/tracking_predictor.h"
#include "retarget/version.h"
#include "solve/dynamics/contact_forces.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "retarget-certificate-1";
// Members that no other document of this tool has.
constexpr std::array kOwnMembers = {"margins", "prediction", "verdict"};

// Options that differ from their defaults, as texts by name.
Json given_options(const OptionTable& rows, const OptionTable& defaults) {
  Json given = Json::object();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string text = to_text(rows[i].get());
    if (text != to_text(defaults[i].get())) given[rows[i].name] = text;
  }
  return given;
}

Result<void> restore_given(const Json& given, const OptionTable& rows, const std::string& file) {
  for (const auto& [name, text] : given.items()) {
    const auto row = std::ranges::find(rows, name, &Option::name);
    if (row == rows.end() || !text.is_string()) {
      return input_failure(file, "unknown option in the certificate: \"" + name + "\"",
                           "it may come from a newer version of this tool");
    }
    const auto value = option_value(*row, text.get<std::string>());
    const auto set = value ? row->set(*value) : Result<void>(failure(value.error()));
    if (set) continue;
    return input_failure(file,
                         "the option \"" + name + "\" of the certificate: " + set.error().message);
  }
  return {};
}

Json request_json(const MeasureRequest& request) {
  Run run = request.run, plain_run;
  ReadingOptions reading = request.reading, plain_reading;
  Json json;
  json["options"] = given_options(run_table(run), run_table(plain_run));
  json["reading"] = given_options(reading_table(reading), reading_table(plain_reading));
  json["fps"] = request.fps;
  json["mirror"] = request.of_source.mirror;
  json["gates"] = request.gates;
  return json;
}

Result<MeasureRequest> request_from(const Json& json, const std::string& file) {
  const bool sound = json.is_object() && json.contains("options") && json["options"].is_object() &&
                     json.contains("reading") && json["reading"].is_object() &&
                     json.contains("fps") && json["fps"].is_string() && json.contains("mirror") &&
                     json["mirror"].is_boolean() && json.contains("gates");
  const auto gates = sound ? value_from<std::vector<std::string>>(json["gates"]) : std::nullopt;
  if (!gates) return input_failure(file, "the certificate's \"request\" is not complete");
  MeasureRequest request;
  TRY(restore_given(json["options"], run_table(request.run), file));
  TRY(restore_given(json["reading"], reading_table(request.reading), file));
  request.fps = json["fps"].get<std::string>();
  request.of_source.mirror = json["mirror"].get<bool>();
  request.gates = *gates;
  return request;
}

Json file_json(const std::string& role, const std::string& file, const std::string& hash) {
  Json json = {{"role", role}};
  put_name(json, "file", file);
  json["hash"] = hash.empty() ? Json() : Json(hash);
  return json;
}

// The file of a recorded name. Names below the data folder are recorded relative to it.
std::string file_of_recorded_name(const std::string& name, const std::string& data_folder) {
  std::error_code ignored;
  const fs::path below = fs::path(data_folder) / name;
  return !name.empty() && fs::exists(below, ignored) ? below.string() : name;
}

Result<Json> inputs_json(const MeasureRequest& request, const QualityReport& report,
                         const std::string& predictor, Observer& observer) {
  TRY_ASSIGN(const LoadedRobot robot, load_robot(request.run.robot, request.data_folder, observer));
  const std::string config =
      request.run.motion.empty() ? "" : file_of_recorded_name(report.config, robot.data_folder);
  TRY_ASSIGN(const std::vector<ReadFile> files, files_read(request.run, robot, config));
  Json inputs = Json::array();
  for (const ReadFile& file : files) {
    const std::string role = file.role == "motion" ? "source" : file.role;
    inputs.push_back(file_json(role, file.file, file.hash));
  }
  TRY_ASSIGN(const std::string hash, hash_file(predictor, ErrorKind::kConfig));
  inputs.push_back(file_json("predictor", fs::path(predictor).filename().string(), hash));
  return inputs;
}

// The options of the run that made the motion, if its sidecar exists and belongs to it.
Result<Json> sidecar_json(const std::string& motion, const std::string& hash) {
  const std::string file = motion + ".json";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return Json();
  TRY_ASSIGN(const auto content, read_file(file, ErrorKind::kInput, kMaxTextBytes));
  const auto sidecar = read_sidecar(content.view(), file);
  if (!sidecar || sidecar->hash != hash) return Json();
  TRY_ASSIGN(const Json whole, parse_json(content.view(), file));
  TRY_ASSIGN(const std::string own_hash, hash_bytes(content.view()));
  Json json = file_json("sidecar", fs::path(file).filename().string(), own_hash);
  json["options"] = whole["options"];
  return json;
}

Json value_or_null(const QualityReport& report, const char* key, double factor, double offset) {
  const MetricValue* const found = report.find(key);
  if (found == nullptr || !std::isfinite(found->value)) return {};
  return offset + factor * found->value;
}

// Positive margins are kept, negative ones are exceeded.
Json margins_json(const QualityReport& report) {
  return {{"torque", value_or_null(report, "torque_p99_ratio", -1.0, 1.0)},
          {"friction", value_or_null(report, "friction_p95", -1.0, ContactForces::kFriction)},
          {"zmp_cm", value_or_null(report, "zmp_margin_p5_cm", 1.0, 0.0)},
          {"dynamics_bad_pct", value_or_null(report, "dynamics_bad_pct", 1.0, 0.0)}};
}

RobotClip part_of(const RobotClip& clip, int begin, int end) {
  RobotClip part(clip.shared_robot(), clip.rate(), end - begin);
  for (int i = begin; i < end; ++i) std::ranges::copy(clip.qpos(i), part.qpos(i - begin).begin());
  return part;
}

// Windows of about equal length, at most 1.5 times the predictor's.
Json prediction_json(const RobotClip& clip, const LimitSet& limits,
                     const TrackingPredictor& predictor, double& success) {
  const double frames = std::max(3.0, predictor.window_s * clip.rate().fps());
  const int count = std::max(1, static_cast<int>(std::lround(clip.frame_count() / frames)));
  Json windows = Json::array();
  success = 1.0;
  for (int i = 0; i < count; ++i) {
    const auto begin = static_cast<int>(static_cast<long>(clip.frame_count()) * i / count);
    const auto end = static_cast<int>(static_cast<long>(clip.frame_count()) * (i + 1) / count);
    const RobotClip part = part_of(clip, begin, end);
    const auto measure = measure_motion(part, limits, nullptr, true);
    const std::optional<double> probability = predictor.probability(measure.report);
    windows.push_back({{"begin", begin}, {"end", end}});
    windows.back()["probability"] = probability ? Json(*probability) : Json();
    success = probability && success >= 0.0 ? success * *probability : -1.0;
  }
  Json json;
  json["predicted_tracking_success"] = success >= 0.0 ? Json(success) : Json();
  json["window_s"] = predictor.window_s;
  json["windows"] = windows;
  json["auc"] = predictor.auc;
  json["calibration"] = Json::array();
  for (const CalibrationBin& bin : predictor.calibration) {
    json["calibration"].push_back(
        {{"predicted", bin.predicted}, {"observed", bin.observed}, {"windows", bin.windows}});
  }
  return json;
}

// Share of the motion before the fall, %.
double tracked_pct(const SimulationReport& report) {
  const double length = (report.frames - 1) / report.fps;
  return report.fell ? std::clamp(100.0 * report.fall_time_s / length, 0.0, 100.0) : 100.0;
}

// Adds the metrics of the certificate to the report, and judges it again.
void add_figures(const Certificate& certificate, const Gates& gates, QualityReport& report) {
  report.values.push_back({find_metric(kTrackedFigure), certificate.tracked_pct, {}});
  if (certificate.predicted_success >= 0.0) {
    report.values.push_back({find_metric(kPredictedFigure), certificate.predicted_success, {}});
  }
  gates.judge(report);
}

// How the sidecar of a motion differs from the recorded one; empty: it does not.
std::string sidecar_change(const Json& recorded, const Json& now, const std::string& file) {
  if (recorded == now) return {};
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    return "the sidecar " + file + ", whose options the certificate records, is missing";
  }
  return "the sidecar " + file +
         (recorded.is_null() ? " was written after the certificate"
                             : " has changed since the certificate was written");
}

// Files may have moved to another folder, but keep their names.
bool is_same_name(const Json& recorded, const Json& now) {
  const auto name = [](const Json& input) { return fs::path(name_from(input, "file")).filename(); };
  return recorded.is_object() && recorded.value("role", Json()) == now["role"] &&
         name(recorded) == name(now);
}

// The first member in which two documents differ, as a path; empty: none.
std::string first_difference(const Json& recorded, const Json& now) {
  const Json changes = Json::diff(recorded, now);
  return changes.empty() ? std::string() : changes.front()["path"].get<std::string>();
}

}  // namespace

Result<Certificate> certify(const MeasureRequest& asked, Observer& observer) {
  MeasureRequest request = asked;
  request.dynamics = true;
  if (request.motions.size() != 1 || request.motions.front() == "-") {
    return usage_failure("a certificate needs the file of one motion");
  }
  const std::string& file = request.motions.front();
  TRY_ASSIGN(const std::string hash, hash_file(file));
  TRY_ASSIGN(const Measures measures, load_measures(request, observer));
  TRY_ASSIGN(MeasuredMotion motion, measure_file(file, measures, observer));
  TRY_ASSIGN(const std::string data_folder, find_data_folder(request.data_folder));
  const std::string predictor_file = tracking_predictor_file(data_folder);
  TRY_ASSIGN(const auto text, read_file(predictor_file, ErrorKind::kConfig, kMaxTextBytes));
  TRY_ASSIGN(const TrackingPredictor predictor,
             parse_tracking_predictor(text.view(), predictor_file));
  SimulateOptions options;
  options.is_stopped = [&observer] { return observer.is_stopped(); };
  TRY_ASSIGN(const Simulation simulation, simulate(motion.clip, options));

  Certificate certificate;
  const Json prediction =
      prediction_json(motion.clip, measures.limits, predictor, certificate.predicted_success);
  certificate.fell = simulation.report.fell;
  certificate.tracked_pct = tracked_pct(simulation.report);
  add_figures(certificate, measures.gates, motion.report);
  Json json;
  json["schema"] = kSchema;
  json["retarget"] = version_number();
  json["motion"] = Json::object();
  put_name(json["motion"], "file", fs::path(file).filename().string());
  json["motion"]["hash"] = hash;
  json["request"] = request_json(request);
  TRY_ASSIGN(json["inputs"], inputs_json(request, motion.report, predictor_file, observer));
  TRY_ASSIGN(json["sidecar"], sidecar_json(file, hash));
  Json quality = Json::parse(report_json({&motion.report, 1}), nullptr, false);
  json["quality"] = quality["motions"][0];
  json["margins"] = margins_json(motion.report);
  json["simulation"] = Json::parse(simulation_json(simulation.report), nullptr, false);
  json["prediction"] = prediction;
  certificate.gates_passed = motion.report.passed();
  json["verdict"] = {{"gates_passed", certificate.gates_passed},
                     {"simulated_without_fall", !certificate.fell},
                     {"passed", certificate.passed()}};
  certificate.json = printable_dump(json);
  certificate.report = std::move(motion.report);
  return certificate;
}

std::string certificate_file(const std::string& motion) {
  return motion + ".certificate.json";
}

bool is_certificate(std::string_view text) {
  if (text.substr(0, 200).find(kSchema) != std::string_view::npos) return true;
  if (!check_json_bounds(text, {})) return false;
  const Json json = Json::parse(text, nullptr, false);
  return json.is_object() && std::ranges::all_of(kOwnMembers, [&](const char* member) {
           return json.contains(member);
         });
}

Result<void> verify_certificate(std::string_view text, const std::string& file,
                                const DataFolder& data_folder, Observer& observer) {
  TRY_ASSIGN(const Json recorded, parse_json(text, file));
  if (!recorded.is_object() || recorded.value("schema", Json()) != Json(kSchema)) {
    return input_failure(file,
                         std::string("\"schema\" of the certificate is not \"") + kSchema + "\"",
                         "it was changed, or made by another version of this tool");
  }
  const bool sound =
      recorded.contains("motion") && recorded["motion"].is_object() && recorded.contains("request");
  const std::string name = sound ? name_from(recorded["motion"], "file") : std::string();
  if (!is_plain_name(name)) return input_failure(file, "the file is not a certificate");
  TRY_ASSIGN(MeasureRequest request, request_from(recorded["request"], file));
  const fs::path beside = fs::path(file).parent_path();
  MeasureRequest here = request;
  here.data_folder = data_folder;
  find_moved(here.run.motion, beside);
  find_moved_robot(here.run.robot.name, beside, data_folder);
  here.motions = {(beside / name).string()};
  TRY_ASSIGN(const std::string hash, hash_file(here.motions.front()));
  if (Json(hash) != recorded["motion"].value("hash", Json())) {
    return run_failure(here.motions.front(),
                       "the motion has changed since the certificate was written");
  }
  TRY_ASSIGN(const Certificate certificate, certify(here, observer));
  Json now = Json::parse(certificate.json, nullptr, false);
  now["request"] = recorded["request"];
  const Json inputs = recorded.value("inputs", Json::array());
  const std::size_t known = inputs.is_array() ? inputs.size() : 0;
  for (std::size_t i = 0; i < std::min(known, now["inputs"].size()); ++i) {
    Json& input = now["inputs"][i];
    if (is_same_name(inputs[i], input)) input["file"] = inputs[i].value("file", Json());
  }
  const std::string difference = first_difference(recorded, now);
  if (difference.empty()) {
    observer.line("verified", name + ": all values are identical");
    return {};
  }
  const bool same_version = recorded.value("retarget", Json()) == Json(version_number());
  const std::string sidecar = sidecar_change(recorded.value("sidecar", Json()), now["sidecar"],
                                             here.motions.front() + ".json");
  return run_failure(file, "the certificate differs at " + difference,
                     !sidecar.empty() ? sidecar
                     : same_version ? "it was changed, or an input was, or it was made on another "
                                      "machine; a changed request changes the values, too"
                                    : "it was made by another version of this tool");
}

}  // namespace retarget
