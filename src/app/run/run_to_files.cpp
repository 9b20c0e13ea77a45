#include "retarget/run.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>

#include "app/plan/hand_choice.h"
#include "app/plan/motion_target.h"
#include "app/plan/scale_time.h"
#include "app/run/sidecar.h"
#include "base/faults.h"
#include "base/try.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/file.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/measure.h"
#include "retarget/plan.h"
#include "retarget/scene.h"
#include "retarget/text.h"

namespace retarget {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A motion at one of the rates of its formats, with its report.
struct SolvedMotion {
  Motion motion;
  std::optional<QualityReport> quality;
};

// Whether a file of the run contains the report.
bool writes_report(const RunRequest& request) {
  return request.sidecar || !request.report.empty() ||
         std::ranges::any_of(request.drawings, &RunDrawing::needs_report);
}

// Solves a motion. The first motion is written while it is solved.
Result<Motion> solve_observed(Plan plan, const RunRequest& request, MotionOutputs* outputs,
                              Observer& observer) {
  SolveControl control;
  control.threads = request.threads;
  control.fit_costs = request.verbose || writes_report(request);
  control.keep_going = [&](const Progress& progress) {
    observer.progress(progress);
    return !observer.is_stopped();
  };
  if (outputs != nullptr) {
    control.frame_solved = [=](int, std::span<const double> qpos) { outputs->add(qpos); };
  }
  auto motion = solve(std::move(plan), control);
  observer.end_progress();
  if (!motion) return motion;
  if (motion->fit && outputs != nullptr) {
    observer.lines(fit_lines(*motion->fit, !motion->clip.robot().fixed_base(), request.verbose));
  }
  const int frames = motion->clip.frame_count();
  observer.line("solved", count_text(frames, "frame") + " at " + to_text(motion->clip.rate()) +
                              " fps, " +
                              number_text(static_cast<double>(motion->ik_steps) / frames, 2) +
                              " IK steps per frame");
  return motion;
}

// Finds where the motion has to be slower, if the options ask for it, once for all rates.
Result<Plan> scale_observed(Plan plan, const RunRequest& request, Observer& observer) {
  const bool is_known = plan.time_scale.has_value();
  SolveControl control;
  control.threads = request.threads;
  control.keep_going = [&](const Progress& progress) {
    observer.progress(progress);
    return !observer.is_stopped();
  };
  auto scaled = decide_time_scale(std::move(plan), control);
  observer.end_progress();
  if (scaled && scaled->time_scale && !is_known) {
    observer.lines(time_scale_lines(*scaled->time_scale));
  }
  return scaled;
}

// Adds the failures of a motion at another rate to the first motion, whose verdict is the run's.
void add_failures_of(const Motion& other, Motion& first) {
  for (const SolverFailure& failure : other.solver_failures) {
    first.solver_failures.push_back(failure);
    first.solver_failures.back().solver += " at " + to_text(other.clip.rate()) + " fps";
  }
}

// The formats of the files that are made from the motion at one of the rates.
std::vector<MotionFormat> formats_at(std::size_t rate, std::span<const FrameRate> rates,
                                     std::span<const OutputItem> items,
                                     const SaveOptions& options) {
  std::vector<MotionFormat> formats;
  for (const OutputItem& item : items) {
    if (motion_of_format(item.format, options, rates) == rate) formats.push_back(item.format);
  }
  return formats;
}

// Solves the motion at the plan's own rate, then at the rates of other formats.
Result<std::vector<SolvedMotion>> solve_all(Plan plan, const Options& options,
                                            const RunRequest& request, MotionOutputs& outputs,
                                            Observer& observer) {
  const auto rates = solved_rates(options.save, options.solve.method, plan.rate);
  std::vector<SolvedMotion> solved;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const bool is_last = i + 1 == rates.size();
    Plan one = is_last ? std::exchange(plan, {}) : plan;
    one.rate = rates[i];
    one.options.save.formats = formats_at(i, rates, outputs.items(), options.save);
    TRY_ASSIGN(Motion motion,
               solve_observed(std::move(one), request, i == 0 ? &outputs : nullptr, observer));
    if (observer.is_stopped()) return interrupted_failure();
    solved.push_back({std::move(motion), std::nullopt});
    if (i == 0) continue;
    add_failures_of(solved.back().motion, solved.front().motion);
    solved.back().motion.start = StartNormalizer(solved.front().motion.clip);
  }
  return solved;
}

// Writes the report to a temporary file; it is committed with the motion's files.
Result<OutputFile> write_report(const std::string& path, const QualityReport& report,
                                Observer& observer) {
  TRY_ASSIGN(OutputFile file, OutputFile::create(path));
  TRY(file.write(report_json({&report, 1})));
  const auto missed =
      std::ranges::count_if(report.gates, [](const GateResult& gate) { return !gate.passed; });
  observer.line("report", path + ": " + count_text(missed, "gate") + " of " +
                              std::to_string(report.gates.size()) + " missed");
  return file;
}

// Writes a page or a picture to a temporary file, likewise.
Result<OutputFile> write_drawing(const RunDrawing& drawing, const Motion& motion,
                                 const QualityReport* report, Observer& observer) {
  TRY_ASSIGN(const DrawnFile drawn, drawing.draw(motion, report, observer));
  TRY_ASSIGN(OutputFile file, OutputFile::create(drawing.path));
  TRY(file.write(drawn.bytes));
  observer.line(drawn.line.label, drawing.path + ": " + drawn.line.text);
  return file;
}

Result<std::optional<QualityReport>> measure(const Motion& motion, const Run& run,
                                             const RunRequest& request, const Observer& observer) {
  // A verdict for the summary alone must not make the run fail. After a solver failure the motion
  // is always measured, so that the summary shows its defects.
  const bool asked = request.measure || request.dynamics || writes_report(request) ||
                     request.gates.has_value() || !motion.solver_failures.empty();
  if (!asked && !observer.is_read()) return std::optional<QualityReport>();
  auto report =
      evaluate(motion, request.dynamics || (request.gates && request.gates->need_dynamics()));
  if (!report && !asked) return std::optional<QualityReport>();
  if (!report) {
    if (report.error().location.file.empty()) report.error().location.file = run.output;
    return failure(std::move(report).error());
  }
  if (request.gates) request.gates->judge(*report);
  report->file = run.output == "-" ? "-" : std::filesystem::path(run.output).filename().string();
  return std::optional<QualityReport>(std::move(*report));
}

std::vector<OutputMotion> output_motions(const std::vector<SolvedMotion>& solved) {
  std::vector<OutputMotion> motions;
  for (const auto& [motion, quality] : solved) {
    motions.push_back({&motion.clip, human_in_world(*motion.source, motion.plan.human.calibration),
                       contacts_of(motion)});
    motions.back().limits = &motion.plan.limits;
    if (!motion.scene) continue;
    motions.back().scene = motion.scene->clip;
    motions.back().labels = contact_labels(motion);
  }
  return motions;
}

// Formats the sidecar of each file from the motion of which it was made.
Result<SidecarText> sidecars_of(const Run& run, const RunRequest& request,
                                const std::vector<SolvedMotion>& solved) {
  const Plan& plan = solved.front().motion.plan;
  TRY_ASSIGN(auto read, files_read(run, plan.robot, plan.config.file));
  std::vector<FrameRate> rates;
  for (const SolvedMotion& each : solved) rates.push_back(each.motion.clip.rate());
  return [&run, &solved, rates = std::move(rates), mirrored = request.mirror,
          read = std::move(read)](const WrittenFile& file) -> Result<std::string> {
    const auto& [motion, quality] =
        solved[motion_of_format(file.item.format, run.options.save, rates)];
    return sidecar_text(run, motion, file, *quality, read, mirrored);
  };
}

// The file that stands for the run in lists: the first one at the rate of its motion; without one,
// the first.
const WrittenFile& counted_file(const std::vector<WrittenFile>& files, const FrameRate& rate) {
  const auto found = std::ranges::find_if(
      files, [&](const WrittenFile& file) { return same_rate(file.rate, rate); });
  return found == files.end() ? files.front() : *found;
}

Result<RunOutcome> write_results(const Run& run, const RunRequest& request,
                                 std::vector<SolvedMotion>& solved, MotionOutputs& outputs,
                                 Observer& observer) {
  const Motion& motion = solved.front().motion;
  RunOutcome outcome;
  outcome.config = motion.plan.config.file;
  TRY_ASSIGN(outcome.quality, measure(motion, run, request, observer));
  const QualityReport* const quality = outcome.quality ? &*outcome.quality : nullptr;
  if (observer.is_read()) observer.lines(limit_lines(motion, quality));
  solved.front().quality = outcome.quality;
  const std::vector<OutputMotion> motions = output_motions(solved);
  SidecarText sidecar;
  if (request.sidecar) {
    for (std::size_t i = 1; i < solved.size(); ++i) {
      TRY_ASSIGN(solved[i].quality, measure(solved[i].motion, run, request, observer));
    }
    TRY_ASSIGN(sidecar, sidecars_of(run, request, solved));
  }
  std::optional<OutputFile> report;
  if (!request.report.empty()) {
    TRY_ASSIGN(report, write_report(request.report, *outcome.quality, observer));
    outcome.others.push_back(request.report);
  }
  std::vector<OutputFile> drawings;
  for (const RunDrawing& drawing : request.drawings) {
    TRY_ASSIGN(OutputFile file, write_drawing(drawing, motion, quality, observer));
    drawings.push_back(std::move(file));
    outcome.others.push_back(drawing.path);
  }
  TRY_ASSIGN(outcome.motions,
             outputs.finish(motions, sidecar, request.partial ? &outcome.left_out : nullptr));
  const WrittenFile& counted = counted_file(outcome.motions, motion.clip.rate());
  outcome.frames = counted.frames;
  outcome.fps = counted.rate.fps();
  for (const WrittenFile& file : outcome.motions) {
    if (request.sidecar) outcome.others.push_back(file.item.path + ".json");
  }
  observer.lines(outputs.lines());
  TRY_ASSIGN(const std::string reference, reference_path(run.output, run.options.save));
  for (const std::string& file :
       {run.options.save.contacts, run.options.save.scene_out, reference}) {
    if (!file.empty()) outcome.others.push_back(file);
  }
  if (report) TRY(report->commit());
  for (OutputFile& drawing : drawings) TRY(drawing.commit());
  return outcome;
}

}  // namespace

Result<LoadedRobot> load_robot(const RobotChoice& choice, const DataFolder& data_folder,
                               Observer& observer, Soles soles) {
  TRY_ASSIGN(LoadedRobot robot, load_robot(choice, data_folder, soles));
  observer.lines(robot.notes);
  observer.warn(robot.warnings, robot.model);
  return robot;
}

namespace {

// Replaces the clip, its calibration and its surroundings by their mirror images.
// @param first  the first frame as read, which cleaning and travel may have moved.
Result<void> mirror_plan(const Clip& first, Plan& plan) {
  const Calibration& calibration = plan.human.calibration;
  const MirrorPlane plane = mirror_plane(first, calibration);
  TRY_ASSIGN(MirroredHuman image,
             located(mirror_human(*plan.clip, calibration, plane), plan.clip->name()));
  image.clip.set_origin(plan.clip->origin());
  if (plan.scene) {
    Scene scene = *plan.scene;
    mirror_scene(plane, scene, plan.object_tracks);
    plan.scene = std::make_shared<const Scene>(std::move(scene));
  }
  for (ContactEdit& edit : plan.contact_edits) edit.part = part_of_other_side(edit.part);
  plan.clip = std::make_shared<const Clip>(std::move(image.clip));
  plan.human.calibration = std::move(image.calibration);
  note_hands(*plan.clip, plan);
  return {};
}

}  // namespace

Result<Plan> read_and_plan(const Run& run, const RunRequest& request, const RobotSetup& robot,
                           Observer& observer) {
  const DataFolder data_folder{robot.loaded.data_folder};
  TRY_ASSIGN(const SourceOptions source,
             recorded_source(run.motion, run.options.source, data_folder));
  TRY_ASSIGN(Clip clip, load_clip(run.motion, source, data_folder));
  observer.warn(clip.origin().warnings, clip.name());
  const SummaryLine read = clip_line(clip);
  observer.line(read.label, read.text);
  return plan_clip(std::move(clip), run, request, robot, observer);
}

Result<Plan> plan_clip(Clip clip, const Run& run, const RunRequest& request,
                       const RobotSetup& robot, Observer& observer) {
  const Clip first = cut(clip, 0, std::min(clip.frame_count(), 1));
  TRY_ASSIGN(Plan plan, make_plan(std::move(clip), robot, run.options));
  observer.lines(plan.human.lines());
  observer.warn(plan.doubts(), plan.clip->name());
  observer.lines(plan.clip_notes);
  if (request.mirror) {
    TRY(mirror_plan(first, plan));
    observer.line("mirrored", "left for right");
  }
  TRY(save_bone_map(request.write_map, plan.human.map, plan.clip->skeleton()));
  return plan;
}

Result<RunOutcome> run_to_files(const Run& run, const RunRequest& request, const RobotSetup& robot,
                                Observer& observer) {
  const auto start = std::chrono::steady_clock::now();
  TRY_ASSIGN(Plan plan, read_and_plan(run, request, robot, observer));
  observer.planned(plan);
  observer.lines(plan.robot_lines());
  // An interrupt now stops the run between two frames and leaves no files behind.
  const auto interrupts = observer.hold_interrupts();
  TRY_ASSIGN(plan, scale_observed(std::move(plan), request, observer));
  const auto purpose =
      request.hashes_only ? MotionOutputs::Purpose::kHash : MotionOutputs::Purpose::kRun;
  TRY_ASSIGN(const auto outputs, MotionOutputs::open(run.output, run.options.save, plan.robot.robot,
                                                     plan.rate, purpose));
  TRY_ASSIGN(auto solved, solve_all(std::move(plan), run.options, request, *outputs, observer));
  auto outcome = write_results(run, request, solved, *outputs, observer);
  if (!outcome || request.hashes_only) return outcome;
  warn_of_losses(solved.front().motion.clip, outcome->motions, run.options.save, observer);
  observer.warn(solver_warnings(solved.front().motion.solver_failures), run.motion);
  observer.line("wrote", outputs_text(outcome->motions, &solved.front().motion.clip) + " in " +
                             number_text(seconds_since(start), 2) + " s");
  if (outcome->quality) observer.lines(verdict_lines(*outcome->quality));
  return outcome;
}

}  // namespace retarget
