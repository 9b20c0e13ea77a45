// The engine of the browser page as a WASI program. The page's worker gives it files in memory and
// reads its results from /out (docs/browser.md). Each run is a new instance, so a crash or a stop
// leaves nothing behind.
//
//   retarget solve FILE     solves the run that FILE describes: options by name, as in sidecars
//   retarget options        prints robots and rows of the options as JSON

#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "retarget/file.h"
#include "retarget/json.h"
#include "retarget/load.h"
#include "retarget/option_name.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/robots.h"
#include "retarget/solve.h"
#include "retarget/try.h"
#include "retarget/version.h"
#include "retarget/view.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDataFolder = "/data";

// The contacts by part, as [start, end] in seconds, for the page's timeline.
Json contacts_json(const Motion& motion) {
  const double frame_time = 1.0 / motion.clip.rate().fps();
  constexpr std::array kNames = {"left_heel", "left_toe", "right_heel", "right_toe"};
  Json json = Json::object();
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    Json phases = Json::array();
    for (const ContactPhase& phase : motion.contacts[i]) {
      phases.push_back({phase.begin * frame_time, phase.end * frame_time});
    }
    json[kNames[i]] = std::move(phases);
  }
  return json;
}

Json gates_json(const QualityReport& report) {
  Json missed = Json::array();
  for (const GateResult& gate : report.gates) {
    if (gate.passed) continue;
    const Metric* metric = find_metric(gate.metric);
    Json json = {{"metric", gate.metric},
                 {"unit", metric == nullptr ? std::string_view() : metric->unit}};
    if (gate.value) json["value"] = *gate.value;
    if (gate.min) json["min"] = *gate.min;
    if (gate.max) json["max"] = *gate.max;
    missed.push_back(std::move(json));
  }
  return missed;
}

// The page's worker shows these lines as progress.
bool show_progress(const Progress& progress) {
  const double done =
      progress.total > 0 ? static_cast<double>(progress.done) / progress.total : 0.0;
  const bool fits = progress.stage == Stage::kFit;
  std::fprintf(stderr, "progress %s %.4f\n", fits ? "fit" : "frames", done);
  return true;
}

Result<void> solve_run(const std::string& file) {
  Run run;
  RETARGET_TRY(load_options(file, run_table(run), "the options of the run"));
  if (run.options.solve.engine == IkEngine::kReference) {
    return usage_failure("the reference engine needs MuJoCo, which the page does not have",
                         "use the command line tool, or the engine fast");
  }
  const DataFolder data{kDataFolder};
  std::fprintf(stderr, "progress reading 0\n");
  RETARGET_TRY_ASSIGN(Clip clip, load_clip(run.motion, run.options.source, data));
  RETARGET_TRY_ASSIGN(LoadedRobot robot, load_robot(run.robot, data));
  RETARGET_TRY_ASSIGN(Plan plan, make_plan(std::move(clip), robot, run.options));
  Json result = {{"summary", plan.summary()}, {"robot", robot.name}};
  SolveControl control;
  control.keep_going = show_progress;
  control.threads = 1;
  RETARGET_TRY_ASSIGN(const Motion motion, solve(std::move(plan), control));
  RETARGET_TRY(save(motion, run.output));
  std::fprintf(stderr, "progress measuring 0\n");
  RETARGET_TRY_ASSIGN(const QualityReport report, evaluate(motion));
  const std::span one(&report, 1);
  result["frames"] = motion.clip.frame_count();
  result["seconds"] = motion.clip.frame_count() / motion.clip.rate().fps();
  result["fps"] = motion.clip.rate().fps();
  result["passed"] = report.passed();
  result["missed"] = gates_json(report);
  result["report"] = spell_options(report_text(one));
  result["notes"] = motion.fit ? Json(motion.fit->notes) : Json::array();
  result["contacts"] = contacts_json(motion);
  RETARGET_TRY(write_file("/out/report.json", report_json(one)));
  std::fprintf(stderr, "progress drawing 0\n");
  RETARGET_TRY_ASSIGN(const std::string page, view_page(motion, robot.name, &report));
  RETARGET_TRY(write_file("/out/page.html", page));
  return write_file("/out/result.json", printable_dump(result));
}

Json option_json(const Option& row) {
  Json json = {{"name", row.name},
               {"group", row.info.group},
               {"help", spell_options(row.info.help)},
               {"type", row.info.type}};
  const OptionValue value = row.get();
  json["kind"] = row.is_flag()                                 ? "flag"
                 : row.is_list()                               ? "list"
                 : std::holds_alternative<std::string>(value)  ? "text"
                 : std::holds_alternative<std::int64_t>(value) ? "integer"
                                                               : "number";
  if (!row.choices.empty()) json["choices"] = row.choices;
  json["standard"] = to_text(value);
  json["basic"] = row.info.basic;
  json["file"] = row.info.file == OptionFile::kContent;
  return json;
}

Result<void> print_options() {
  Run run;
  Json options = Json::array();
  for (const Option& row : run_table(run)) options.push_back(option_json(row));
  Json robots = Json::array();
  RETARGET_TRY_ASSIGN(const auto known, known_robots(robot_folders(kDataFolder)));
  for (const KnownRobot& robot : known) {
    if (find_robot(robot.name, robot_folders(kDataFolder))) {
      robots.push_back({{"name", robot.name}, {"description", robot.description}});
    }
  }
  const Json json = {{"version", version_number()}, {"robots", robots}, {"options", options}};
  return write_file("/out/options.json", printable_dump(json));
}

int run(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  Result<void> done = usage_failure("expected: solve FILE, or options");
  if (words.size() == 2 && words[0] == "solve") done = solve_run(words[1]);
  if (words.size() == 1 && words[0] == "options") done = print_options();
  if (done) return 0;
  std::fprintf(stderr, "%s\n", describe(done.error()).c_str());
  return 1;
}

}  // namespace
}  // namespace retarget

int main(int argc, char** argv) {
  return retarget::run(argc, argv);
}
