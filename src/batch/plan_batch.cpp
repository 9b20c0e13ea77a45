#include "batch/plan_batch.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "batch/certify_clip.h"
#include "batch/data_set.h"
#include "batch/find_inputs.h"
#include "batch/input_variants.h"
#include "batch/output_owners.h"
#include "batch/output_tree.h"
#include "batch/pack_motions.h"
#include "retarget/check_options.h"
#include "retarget/load.h"
#include "retarget/measure.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Returns `.` for a bare file name.
std::string folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder.generic_string();
}

// Loads each robot once. A list keeps their addresses stable, because tasks point to them.
Result<std::list<BatchRobot>> load_batch_robots(const BatchRequest& request, Observer& observer) {
  std::vector<std::string> names = request.robots;
  if (names.empty()) names.emplace_back();
  std::list<BatchRobot> robots;
  for (const std::string& name : names) {
    BatchRobot robot;
    robot.run = request.run;
    // Each clip replaces `*` by its own name.
    if (request.contacts) robot.run.options.save.contacts = contacts_output("*");
    robot.run.robot.name = name;
    robot.request = request.of_clip;
    robot.request.measure = request.quality;
    if (!request.gates.empty()) {
      RETARGET_TRY_ASSIGN(robot.request.gates, changed_gates(request.gates, request.data_folder));
      robot.request.dynamics |= robot.request.gates->need_dynamics();
    }
    RETARGET_TRY_ASSIGN(LoadedRobot loaded,
                        load_robot(robot.run.robot, {request.data_folder}, observer));
    if (!name.empty()) robot.run.robot.name = loaded.name;
    RETARGET_TRY_ASSIGN(robot.setup, set_up_robot(std::move(loaded), robot.run.options));
    robot.name = fs::path(robot.setup.loaded.robot->name()).filename().generic_string();
    if (names.size() > 1) robot.folder = robot.name + "/";
    RETARGET_TRY_ASSIGN(robot.fingerprint, run_fingerprint(robot.run, robot.request, robot.setup));
    if (request.certify) {
      RETARGET_TRY_ASSIGN(robot.fingerprint, certified(robot.fingerprint));
    }
    if (std::ranges::find(robots, robot.name, &BatchRobot::name) != robots.end()) {
      return usage_failure("the robot \"" + robot.name + "\" is given twice");
    }
    observer.line("robot", robot.name + ", limits " + robot.setup.limits.name + ", configuration " +
                               robot.setup.config.file);
    if (const auto& of_others = robot.setup.config_of_others) {
      observer.line("", "for sources other than LAFAN1: " + of_others->file);
    }
    robots.push_back(std::move(robot));
  }
  return robots;
}

// Replaces files by the parts that the clip table defines.
Result<std::vector<BatchInput>> take_parts(const std::vector<BatchInput>& inputs,
                                           const std::vector<ClipRow>& rows,
                                           const BatchRequest& request, Observer& observer) {
  RETARGET_TRY_ASSIGN(std::vector<BatchInput> parts, parts_of(inputs, rows, request.clips));
  std::set<std::string> used;
  for (const BatchInput& part : parts) used.insert(part.variant.source);
  std::string text = count_text(parts.size(), "part") + " of " + count_text(used.size(), "file");
  const std::size_t unused = inputs.size() - used.size();
  if (unused > 0) text += "; " + count_text(unused, "file") + " not in the table";
  observer.line("clips", text);
  return parts;
}

// Finds all clips: files or parts of them, mirror images and variations.
Result<std::vector<BatchInput>> find_clips(const BatchRequest& request, Observer& observer) {
  InputSearch search{request.inputs,      request.lists,
                     request.relative_to, request.exclude,
                     request.output,      !request.run.options.source.from_robot.empty()};
  std::vector<ClipRow> rows;
  if (!request.clips.empty()) {
    RETARGET_TRY_ASSIGN(rows, read_clip_table(request.clips));
    if (search.names.empty() && search.lists.empty()) {
      RETARGET_TRY_ASSIGN(search.names, files_of_rows(rows, request.clips));
      if (search.base.empty()) search.base = folder_of(request.clips);
    }
  }
  RETARGET_TRY_ASSIGN(auto found, find_inputs(search));
  for (const std::string& note : found.notes) observer.line("inputs", note);
  for (const std::string& pattern : found.unused_patterns) {
    observer.warn(
        {{0, 0, RETARGET_OPTION("exclude") " \"" + pattern + "\" matches no motion file"}}, {});
  }
  RETARGET_TRY(check_distinct_outputs(found.inputs));
  std::vector<BatchInput> inputs = std::move(found.inputs);
  if (!rows.empty()) {
    RETARGET_TRY_ASSIGN(inputs, take_parts(inputs, rows, request, observer));
  }
  if (request.mirror) inputs = with_mirror_images(std::move(inputs));
  if (request.variants > 0) {
    RETARGET_TRY_ASSIGN(inputs, with_variations(std::move(inputs), request.variants, request.seed,
                                                request.run.options.solve));
  }
  RETARGET_TRY(check_distinct_outputs(inputs));
  return inputs;
}

Result<void> plan_inputs(const BatchRequest& request, const Shard& shard, BatchPlan& plan,
                         Observer& observer) {
  RETARGET_TRY_ASSIGN(std::vector<BatchInput> inputs, find_clips(request, observer));
  RETARGET_TRY(check_outputs_of(inputs, request));
  RETARGET_TRY(check_outputs_spared(inputs, request, folder_text(request.output), plan.robots));
  const std::size_t all = inputs.size();
  for (const BatchInput& input : inputs) plan.selection.clips.insert(input.relative);
  plan.inputs = take_shard(std::move(inputs), shard);
  observer.line("inputs",
                count_text(plan.inputs.size(), "clip") +
                    (shard.count > 1 ? " of " + std::to_string(all) + ", part " + request.shard
                                     : std::string()));
  return {};
}

// The entry of a clip that is skipped as a duplicate.
ManifestEntry entry_of_repeated(const BatchInput& input, const BatchRobot& robot,
                                const RepeatedClip& repeated, const FinishedClips& finished) {
  ManifestEntry entry;
  entry.relative = input.relative;
  entry.robot = robot.name;
  entry.options_hash = robot.fingerprint.hash;
  // Enough for the next run to recognise the file; its content is not read.
  entry.input = {input.path, input.bytes, input.modified_ns, {}};
  entry.variant = input.variant;
  entry.signature = input.signature;
  entry.repeated = repeated;
  entry.finished = finished_now(finished, entry);
  return entry;
}

}  // namespace

Result<void> check_batch(const BatchRequest& request) {
  const SolveOptions& solve = request.run.options.solve;
  if (request.inputs.empty() && request.lists.empty() && request.clips.empty()) {
    return usage_failure("no motion files are given",
                         "give files, folders, patterns or lists of clips, such as clips/");
  }
  if (request.robots.size() > 1 && !solve.ik_config.empty() && !is_config_kind(solve.ik_config)) {
    return usage_failure(
        RETARGET_OPTION("ik-config") " applies to one robot, but several are given",
        "run a batch for each robot");
  }
  if (request.resume && request.redo) {
    return usage_failure(
        RETARGET_OPTION("resume") " and " RETARGET_OPTION("redo") " cannot be combined",
        "give only one of them");
  }
  if (request.seed != 0 && request.variants == 0) {
    return usage_failure(RETARGET_OPTION("seed") " requires " RETARGET_OPTION("variants"),
                         "it is the seed of their changes");
  }
  if (std::ranges::find(request.inputs, "-") != request.inputs.end()) {
    return usage_failure("a batch cannot read motions from standard input",
                         RETARGET_OPTION("list") " - reads file names from it");
  }
  const PartOptions& part = request.run.options.part;
  if (!request.clips.empty() &&
      (part.start_s >= 0.0 || part.end_s >= 0.0 || !part.frames.empty())) {
    return usage_failure(
        RETARGET_OPTION("clips") " and " RETARGET_OPTION("start") ", " RETARGET_OPTION(
            "end") " or " RETARGET_OPTION("frames") " both choose parts of the clips",
        "give only one of them");
  }
  const SaveOptions& save = request.run.options.save;
  RETARGET_TRY(plan_outputs(batch_output(save, "clip.bvh"), save));
  Options options = request.run.options;
  if (request.contacts) options.save.contacts = contacts_output("*");
  RETARGET_TRY(check_options(options));
  if (request.motion_list) RETARGET_TRY(check_motion_list(save));
  if (request.certify) RETARGET_TRY(check_certify(save, request.quality));
  if (!request.pack.empty()) {
    RETARGET_TRY(check_pack_name(request.pack));
    RETARGET_TRY(check_pack_format(save));
  }
  RobotChoice robot = request.run.robot;
  if (!request.robots.empty()) robot.name = request.robots.front();
  RETARGET_TRY(check_robot_choice(robot));
  return check_config_choice(robot, solve);
}

std::string folder_text(const std::string& folder) {
  return os::without_last_separators(os::with_slashes(folder));
}

Result<BatchPlan> plan_batch(const BatchRequest& request, const Shard& shard, Observer& observer) {
  BatchPlan plan;
  RETARGET_TRY_ASSIGN(plan.robots, load_batch_robots(request, observer));
  for (const BatchRobot& robot : plan.robots) plan.selection.robots.insert(robot.name);
  RETARGET_TRY(plan_inputs(request, shard, plan, observer));
  return plan;
}

void plan_tasks(const FinishedClips& finished, const std::map<std::string, RepeatedClip>& repeated,
                BatchPlan& plan) {
  for (const BatchInput& input : plan.inputs) {
    for (const BatchRobot& robot : plan.robots) {
      const auto found = finished.find(input.relative, robot.name, robot.fingerprint.hash,
                                       input.path, input.variant);
      if (found.state == RecordState::kSame) {
        ++plan.unchanged;
        continue;
      }
      const auto of = repeated.find(input.relative);
      if (of != repeated.end() && found.entry == nullptr) {
        plan.left_out.push_back(entry_of_repeated(input, robot, of->second, finished));
        continue;
      }
      plan.tasks.push_back({&input, &robot, found.entry});
      plan.bytes += input.bytes;
    }
  }
}

std::vector<ManifestEntry> kept_entries(const BatchManifests& manifests, const BatchPlan& plan) {
  std::set<std::pair<std::string, std::string>> redone;
  for (const BatchTask& task : plan.tasks) {
    if (task.candidate == nullptr) redone.emplace(task.input->relative, task.robot->name);
  }
  for (const ManifestEntry& entry : plan.replaced) redone.emplace(entry.relative, entry.robot);
  std::vector<ManifestEntry> kept = latest_entries(manifests.own);
  std::erase_if(kept, [&](const ManifestEntry& entry) {
    return redone.contains({entry.relative, entry.robot}) || is_gone(entry, plan.selection.clips);
  });
  std::map<std::string_view, const std::string*> signatures;
  for (const BatchInput& input : plan.inputs) {
    if (!input.signature.empty()) signatures[input.relative] = &input.signature;
  }
  for (ManifestEntry& entry : kept) {
    const auto found = signatures.find(entry.relative);
    if (found != signatures.end()) entry.signature = *found->second;
  }
  kept.insert(kept.end(), plan.left_out.begin(), plan.left_out.end());
  return kept;
}

}  // namespace retarget
