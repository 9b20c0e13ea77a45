#include <fmt/format.h>
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/plan/clean_source.h"
#include "app/plan/hand_choice.h"
#include "app/plan/scale_time.h"
#include "app/plan/scene_fit.h"
#include "app/plan/set_up_robot.h"
#include "app/plan/surroundings.h"
#include "app/plan/vary_scene.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/robot_human.h"
#include "motion/clip.h"
#include "motion/resample.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/clip_range.h"
#include "retarget/contact_edits.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/resample.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "solve/targets/limb_lengths.h"

namespace retarget {
namespace {

// Number of lead-in frames to skip, unless the user specifies the beginning.
int frames_to_leave_out(const Clip& clip, const Options& options) {
  const PartOptions& part = options.part;
  // The published method uses every frame.
  const bool keep = part.lead_in == LeadIn::kKeep ||
                    (part.lead_in == LeadIn::kAuto && options.solve.method == Method::kGmr);
  if (keep || !part.frames.empty() || part.start_s >= 0.0) return 0;
  const int count = count_lead_in_frames(clip);
  // An end within the lead-in is intentional.
  const bool ends_there = part.end_s >= 0.0 && part.end_s * clip.rate().fps() < count;
  return ends_there ? 0 : count;
}

// Chooses how the body size scales the motion: by the options, otherwise by the clip.
ScaleRule choose_scale(const HumanInClip& human, const Robot& robot, const ResolvedConfig& config,
                       const Options& options) {
  const SolveOptions& solve = options.solve;
  if (solve.scale) return *solve.scale;
  // With a fixed base, the robot does not follow hand positions.
  if (robot.fixed_base()) return ScaleRule::kHeight;
  // The published method assumes one body size for all of LAFAN1, and so do its tables.
  const bool as_published =
      solve.method == Method::kGmr || (!solve.ik_config.empty() && solve.ik_config != "derived");
  if (as_published && human.is_lafan1()) return ScaleRule::kTable;
  const bool measurable = std::ranges::all_of(
      kMeasuredBones, [&](Bone bone) { return human.calibration.bones[bone].position_joint >= 0; });
  if (options.human.height > 0.0 || !measurable) return ScaleRule::kHeight;
  const auto limbs = robot_limbs(robot, config);
  // Some robots' arms end at the elbow; a fit measures the limbs that exist.
  const bool by_limbs = limbs && (limbs->forearms || solve.method != Method::kGmr);
  return by_limbs ? ScaleRule::kLimbs : ScaleRule::kHeight;
}

// Removes the tasks of bones that a partial body lacks.
Result<void> leave_out_missing(Plan& plan) {
  const std::vector<Bone> missing = plan.human.missing_bones();
  std::vector<std::string> names;
  names.reserve(missing.size());
  for (const Bone bone : missing) names.emplace_back(bone_name(bone));
  TRY_ASSIGN(const int dropped, leave_out_bones(plan.config, missing));
  if (dropped == 0) return {};
  plan.config_notes.push_back(
      {"partial", fmt::format("{} of the configuration omitted: the source has no {}",
                              count_text(dropped, "row"), list_names(names))});
  return {};
}

// Marks the tasks of bones whose rotations are unknown (ClipOrigin::unknown_rotations).
void mark_guessed_rotations(const Clip& clip, const Calibration& calibration,
                            ResolvedConfig& config) {
  const std::vector<std::string>& unknown = clip.origin().unknown_rotations;
  if (unknown.empty()) return;
  for (ResolvedConfig::Table& table : config.match_tables) {
    for (ConfigTask& task : table.tasks) {
      const int joint = calibration.bones[task.bone].position_joint;
      if (joint < 0) continue;
      const std::string& name = clip.skeleton().joint(joint).name;
      task.rotation_is_guess = std::ranges::find(unknown, name) != unknown.end();
    }
  }
}

}  // namespace

ResolvedConfig measured_config(const Plan& plan, const RobotSetup& robot) {
  ResolvedConfig config = robot.config_for(plan.human);
  if (plan.clip) mark_guessed_rotations(*plan.clip, plan.human.calibration, config);
  return config;
}

namespace {

Result<void> choose_frames(const Clip& clip, const Options& options, Plan& plan) {
  plan.lead_in_frames = frames_to_leave_out(clip, options);
  TRY_ASSIGN(plan.part, chosen_range(options.part, clip.rate(), clip.frame_count()));
  for (Warning& doubt : range_doubts(options.part, clip.rate(), clip.frame_count())) {
    plan.clip_doubts.push_back(std::move(doubt));
  }
  if (plan.lead_in_frames > 0) {
    plan.part.begin = std::max(plan.part.begin, plan.lead_in_frames);
    const bool one = plan.lead_in_frames == 1;
    plan.clip_notes.push_back(
        {"lead-in", fmt::format("{} at the start skipped, because the motion jumps there; " OPTION(
                                    "lead-in") " keep uses {}",
                                count_text(plan.lead_in_frames, "frame"), one ? "it" : "them")});
  }
  leave_out_lost_end(clip, options, plan);
  const auto& fps = options.time.fps;
  const FrameRate rate = fps ? frame_rate_from_fps(*fps) : clip.rate();
  plan.rate = solved_rates(options.save, options.solve.method, rate).front();
  return {};
}

// Loads the changes to the contacts, and notes them.
Result<void> load_edits(const Clip& clip, Plan& plan) {
  const std::string& file = plan.options.solve.contact_edits;
  if (file.empty()) return {};
  TRY_ASSIGN(plan.contact_edits, load_contact_edits(file));
  const std::int64_t frames =
      resampled_frame_count(plan.part.end - plan.part.begin, clip.rate(), plan.rate);
  TRY(check_contact_edits(plan.contact_edits, static_cast<double>(frames) / plan.rate.fps(), file));
  plan.clip_notes.push_back(
      {"contacts", fmt::format("{} of {}", count_text(plan.contact_edits.size(), "edit"), file)});
  return {};
}

// Size of the clip's file. A clip that was made in memory has none, and counts itself.
std::uint64_t source_bytes(const Clip& clip) {
  if (clip.origin().bytes > 0) return clip.origin().bytes;
  return frame_bytes(clip.skeleton()) * static_cast<std::uint64_t>(clip.frame_count());
}

}  // namespace

std::int64_t Plan::frame_count() const {
  const FrameRate& source = clip ? clip->rate() : rate;
  const std::int64_t frames = resampled_frame_count(part.end - part.begin, source, rate);
  const bool stretched = time_scale && !time_scale->pace.empty();
  return stretched ? warped_frame_count(*time_scale, rate, frames) : frames;
}

Result<Plan> make_plan(Clip clip, const RobotSetup& robot, const Options& options) {
  TRY(check_solving_options(options));
  if (clip.frame_count() == 0) {
    return input_failure(clip.name(), "the clip has no frames",
                         "retarget inspect shows its skeleton");
  }
  const std::uint64_t bytes = source_bytes(clip);
  Plan plan;
  plan.robot = robot.loaded;
  plan.options = options;
  plan.limits = robot.limits;
  plan.fit = is_of_robot(clip) ? robot.fit_of_robots : robot.fit;
  const SourceNotes source_notes = clean_source_frames(clip, options);
  // The whole clip serves to find the rest pose, unit and axes, even if only a part is retargeted.
  TRY_ASSIGN(plan.human, find_human(clip, options.human, robot.loaded.data_folder));
  const ResolvedConfig& config = robot.config_for(plan.human);
  plan.config = config;
  plan.is_config_of_others = &config != &robot.config;
  plan.clip_doubts = robot.doubts;
  if (is_config_by_name(config.file, plan.robot, options.solve)) {
    plan.clip_doubts.push_back(
        {0, 0,
         fmt::format("the robot's configuration, {}, was chosen by the name of its model; " OPTION(
                         "ik-config") " FILE selects another one",
                     config.file)});
  }
  TRY(choose_frames(clip, options, plan));
  TRY(load_surroundings(clip, plan));
  // vary_scene() continues these lines.
  std::vector<SummaryLine> scene_lines = std::exchange(plan.config_notes, {});
  TRY(clean_source(clip, source_notes, plan));
  doubt_jumps(clip, plan);
  doubt_level(clip, plan);
  if (plan.human.map.partial) TRY(leave_out_missing(plan));
  mark_guessed_rotations(clip, plan.human.calibration, plan.config);
  note_hands(clip, plan);
  for (SummaryLine& line : follow_lines(plan.robot, plan.limits)) {
    plan.config_notes.push_back(std::move(line));
  }
  plan.scale = choose_scale(plan.human, *robot.loaded.robot, plan.config, options);
  TRY(load_edits(clip, plan));
  std::ranges::move(scene_lines, std::back_inserter(plan.config_notes));
  TRY(check_scene_fit(clip, plan));
  TRY(scale_source_travel(clip, plan));
  TRY(vary_scene(clip, plan));
  plan.clip = std::make_shared<const Clip>(std::move(clip));
  TRY(set_time_scale(plan));
  TRY(check_need({plan.frame_count(), plan.rate, bytes, plan.clip->name()},
                 options.source.memory_gb, options.save));
  return plan;
}

Result<Plan> make_plan(Clip clip, const LoadedRobot& robot, const Options& options) {
  TRY_ASSIGN(const RobotSetup setup, set_up_robot(robot, options));
  return make_plan(std::move(clip), setup, options);
}

std::vector<SummaryLine> HumanInClip::lines() const {
  std::vector<SummaryLine> lines = {{"taken as", calibration.description}};
  for (const std::string& note : map.notes) lines.push_back({"", note});
  return lines;
}

std::vector<Warning> Plan::doubts() const {
  std::vector<Warning> all = human.doubts();
  all.insert(all.end(), clip_doubts.begin(), clip_doubts.end());
  return all;
}

std::vector<SummaryLine> Plan::robot_lines() const {
  std::vector<SummaryLine> lines = config_notes;
  lines.push_back({"robot", fmt::format("{}, {}, limits {}, configuration {}", robot.robot->name(),
                                        count_text(robot.robot->output_joints().size(), "joint"),
                                        limits.name, config.file)});
  if (is_config_of_others) {
    lines.push_back({"", "derived configuration, because the source is not LAFAN1; " OPTION(
                             "ik-config") " published selects the published one"});
  }
  return lines;
}

std::string summary_text(std::span<const SummaryLine> lines) {
  constexpr std::size_t kLabelWidth = 9;
  std::string text;
  for (const auto& [label, words] : lines) {
    // At least one space separates a long label from the text.
    text += fmt::format("{:<{}} {}\n", label, kLabelWidth - 1, spell_options(words));
  }
  return text;
}

std::string Plan::summary() const {
  std::string text =
      summary_text(human.lines()) + summary_text(clip_notes) + summary_text(robot_lines());
  for (const Warning& doubt : doubts()) {
    text += describe(doubt, clip ? clip->name() : "") + "\n";
  }
  return text;
}

}  // namespace retarget
