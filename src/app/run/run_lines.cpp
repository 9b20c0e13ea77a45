#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "app/plan/motion_target.h"
#include "base/option_name.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/os.h"
#include "retarget/plan.h"
#include "retarget/robot.h"
#include "retarget/robots.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "robot/model/limits.h"
#include "solve/fit/fit_report.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxLines = 5;

std::string wider_text(const LimitedJoint& found, const Robot& robot, const LimitSet& limits) {
  if (!found.wider) return "limit set " + found.wider_set + " has no limit there";
  const auto joint = std::ranges::find(robot.joints(), found.joint, &RobotJoint::name);
  const bool slides = joint != robot.joints().end() && joint->type != RobotJoint::Type::kHinge;
  return "limit set " + limits.name + " is " + number_text(*found.wider, 2) +
         (slides ? " m" : " rad") + " tighter than " + found.wider_set;
}

// Example: `knee_joint at its upper limit in 12 % of frames; task LeftLeg rotation, 3 degrees short`
std::string limited_text(const LimitedJoint& found, const Robot& robot, const LimitSet& limits) {
  std::string text = found.joint + " at its " + (found.at_upper ? "upper" : "lower") +
                     " limit in " + number_text(found.frames_pct, 0) + " % of frames; task " +
                     found.task + (found.rotation ? " rotation, " : " position, ") +
                     number_text(found.shortfall, 1) +
                     (found.rotation ? " degrees short" : " cm short");
  if (!found.wider_set.empty()) text += "; " + wider_text(found, robot, limits);
  return text;
}

// Minimum distance of the motion to its limits.
std::vector<SummaryLine> distance_lines(const RobotClip& clip, const LimitSet& limits) {
  const auto nearest = nearest_limit(clip, limits);
  if (!nearest) return {};
  // A distance that rounds to zero in the file counts as being at the limit.
  constexpr double kEpsilon = 5e-7;
  const std::string side = nearest->at_upper ? "upper limit" : "lower limit";
  const std::string distance = number_text(std::abs(nearest->distance), 6);
  const std::string where = std::abs(nearest->distance) < kEpsilon ? " is at its " + side
                            : nearest->distance > 0.0
                                ? " is nearest to a limit, " + distance + " from its " + side
                                : " goes " + distance + " beyond its " + side;
  return {{"limits", limits.name + ": " + nearest->joint + where + " in frame " +
                         std::to_string(nearest->frame) + "; joints at a limit in " +
                         number_text(100.0 * nearest->frames_at_limit, 1) + " % of frames"}};
}

// Example: `targets lowered by 4 cm`
std::string floor_text(const FitReport& report) {
  const std::string size = number_text(100.0 * std::abs(report.floor_height), 1);
  if (size == "0") return "targets neither raised nor lowered";
  return std::string("targets ") + (report.floor_height > 0.0 ? "lowered" : "raised") + " by " +
         size + " cm";
}

constexpr int kDecimals = 3, kMaxDecimals = 9;

// At least two significant digits.
std::string bound_text(double bound) {
  int decimals = kDecimals;
  for (double size = std::abs(bound) * 1000.0; size > 0.0 && size < 10.0 && decimals < kMaxDecimals;
       size *= 10.0) {
    ++decimals;
  }
  return number_text(bound, decimals);
}

// Strips the suffix that many models give their joints.
std::string short_name(const std::string& joint) {
  constexpr std::string_view kEnding = "_joint";
  const bool has_it = joint.size() > kEnding.size() && joint.ends_with(kEnding);
  return has_it ? joint.substr(0, joint.size() - kEnding.size()) : joint;
}

}  // namespace

std::string missed_text(const GateResult& gate) {
  if (!gate.value) return gate.metric + " (not measured)";
  // Negated comparison: NaN counts as below the bound.
  const bool too_little = gate.min && !(*gate.value >= *gate.min);
  const double bound = too_little ? *gate.min : *gate.max;
  // Enough digits to show that the gate was missed.
  int decimals = kDecimals;
  while (decimals < kMaxDecimals &&
         number_text(*gate.value, decimals) == number_text(bound, decimals)) {
    ++decimals;
  }
  return gate.metric + " " + number_text(*gate.value, decimals) +
         (too_little ? " (at least " : " (at most ") + bound_text(bound) + ")";
}

std::string missed_gates_text(const QualityReport& report) {
  std::string text;
  for (const GateResult& gate : report.gates) {
    if (!gate.passed) text += (text.empty() ? "" : ", ") + missed_text(gate);
  }
  return text;
}

SummaryLine clip_line(const Clip& clip) {
  return {"read", clip.name() + ": " + count_text(clip.skeleton().joint_count(), "joint") + ", " +
                      count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) +
                      " fps, " + number_text(clip.duration(), 2) + " s" +
                      (clip.origin().choices.empty() ? "" : "; " + clip.origin().choices)};
}

std::vector<SummaryLine> fit_lines(const FitReport& report, bool has_floor, bool verbose) {
  std::vector<SummaryLine> lines;
  for (const std::string& note : report.notes) lines.push_back({"fit", note});
  if (has_floor) {
    lines.push_back({"floor", floor_text(report) + (report.floor_found ? "" : " (a guess)") + ", " +
                                  count_text(report.contact_phases, "contact phase")});
  }
  for (const FitTermReport& term : report.terms) {
    if (!verbose) break;
    std::string worst;
    for (const int frame : term.worst) worst += (worst.empty() ? "" : ", ") + std::to_string(frame);
    lines.push_back({&term == &report.terms.front() ? "costs" : "",
                     term.name + " " + number_text(term.before, 3) + " -> " +
                         number_text(term.after, 3) +
                         (worst.empty() ? "" : ", worst in " + worst)});
  }
  for (const FitBoundReport& bound : report.bounded) {
    lines.push_back({"bounded", bound.joint + " in " + count_text(bound.frames, "frame") +
                                    ", most in " + std::to_string(bound.worst_frame) + " by " +
                                    number_text(bound.largest, 3)});
  }
  return lines;
}

std::vector<SummaryLine> limit_lines(const Motion& motion, const QualityReport* report) {
  const LimitSet& limits = motion.plan.limits;
  std::vector<SummaryLine> lines = distance_lines(motion.clip, limits);
  if (report == nullptr) return lines;
  std::size_t named = 0;
  for (const LimitedJoint& found : report->limited_joints) {
    // Skip joints that only rest at a limit, as fingers do; no task is affected.
    if (found.task.empty()) continue;
    if (named++ == kMaxLines) break;
    lines.push_back({"", limited_text(found, motion.clip.robot(), limits)});
  }
  return lines;
}

std::vector<Warning> solver_warnings(std::span<const SolverFailure> failures) {
  std::vector<Warning> warnings;
  for (const SolverFailure& failure : failures) {
    const int last = failure.end - 1;
    const std::string frames = failure.begin == last ? "frame " + std::to_string(last)
                                                     : "frames " + std::to_string(failure.begin) +
                                                           " to " + std::to_string(last);
    warnings.push_back(
        {0, 0,
         failure.solver + ": non-finite numbers in " + frames +
             "; these steps were rejected, and the motion may deviate from its targets"});
  }
  return warnings;
}

std::vector<SummaryLine> verdict_lines(const QualityReport& report, const std::string& file) {
  std::vector<SummaryLine> lines;
  const std::string name = file.empty() ? file : file + ": ";
  const std::string missed = missed_gates_text(report);
  long kept = 0, unmeasured = 0;
  for (const GateResult& gate : report.gates) {
    if (gate.passed) ++(gate.value ? kept : unmeasured);
  }
  if (!missed.empty()) {
    const std::string note = report.fit ? convergence_note(*report.fit) : "";
    if (!note.empty()) lines.push_back({"fit", note});
    lines.push_back({"missed", name + missed});
  }
  if (report.lost_stances) {
    lines.push_back({"stances", name +
                                    "none were found, so they are not measured: check the up axis "
                                    "(" OPTION("up") "), the floor and the path of the root"});
  }
  const auto all = static_cast<long>(report.gates.size());
  std::string text =
      name +
      (all == 0 ? "no gates" : std::to_string(kept) + " of " + count_text(all, "gate") + " passed");
  if (unmeasured > 0) text += ", " + std::to_string(unmeasured) + " not measured";
  // A joint without a task that pushes it only rests at its limit, as fingers do.
  const auto limited = std::ranges::find_if(
      report.limited_joints, [](const LimitedJoint& joint) { return !joint.task.empty(); });
  if (limited != report.limited_joints.end()) {
    text += "; " + short_name(limited->joint) + " at its limit in " +
            number_text(limited->frames_pct, 0) + " % of frames";
  }
  if (!report.estimated_soles.empty()) text += "; soles estimated";
  lines.push_back({"verdict", text});
  return lines;
}

namespace fs = std::filesystem;

namespace {

// Identity of a regular file. Pipes and devices are never overwritten.
std::optional<os::FileId> identity_of(const std::string& path, int stream) {
  const auto info = path == "-" ? os::status_of(stream) : os::status_of(path);
  if (!info || info->kind != os::EntryKind::kRegular) return std::nullopt;
  return info->id;
}

std::string whole_path(const std::string& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? fs::path(path).lexically_normal().string() : whole.string();
}

// Adds model, profile and configurations of a robot that has a folder.
void append_robot(std::vector<std::string>& files, const std::string& name,
                  const fs::path& data_folder) {
  if (name.empty()) return;
  const auto robot = find_robot(name, robot_folders(data_folder));
  if (!robot) return;
  files.insert(files.end(), {robot->model.string(), robot->profile.string()});
  const fs::path place = robot->model.parent_path();
  const auto configs =
      find_configs({}, Method::kGmr, place, data_folder, fs::absolute(place).filename().string());
  if (configs) files.insert(files.end(), {configs->of_lafan1, configs->of_others});
}

}  // namespace

void KnownFiles::add(const std::string& path, int stream) {
  if (path.empty()) return;
  if (const auto identity = identity_of(path, stream)) by_identity_.emplace(*identity, path);
  if (path != "-") by_path_.emplace(whole_path(path), path);
}

const std::string* KnownFiles::find(const std::string& path, int stream) const {
  if (path.empty()) return nullptr;
  if (const auto identity = identity_of(path, stream)) {
    const auto found = by_identity_.find(*identity);
    return found == by_identity_.end() ? nullptr : &found->second;
  }
  if (path == "-") return nullptr;
  const auto found = by_path_.find(whole_path(path));
  return found == by_path_.end() ? nullptr : &found->second;
}

WrittenFiles::WrittenFiles(const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) inputs_.add(input, os::kStandardInput);
}

Result<void> WrittenFiles::check_spared(const std::string& output) const {
  const std::string* input = inputs_.find(output, os::kStandardOutput);
  if (input == nullptr) return {};
  const std::string by_name = *input == output ? "" : " \"" + output + "\"";
  return usage_failure("the output" + by_name + " would overwrite the input \"" + *input + "\"",
                       "give another name");
}

Result<void> WrittenFiles::take(const std::string& output) {
  if (output.empty()) return {};
  TRY(check_spared(output));
  if (output == "-") return {};
  if (outputs_.find(output, os::kStandardOutput) != nullptr) {
    return usage_failure("two outputs name the same file \"" + output + "\"");
  }
  outputs_.add(output, os::kStandardOutput);
  return check_output_folder(output);
}

Result<void> check_written(const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs) {
  WrittenFiles written(inputs);
  for (const std::string& output : outputs) TRY(written.take(output));
  return {};
}

std::vector<std::string> files_of(const Run& run, const std::string& data_folder) {
  std::vector<std::string> files = {run.motion};
  for (const std::string& track : run.options.solve.object_tracks) {
    files.push_back(object_track_file(track));
  }
  Run copy = run;
  for (const Option& row : run_table(copy)) {
    if (row.info.file != OptionFile::kNone) files.push_back(to_text(row.get()));
  }
  if (data_folder.empty()) return files;
  append_robot(files, run.robot.name, data_folder);
  append_robot(files, run.options.source.from_robot, data_folder);
  for (const char* name : {"skeletons", "quality"}) {
    for (const fs::path& file : files_in_folder(fs::path(data_folder) / "configs" / name)) {
      files.push_back(file.string());
    }
  }
  return files;
}

Result<void> check_outputs(const Run& run, bool sidecar, const std::vector<std::string>& inputs,
                           const std::vector<std::string>& others) {
  WrittenFiles written(inputs);
  // First check for an input given as output by mistake, before its extension is interpreted.
  if (run.output != "-" && run.options.save.formats.size() <= 1) {
    TRY(written.check_spared(run.output));
  }
  TRY_ASSIGN(const auto items, plan_outputs(run.output, run.options.save));
  for (const std::string& other : others) TRY(written.take(other));
  if (run.options.save.contacts == "-") {
    return usage_failure(OPTION("contacts") " needs a file", "name one that ends in .csv");
  }
  TRY(written.take(run.options.save.contacts));
  TRY(check_output_ending(run.options.save.contacts, {".csv"}, "a table of contacts in CSV"));
  TRY(written.take(run.options.save.scene_out));
  TRY_ASSIGN(const std::string reference, reference_path(run.output, run.options.save));
  TRY(written.take(reference));
  for (const OutputItem& item : items) {
    TRY(written.take(item.path));
    if (!sidecar) continue;
    if (item.path == "-") {
      return usage_failure(OPTION("sidecar") " needs an output file",
                           "name a file with " OPTION("output"));
    }
    TRY(written.take(item.path + ".json"));
  }
  return {};
}

}  // namespace retarget
