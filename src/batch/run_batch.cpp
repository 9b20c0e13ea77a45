#include "retarget/batch.h"

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
#include "batch/data_set.h"
#include "batch/manifest.h"
#include "batch/manifests.h"
#include "batch/merge_checks.h"
#include "batch/output_owners.h"
#include "batch/output_tree.h"
#include "batch/pack_motions.h"
#include "batch/plan_batch.h"
#include "batch/resume.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/json.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = ".retarget-batch.lock";
constexpr const char* kLockStem = ".retarget-batch";

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
  RETARGET_TRY(check_batch(request));
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
