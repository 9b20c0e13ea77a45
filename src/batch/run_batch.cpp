#include "retarget/batch.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "batch/batch_report.h"
#include "batch/batch_runner.h"
#include "batch/certify_clip.h"
#include "batch/data_set.h"
#include "batch/duplicates.h"
#include "batch/find_inputs.h"
#include "batch/input_variants.h"
#include "batch/manifest.h"
#include "batch/manifests.h"
#include "batch/merge_checks.h"
#include "batch/output_owners.h"
#include "batch/output_tree.h"
#include "batch/pack_motions.h"
#include "batch/resume.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/json.h"
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

constexpr const char* kLockName = ".retarget-batch.lock";
constexpr const char* kLockStem = ".retarget-batch";

Result<void> check_request(const BatchRequest& request) {
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

// Normalised so that it can be joined with names in the manifest.
std::string folder_text(const std::string& folder) {
  return os::without_last_separators(os::with_slashes(folder));
}

// Returns `.` for a bare file name.
std::string folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder.generic_string();
}

Result<std::string> make_output_folder(const std::string& given) {
  std::string folder = folder_text(given);
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return usage_failure("the output \"" + folder + "\" is not a folder");
  }
  fs::create_directories(folder, error);
  if (!error) return folder;
  return run_failure(folder,
                     "cannot create the folder: " + std::generic_category().message(error.value()));
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

// Everything that a batch needs before its first clip.
struct BatchPlan {
  std::vector<BatchInput> inputs;
  BatchSelection selection;
  std::list<BatchRobot> robots;
  std::vector<BatchTask> tasks;         // Tasks that remain.
  std::vector<ManifestEntry> left_out;  // Skipped duplicates.
  std::vector<ManifestEntry> replaced;  // Clips that are gone, whose outputs others replace.
  std::size_t unchanged = 0;
  std::uint64_t bytes = 0;
};

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

// Creates tasks, longest first, without clips that are done already or are duplicates.
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

// Own entries except those of clips that are done again or are gone.
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

// Warns of files of discarded entries that this batch does not replace.
// @param owner  what was discarded
void warn_of_discarded_files(const std::string& folder, const BatchPlan& plan,
                             const std::vector<ManifestEntry>& discarded, const std::string& owner,
                             const BatchRequest& request, Observer& observer) {
  const auto files = files_of_discarded(folder, discarded, plan.tasks, request);
  if (files.empty()) return;
  constexpr std::size_t kShown = 3;
  observer.warn(
      {{0, 0,
        count_text(files.size(), "file") + " of " + owner +
            (files.size() == 1 ? " remains in place and is" : " remain in place and are") +
            " not in the new manifest: " + list_names(files, kShown)}},
      folder);
}

// Warns of output files that the current options no longer create.
void warn_of_earlier_files(const std::string& folder, const BatchPlan& plan,
                           const FinishedClips& finished, bool certify, Observer& observer) {
  const auto files = files_of_earlier_options(folder, plan.tasks, finished, certify);
  if (files.empty()) return;
  constexpr std::size_t kShown = 3;
  observer.warn({{0, 0,
                  count_text(files.size(), "file") +
                      " written by earlier options for these clips remain in place and are no "
                      "longer in the manifest: " +
                      list_names(files, kShown)}},
                folder);
}

Result<void> write_options_file(const std::string& folder, const std::list<BatchRobot>& robots) {
  std::string text = "[";
  for (const BatchRobot& robot : robots) {
    text += (text.size() > 1 ? ",\n" : "\n") + robot.fingerprint.description;
  }
  return write_file(folder + "/options.json", text + "\n]\n");
}

// Locks that exclude other batches from the folder, or from one shard of it.
struct BatchLocks {
  FolderLock folder;
  std::optional<FolderLock> part;
};

Result<BatchLocks> take_locks(const std::string& folder, const Shard& shard, Observer& observer) {
  const bool is_part = shard.count > 1;
  RETARGET_TRY_ASSIGN(
      auto lock, FolderLock::take(folder, kLockName,
                                  is_part ? FolderLock::Kind::kShared : FolderLock::Kind::kAlone));
  if (!lock.is_held()) {
    observer.line("lock", "none: the file system of " + folder +
                              " does not support locks; do not start a second batch there");
  }
  BatchLocks locks{std::move(lock), std::nullopt};
  if (!is_part) return locks;
  RETARGET_TRY_ASSIGN(locks.part,
                      FolderLock::take(folder, shard_file_name(kLockStem, shard, ".lock"),
                                       FolderLock::Kind::kAlone));
  return locks;
}

// Loads robots and finds inputs.
Result<BatchPlan> plan_batch(const BatchRequest& request, const Shard& shard, Observer& observer) {
  BatchPlan plan;
  RETARGET_TRY_ASSIGN(plan.robots, load_batch_robots(request, observer));
  for (const BatchRobot& robot : plan.robots) plan.selection.robots.insert(robot.name);
  RETARGET_TRY(plan_inputs(request, shard, plan, observer));
  return plan;
}

// Removes finished clips from the plan and begins the manifest with them.
Result<std::unique_ptr<ManifestWriter>> begin_manifest(const BatchManifests& manifests,
                                                       const FinishedClips& finished,
                                                       const BatchRequest& request, BatchPlan& plan,
                                                       Observer& observer) {
  std::map<std::string, RepeatedClip> repeated;
  // A split keeps mirror images together, which only signatures reveal.
  if (request.dedupe || !request.split.empty()) {
    RETARGET_TRY(find_signatures(plan.inputs, plan.robots.front(), request, finished, observer));
  }
  if (request.dedupe) {
    RETARGET_TRY_ASSIGN(repeated, repeated_inputs(plan.inputs, observer));
    observer.line("dedupe", std::to_string(repeated.size()) + " of " +
                                count_text(plan.inputs.size(), "clip") +
                                (repeated.size() == 1 ? " repeats another" : " repeat others"));
  }
  plan_tasks(finished, repeated, plan);
  if (plan.unchanged > 0) {
    observer.line("resume", std::to_string(plan.unchanged) + " of " +
                                std::to_string(plan.unchanged + plan.tasks.size()) +
                                " are done and unchanged");
  }
  return ManifestWriter::begin(manifests.path, kept_entries(manifests, plan));
}

// Runs the tasks of the plan and reports the result.
Result<std::size_t> work_through(const BatchPlan& plan, const BatchRequest& request,
                                 const std::string& folder, const FinishedClips& finished,
                                 ManifestWriter& manifest, Observer& observer) {
  if (plan.tasks.empty()) return std::size_t{0};
  BatchProgress progress(observer, folder, plan.tasks.size(), plan.bytes);
  const auto ran =
      run_batch_tasks(plan.tasks, request, {folder, finished, manifest, progress, observer});
  observer.end_progress();
  observer.line("done", std::to_string(progress.done() + progress.unchanged()) + " of " +
                            count_text(plan.tasks.size(), "clip") + ", " +
                            std::to_string(progress.failed()) + " failed; " + progress.work_text());
  if (ran) return progress.failed();
  if (ran.error().kind != ErrorKind::kInterrupted) return failure(ran.error());
  Error stopped = ran.error();
  stopped.message = "interrupted; unfinished clips have no output";
  stopped.hint = "the same command with " RETARGET_OPTION("resume") " continues from here";
  return failure(std::move(stopped));
}

// Updates the gates recorded in options.json after they changed.
Result<void> record_gates(const std::string& folder, const Gates& gates) {
  const std::string path = folder + "/options.json";
  // Ignore an unreadable file.
  auto options = load_json(path);
  if (!options || !options->is_array()) return {};
  for (auto& each : *options) {
    if (each.is_object()) each["gates"] = gates_json(gates);
  }
  return write_file(path, printable_dump(*options));
}

}  // namespace

Result<std::size_t> run_batch(const BatchRequest& given, Observer& observer) {
  BatchRequest request = given;
  RETARGET_TRY(check_request(request));
  // A certificate records the options of its motion, which sidecars have.
  request.of_clip.sidecar |= request.certify;
  request.of_clip.dynamics |= request.certify;
  Shard shard;
  if (!request.shard.empty()) {
    RETARGET_TRY_ASSIGN(shard, parse_shard(request.shard));
  }
  RETARGET_TRY_ASSIGN(const DataSetRules rules, data_set_rules(request, false));
  RETARGET_TRY_ASSIGN(BatchPlan plan, plan_batch(request, shard, observer));
  RETARGET_TRY_ASSIGN(const std::string folder, make_output_folder(request.output));
  RETARGET_TRY_ASSIGN(const BatchLocks locks, take_locks(folder, shard, observer));
  const auto check_new = [&] {
    return check_outputs_new(plan.inputs, request, folder, plan.robots, shard.count == 1);
  };
  // First, because --redo removes the manifests of parts.
  if (request.redo) RETARGET_TRY(check_new());
  RETARGET_TRY_ASSIGN(const BatchManifests manifests,
                      open_manifests(folder, shard, request, observer));
  if (!request.redo && (!request.resume || manifests.is_new)) RETARGET_TRY(check_new());
  std::vector<ManifestEntry> known = manifests.own;
  known.insert(known.end(), manifests.others.begin(), manifests.others.end());
  RETARGET_TRY_ASSIGN(plan.replaced, entries_that_give_way(plan.inputs, request, plan.robots, known,
                                                           plan.selection.clips));
  const FinishedClips finished(std::move(known), folder);
  RETARGET_TRY_ASSIGN(auto manifest, begin_manifest(manifests, finished, request, plan, observer));
  const bool alone = shard.count == 1 && locks.folder.is_held();
  const std::set<fs::path> folders = output_folders(folder, plan.tasks);
  if (alone) remove_unfinished(folder, folders);
  warn_of_earlier_files(folder, plan, finished, request.certify, observer);
  warn_of_discarded_files(folder, plan, manifests.discarded, "the discarded batch", request,
                          observer);
  warn_of_discarded_files(folder, plan, plan.replaced, "deleted clips", request, observer);
  RETARGET_TRY(write_options_file(folder, plan.robots));
  auto failed = work_through(plan, request, folder, finished, *manifest, observer);
  manifest.reset();  // Windows does not replace open files.
  // A clip whose process was killed could not remove its unfinished outputs.
  if (alone) remove_unfinished(folder, folders);
  if (failed) RETARGET_TRY(finish_manifests(folder, shard, plan.selection, rules, observer));
  if (failed && request.motion_list && shard.count == 1) {
    RETARGET_TRY(write_motion_lists(folder, observer));
  }
  if (failed && !request.pack.empty() && shard.count == 1) {
    RETARGET_TRY(pack_motions(folder, request, &plan.selection, observer));
  }
  return failed;
}

Result<std::size_t> merge_batch(const BatchRequest& request, Observer& observer) {
  RETARGET_TRY(check_merge(request));
  const std::string folder = folder_text(request.output);
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return usage_failure("\"" + folder + "\" is not the output folder of a batch");
  }
  if (!request.pack.empty()) RETARGET_TRY(check_pack_name(request.pack));
  RETARGET_TRY_ASSIGN(const DataSetRules rules, data_set_rules(request, true));
  RETARGET_TRY_ASSIGN(const auto lock,
                      FolderLock::take(folder, kLockName, FolderLock::Kind::kAlone));
  auto failed = merge_manifests(folder, request.inputs, rules, observer);
  if (failed && rules.gates) RETARGET_TRY(record_gates(folder, *rules.gates));
  if (failed && request.motion_list) RETARGET_TRY(write_motion_lists(folder, observer));
  if (failed && !request.pack.empty()) {
    RETARGET_TRY(pack_motions(folder, request, nullptr, observer));
  }
  return failed;
}

}  // namespace retarget
