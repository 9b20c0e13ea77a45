// `retarget evaluate`: how good robot motions are, held against gates.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "base/file.h"
#include "base/printable.h"
#include "base/suggest.h"
#include "commands.h"
#include "interrupt.h"
#include "quality/measure.h"
#include "read_source.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"
#include "robot/resample_robot.h"
#include "robot_mapping.h"
#include "robot_motion_options.h"
#include "run_report.h"
#include "run_setup.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsualRate = "30";

// what all motions of one call are measured with
struct Measures {
  std::shared_ptr<const Robot> robot;
  LimitSet limits;
  ReadMotionOptions reading;
  FrameRate rate;  // of the source
  std::optional<HumanClip> human;
  std::optional<HumanClip> human_with_lead_in;  // where there is one
  std::optional<ResolvedMapping> tables;
  HeightScale scale = HeightScale::kPublished;
  std::string source;   // file name
  std::string mapping;  // file
  Gates gates;
};

Result<void> check_usage(const EvaluateOptions& options) {
  const RunOptions& run = options.run;
  if (auto robot = check_robot_choice(run); !robot) return robot;
  const bool source = !run.source.file.empty() || !run.smpl_file.empty();
  if (!source && (run.start_s >= 0.0 || run.fps == "source")) {
    return usage_failure(
        std::string(run.fps == "source" ? "--fps source" : "--start") + " needs the source",
        "add --bvh FILE");
  }
  const auto inputs = std::ranges::count(options.motions, "-") + (run.source.file == "-" ? 1 : 0);
  if (inputs > 1) return usage_failure("standard input can be read once only");
  std::vector<std::string> read = options.motions;
  read.insert(read.end(), options.gates.begin(), options.gates.end());
  const std::vector<std::string> of_run = files_of(run);
  read.insert(read.end(), of_run.begin(), of_run.end());
  return check_written({options.json, run.human.write_map}, read);
}

// `METRIC=NUMBER` or `METRIC=none`
Result<Gate> gate_from_text(const std::string& text, std::size_t equals) {
  Gate gate{text.substr(0, equals), std::nullopt, std::nullopt};
  if (find_metric(gate.metric) == nullptr) {
    return usage_failure("--gate names an unknown metric \"" + gate.metric + "\"" +
                         did_you_mean(gate.metric, metric_keys()));
  }
  const std::string_view number = std::string_view(text).substr(equals + 1);
  if (number == "none") return gate;
  double most = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), most);
  if (error != std::errc() || end != number.data() + number.size()) {
    return usage_failure("--gate " + gate.metric +
                         "= must be followed by a number or none, found \"" + std::string(number) +
                         "\"");
  }
  gate.most = most;
  return gate;
}

Result<Gates> gates_of(const EvaluateOptions& options, const fs::path& data_folder) {
  auto gates = default_gates(data_folder);
  if (!gates) return gates;
  for (const std::string& text : options.gates) {
    const std::size_t equals = text.find('=');
    std::error_code ignored;
    if (text == "none") {
      gates->clear();
    } else if (equals == std::string::npos || fs::exists(text, ignored)) {
      if (auto added = gates->add_file(text); !added) return failure(added.error());
    } else {
      auto gate = gate_from_text(text, equals);
      if (!gate) return failure(gate.error());
      gates->set(std::move(*gate));
    }
  }
  return gates;
}

Result<void> add_source(const RunOptions& run, const ChosenRobot& robot,
                        const fs::path& data_folder, Measures& measures, Console& console) {
  const auto mappings = load_mappings(run, robot, data_folder);
  if (!mappings) return failure(mappings.error());
  const auto source = load_source(run, data_folder, console);
  if (!source) return failure(source.error());
  measures.tables = mappings->for_source(source->human);
  measures.mapping = recorded_name(measures.tables->file, data_folder);
  measures.human = to_human(source->clip, source->human.calibration.mapping);
  measures.scale = choose_scale(source->human, *robot.robot, *measures.tables, run);
  measures.rate = source->clip.rate();
  if (source->lead_in > 0) {
    RunOptions with_lead_in = run;
    with_lead_in.lead_in = "keep";
    ConsoleNotes unread;
    Console silent(unread);
    const auto whole = load_source(with_lead_in, data_folder, silent);
    if (!whole) return failure(whole.error());
    measures.human_with_lead_in = to_human(whole->clip, whole->human.calibration.mapping);
  }
  measures.source = fs::path(source_name(run.source)).filename().string();
  return {};
}

Result<Measures> load_measures(const EvaluateOptions& options, Console& console) {
  RunOptions run = options.run;
  if (auto chosen = choose_motion_file(run); !chosen) return failure(chosen.error());
  const bool rate_given = !run.fps.empty();
  if (!rate_given) run.fps = kUsualRate;
  const auto data_folder = data_folder_of(run.common);
  if (!data_folder) return failure(data_folder.error());
  Measures measures;
  auto gates = gates_of(options, *data_folder);
  if (!gates) return failure(gates.error());
  measures.gates = std::move(*gates);
  const auto robot = load_chosen_robot(run, *data_folder, console, Soles::kNeeded);
  if (!robot) return failure(robot.error());
  measures.robot = robot->robot;
  auto limits = load_limits(*measures.robot,
                            run.limits.empty() ? measures.robot->limits_for({}) : run.limits);
  if (!limits) return failure(limits.error());
  measures.limits = std::move(*limits);
  const auto rate = output_rate(run.fps);
  if (!rate) return failure(rate.error());
  if (*rate) measures.rate = **rate;
  auto reading = read_motion_options(options.reading, run.source);
  if (!reading) return failure(reading.error());
  measures.reading = std::move(*reading);
  if (run.source.file.empty()) {
    if (run.source.source_fps > 0.0) {
      measures.reading.rate = frame_rate_from_fps(run.source.source_fps);
    }
  } else if (auto added = add_source(run, *robot, *data_folder, measures, console); !added) {
    return failure(added.error());
  }
  if (rate_given) measures.reading.default_rate = measures.rate;
  return measures;
}

QualityReport measure_beside(const RobotClip& motion, const Measures& measures,
                             const HumanClip& human) {
  const QualitySource source{&human, &*measures.tables, measures.scale};
  return measure_quality(motion, measures.limits, &source);
}

// how far the limbs are from the human's, degrees
double limb_angle(const QualityReport& report) {
  const MetricValue* found = report.find("limb_angle_deg");
  return found == nullptr ? HUGE_VAL : found->value;
}

// A motion may have been made with the frames in front or without them, and be a part alone: it is
// held against those that its limbs follow.
QualityReport measure_motion(const RobotClip& motion, const Measures& measures,
                             const std::string& file, Console& console) {
  if (!measures.human) return measure_quality(motion, measures.limits, nullptr);
  const HumanClip* human = &*measures.human;
  QualityReport report = measure_beside(motion, measures, *human);
  if (const auto& whole = measures.human_with_lead_in) {
    QualityReport with_lead_in = measure_beside(motion, measures, *whole);
    const bool needs_it = motion.frame_count() > human->frame_count;
    if (limb_angle(with_lead_in) < limb_angle(report) ||
        (needs_it && limb_angle(with_lead_in) == limb_angle(report))) {
      report = std::move(with_lead_in);
      human = &*whole;
      console.line("lead-in",
                   file + " follows the source with the frames in front: taken with them");
    }
  }
  if (human->frame_count < motion.frame_count()) {
    console.warn({{0, 0,
                   "the source has " + count_text(human->frame_count, "frame") +
                       " from its start on for the " + count_text(motion.frame_count(), "frame") +
                       " of the motion: contacts and tracking end with it"}},
                 file);
  }
  return report;
}

Result<QualityReport> evaluate_motion(const std::string& file, const Measures& measures,
                                      Console& console) {
  auto motion = read_motion(file, measures.robot, measures.reading);
  if (!motion) return failure(motion.error());
  // a rate that --fps gave is no guess
  const bool rate_known = motion->rate_known;
  motion->rate_known = rate_known || measures.reading.default_rate.has_value();
  print_motion(file, *motion, console, "--fps");
  if (rate_known && measures.reading.default_rate && !measures.human &&
      !same_rate(*measures.reading.default_rate, motion->clip.rate())) {
    console.warn(
        {{0, 0,
          "the file says " + to_text(motion->clip.rate()) +
              " fps, which counts: --fps is for files that say none, --source-fps for all"}},
        file);
  }
  // frame by frame beside the source
  Result<RobotClip> clip = std::move(motion->clip);
  if (measures.human) clip = resample_robot(*clip, measures.rate);
  if (!clip) return failure(clip.error());
  const auto start = std::chrono::steady_clock::now();
  QualityReport report = measure_motion(*clip, measures, file, console);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  report.file = file == "-" ? "-" : fs::path(file).filename().string();
  report.source = measures.source;
  report.mapping = measures.mapping;
  measures.gates.judge(report);
  console.line("measured", report.file + ": " + count_text(report.frames, "frame") + " in " +
                               number_text(time.count(), 2) + " s");
  return report;
}

Result<ExitCode> evaluate_checked(const EvaluateOptions& options, Console& console) {
  if (auto usage = check_usage(options); !usage) return failure(usage.error());
  const auto measures = load_measures(options, console);
  if (!measures) return failure(measures.error());
  std::vector<QualityReport> reports;
  for (const std::string& file : options.motions) {
    auto report = evaluate_motion(file, *measures, console);
    if (!report) return failure(report.error());
    reports.push_back(std::move(*report));
  }
  if (!options.json.empty()) {
    if (auto written = write_file(options.json, printable_json(report_json(reports))); !written) {
      return failure(written.error());
    }
  }
  if (options.json != "-") {
    if (auto written = write_file("-", printable(report_text(reports))); !written) {
      return failure(written.error());
    }
  }
  for (const QualityReport& report : reports) print_verdict(report, console, report.file);
  // a motion that misses a gate is a result and no error, and the exit code tells it
  const bool passed = std::ranges::all_of(reports, &QualityReport::passed);
  return passed ? kDone : kRunFailed;
}

}  // namespace

ExitCode evaluate(const EvaluateOptions& options, Console& console) {
  const auto code = evaluate_checked(options, console);
  return code ? *code : console.fail(code.error());
}

}  // namespace retarget::cli
