// `retarget batch`: folders of clips to folders of motions.

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <system_error>

#include "base/file.h"
#include "base/suggest.h"
#include "batch/folder_lock.h"
#include "batch/shard.h"
#include "batch_leftovers.h"
#include "batch_manifests.h"
#include "batch_runner.h"
#include "commands.h"
#include "fit_run.h"
#include "human_source.h"
#include "motion/clip_range.h"
#include "outputs.h"
#include "robot_mapping.h"
#include "run_setup.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = ".retarget-batch.lock";
constexpr const char* kLockStem = ".retarget-batch";

Result<void> check_batch_usage(const BatchOptions& options) {
  RunOptions run = options.run;
  if (!options.robots.empty()) run.robot = options.robots.front();
  if (options.inputs.empty() && options.lists.empty()) {
    return usage_failure("no motion files are given",
                         "retarget batch clips/ -o out/ --robot unitree_g1; "
                         "retarget batch --help shows more");
  }
  if (options.robots.size() > 1 && !run.ik_config.empty() && !is_mapping_kind(run.ik_config)) {
    return usage_failure("--ik-config is a mapping to one robot, and there are several",
                         "run a batch for each robot");
  }
  if (options.resume && options.redo) {
    return usage_failure("--resume and --redo exclude each other", "give one of them");
  }
  if (std::ranges::find(options.inputs, "-") != options.inputs.end()) {
    return usage_failure("a batch reads no motion from standard input",
                         "--list - reads names of files there");
  }
  run.output = batch_output(run, "clip.bvh");
  if (auto outputs = plan_outputs(run); !outputs) return failure(outputs.error());
  if (auto writing = write_options(run); !writing) return failure(writing.error());
  if (auto human = check_human_options(run.human); !human) return human;
  const std::string& body = run.source.smpl_model;
  if (std::ifstream file(body); !body.empty() && !file) {
    return config_failure(body, "cannot read the file: " + std::generic_category().message(errno));
  }
  if (auto rate = output_rate(run.fps); !rate) return failure(rate.error());
  if (!run.frames.empty()) {
    constexpr int kAnyLength = std::numeric_limits<int>::max();
    const auto range = frame_range_from_text(run.frames, kAnyLength);
    if (!range) return failure(range.error());
  }
  if (run.method == "fit") {
    if (auto fit = fit_options(run); !fit) return failure(fit.error());
  }
  return check_solving_options(run);
}

std::string without_last_slash(std::string folder) {
  while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
  return folder;
}

Result<std::string> make_output_folder(const std::string& given) {
  std::string folder = without_last_slash(given);
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return usage_failure("the output \"" + folder + "\" is not a folder");
  }
  fs::create_directories(folder, error);
  if (!error) return folder;
  return run_failure(folder,
                     "cannot make the folder: " + std::generic_category().message(error.value()));
}

// robots, loaded once; in a list, since tasks point to them
Result<std::list<BatchRobot>> load_batch_robots(const BatchOptions& options,
                                                const fs::path& data_folder, Console& console) {
  std::vector<std::string> names = options.robots;
  if (names.empty()) names.emplace_back();
  std::list<BatchRobot> robots;
  for (const std::string& name : names) {
    BatchRobot robot;
    robot.run = options.run;
    robot.run.robot = name;
    if (auto resolved = resolve_robot(robot.run.robot, data_folder); !resolved) {
      return failure(resolved.error());
    }
    robot.run.measure = !options.no_quality;
    auto setup = load_robot_setup(robot.run, data_folder, console);
    if (!setup) return failure(setup.error());
    robot.setup = std::move(*setup);
    robot.name = fs::path(robot.setup.robot->name()).filename().string();
    if (names.size() > 1) robot.folder = robot.name + "/";
    auto fingerprint = batch_fingerprint(options, robot.run, robot.setup, data_folder);
    if (!fingerprint) return failure(fingerprint.error());
    robot.fingerprint = std::move(*fingerprint);
    if (std::ranges::find(robots, robot.name, &BatchRobot::name) != robots.end()) {
      return usage_failure("the robot \"" + robot.name + "\" is given twice");
    }
    const RobotMappings& mappings = robot.setup.mappings;
    console.line("robot", robot.name + ", limits " + robot.setup.limits.name + ", mapping " +
                              mappings.of_lafan1.file);
    if (mappings.of_others) {
      console.line("", "of sources that are not LAFAN1: " + mappings.of_others->file);
    }
    robots.push_back(std::move(robot));
  }
  return robots;
}

// all that a batch needs before its first clip
struct BatchPlan {
  std::vector<BatchInput> inputs;
  std::set<std::string> known;  // relative names, those of other parts too
  std::list<BatchRobot> robots;
  std::vector<BatchTask> tasks;  // that are left to do
  std::size_t unchanged = 0;
  std::uint64_t bytes = 0;
};

// every file that a batch would write: no two are one, and none is where a folder is to be
class OutputTree {
 public:
  explicit OutputTree(const BatchOptions& options) : options_(options) {
    // with several robots clips have folders of their own
    if (options.robots.size() > 1) return;
    for (const char* own : {"manifest.jsonl", "summary.csv", "options.json"}) files_[own] = {};
  }

  Result<void> add(const BatchInput& input) {
    OutputOptions of_clip = static_cast<const OutputOptions&>(options_.run);
    of_clip.output = batch_output(options_.run, input.relative);
    const auto items = plan_outputs(of_clip);
    if (!items) return failure(items.error());
    for (const OutputItem& item : *items) {
      if (auto added = add_file(item.path, input); !added) return added;
      if (!options_.run.sidecar) continue;
      if (auto added = add_file(item.path + ".json", input); !added) return added;
    }
    return {};
  }

  // once all are there
  [[nodiscard]] Result<void> check_folders() const {
    for (const auto& [folder, input] : folders_) {
      const auto file = files_.find(folder);
      if (file == files_.end()) continue;
      return usage_failure("\"" + input->path + "\" would be written to a folder \"" + folder +
                               "\", which is " + what_is(file->second),
                           "rename one of them or leave it out with --exclude");
    }
    return {};
  }

 private:
  static std::string what_is(const BatchInput* owner) {
    return owner == nullptr ? "a file of the batch itself"
                            : "the output of \"" + owner->path + "\"";
  }

  Result<void> add_file(const std::string& path, const BatchInput& input) {
    const auto [owner, is_new] = files_.emplace(path, &input);
    if (!is_new) {
      return usage_failure(
          "the output of \"" + input.path + "\" would be called \"" + path + "\", which is " +
              what_is(owner->second),
          "rename one of them, leave it out with --exclude, or write one format at a time");
    }
    for (fs::path folder = fs::path(path).parent_path(); !folder.empty();
         folder = folder.parent_path()) {
      if (!folders_.emplace(folder.string(), &input).second) break;
    }
    return {};
  }

  const BatchOptions& options_;
  std::map<std::string, const BatchInput*> files_;  // and of which clip; null: of the batch
  std::map<std::string, const BatchInput*> folders_;
};

Result<void> check_outputs_of(const std::vector<BatchInput>& inputs, const BatchOptions& options) {
  OutputTree tree(options);
  for (const BatchInput& input : inputs) {
    if (auto added = tree.add(input); !added) return added;
  }
  return tree.check_folders();
}

// no file that is there already is one that is read: a link into the clips' folder, say
Result<void> check_spared(const std::vector<BatchInput>& inputs, const BatchOptions& options,
                          const std::list<BatchRobot>& robots) {
  std::vector<std::string> read = options.lists;
  for (const BatchInput& input : inputs) read.push_back(input.path);
  for (const BatchRobot& robot : robots) {
    const std::vector<std::string> of_robot = files_of(robot.run);
    read.insert(read.end(), of_robot.begin(), of_robot.end());
  }
  const WrittenFiles written(read);
  const std::string folder = without_last_slash(options.output) + "/";
  for (const char* own : {"manifest.jsonl", "summary.csv", "options.json"}) {
    if (auto spared = written.check_spared(folder + own); !spared) return spared;
  }
  for (const BatchRobot& robot : robots) {
    OutputOptions of_clip = static_cast<const OutputOptions&>(robot.run);
    for (const BatchInput& input : inputs) {
      of_clip.output = folder + robot.folder + batch_output(of_clip, input.relative);
      const auto items = plan_outputs(of_clip);
      if (!items) return failure(items.error());
      for (const OutputItem& item : *items) {
        if (auto spared = written.check_spared(item.path); !spared) return spared;
        if (!of_clip.sidecar) continue;
        if (auto spared = written.check_spared(item.path + ".json"); !spared) return spared;
      }
    }
  }
  return {};
}

Result<void> plan_inputs(const BatchOptions& options, const Shard& shard, BatchPlan& plan,
                         Console& console) {
  InputSearch search{options.inputs, options.lists, options.base, options.exclude, options.output};
  auto found = find_inputs(search);
  if (!found) return failure(found.error());
  for (const std::string& note : found->notes) console.line("inputs", note);
  if (auto distinct = check_distinct_outputs(found->inputs); !distinct) {
    return failure(distinct.error());
  }
  if (auto distinct = check_outputs_of(found->inputs, options); !distinct) {
    return failure(distinct.error());
  }
  if (auto spared = check_spared(found->inputs, options, plan.robots); !spared) return spared;
  const std::size_t all = found->inputs.size();
  for (const BatchInput& input : found->inputs) plan.known.insert(input.relative);
  plan.inputs = take_shard(std::move(found->inputs), shard);
  console.line("inputs",
               count_text(static_cast<long>(plan.inputs.size()), "clip") +
                   (shard.count > 1 ? " of " + std::to_string(all) + ", part " + options.shard
                                    : std::string()));
  return {};
}

// longest first, what is done already left out
void plan_tasks(const FinishedClips& finished, BatchPlan& plan) {
  for (const BatchInput& input : plan.inputs) {
    for (const BatchRobot& robot : plan.robots) {
      const auto found =
          finished.find(input.relative, robot.name, robot.fingerprint.hash, input.path);
      if (found.state == RecordState::kSame) {
        ++plan.unchanged;
        continue;
      }
      plan.tasks.push_back({&input, &robot, found.entry});
      plan.bytes += input.bytes;
    }
  }
}

// own entries that stay: all but those of clips that are done again, or are gone
std::vector<ManifestEntry> kept_entries(const BatchManifests& manifests, const BatchPlan& plan) {
  std::set<std::pair<std::string, std::string>> redone;
  for (const BatchTask& task : plan.tasks) {
    if (task.candidate == nullptr) redone.emplace(task.input->relative, task.robot->name);
  }
  std::vector<ManifestEntry> kept = latest_entries(manifests.own);
  std::erase_if(kept, [&](const ManifestEntry& entry) {
    return redone.contains({entry.relative, entry.robot}) || is_gone(entry, plan.known);
  });
  return kept;
}

// of outputs whose files no option of this call makes any more
void warn_of_earlier_files(const std::string& folder, const BatchPlan& plan,
                           const FinishedClips& finished, Console& console) {
  const auto files = files_of_earlier_options(folder, plan.tasks, finished);
  if (files.empty()) return;
  constexpr std::size_t kShown = 3;
  console.warn({{0, 0,
                 count_text(static_cast<long>(files.size()), "file") +
                     " that earlier options made of these clips stay as they are and are no "
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

// what keeps other batches out of the folder, or of one part of it
struct BatchLocks {
  FolderLock folder;
  std::optional<FolderLock> part;
};

Result<BatchLocks> take_locks(const std::string& folder, const Shard& shard, Console& console) {
  const bool is_part = shard.count > 1;
  auto lock = FolderLock::take(folder, kLockName,
                               is_part ? FolderLock::Kind::kShared : FolderLock::Kind::kAlone);
  if (!lock) return failure(lock.error());
  if (!lock->is_held()) {
    console.line("lock", "none: the file system of " + folder +
                             " has no locks; do not start a second batch there");
  }
  BatchLocks locks{std::move(*lock), std::nullopt};
  if (!is_part) return locks;
  auto part = FolderLock::take(folder, shard_file_name(kLockStem, shard, ".lock"),
                               FolderLock::Kind::kAlone);
  if (!part) return failure(part.error());
  locks.part = std::move(*part);
  return locks;
}

// robots and inputs
Result<BatchPlan> plan_batch(const BatchOptions& options, const Shard& shard,
                             const fs::path& data_folder, Console& console) {
  BatchPlan plan;
  auto robots = load_batch_robots(options, data_folder, console);
  if (!robots) return failure(robots.error());
  plan.robots = std::move(*robots);
  if (auto planned = plan_inputs(options, shard, plan, console); !planned) {
    return failure(planned.error());
  }
  return plan;
}

// leaves out what is done, and begins the manifest with it
Result<std::unique_ptr<ManifestWriter>> begin_manifest(const BatchManifests& manifests,
                                                       const FinishedClips& finished,
                                                       BatchPlan& plan, Console& console) {
  plan_tasks(finished, plan);
  if (plan.unchanged > 0) {
    console.line("resume", std::to_string(plan.unchanged) + " of " +
                               std::to_string(plan.unchanged + plan.tasks.size()) +
                               " are done and have not changed");
  }
  return ManifestWriter::begin(manifests.path, kept_entries(manifests, plan));
}

// the clips of the plan, and what is told of them
Result<std::size_t> work_through(const BatchPlan& plan, const BatchOptions& options,
                                 const std::string& folder, const fs::path& data_folder,
                                 const FinishedClips& finished, ManifestWriter& manifest,
                                 Console& console) {
  if (plan.tasks.empty()) return std::size_t{0};
  BatchProgress progress(console, plan.tasks.size(), plan.bytes);
  const auto ran =
      run_batch_tasks(plan.tasks, options, {folder, data_folder, finished, manifest, progress});
  console.end_progress();
  console.line("done", std::to_string(progress.done() + progress.unchanged()) + " of " +
                           count_text(static_cast<long>(plan.tasks.size()), "clip") + ", " +
                           std::to_string(progress.failed()) + " failed; " + progress.work_text());
  if (ran) return progress.failed();
  if (ran.error().kind != ErrorKind::kInterrupted) return failure(ran.error());
  Error stopped = ran.error();
  stopped.message = "interrupted; clips that were not done have no output";
  stopped.hint = "the same call with --resume goes on from here";
  return failure(std::move(stopped));
}

Result<ExitCode> run_batch(const BatchOptions& options, Console& console) {
  if (auto usage = check_batch_usage(options); !usage) return failure(usage.error());
  const Result<Shard> shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
  if (!shard) return failure(shard.error());
  const auto data_folder = data_folder_of(options.run.common);
  if (!data_folder) return failure(data_folder.error());
  auto plan = plan_batch(options, *shard, *data_folder, console);
  if (!plan) return failure(plan.error());

  const auto folder = make_output_folder(options.output);
  if (!folder) return failure(folder.error());
  const auto locks = take_locks(*folder, *shard, console);
  if (!locks) return failure(locks.error());
  auto manifests = open_manifests(*folder, *shard, options, console);
  if (!manifests) return failure(manifests.error());
  std::vector<ManifestEntry> known = manifests->own;
  known.insert(known.end(), manifests->others.begin(), manifests->others.end());
  const FinishedClips finished(std::move(known), *folder);
  auto manifest = begin_manifest(*manifests, finished, *plan, console);
  if (!manifest) return failure(manifest.error());
  const bool alone = shard->count == 1 && locks->folder.is_held();
  const std::set<fs::path> folders = output_folders(*folder, plan->tasks);
  if (alone) remove_unfinished(*folder, folders);
  warn_of_earlier_files(*folder, *plan, finished, console);
  if (auto written = write_options_file(*folder, plan->robots); !written) {
    return failure(written.error());
  }
  const auto failed =
      work_through(*plan, options, *folder, *data_folder, finished, **manifest, console);
  // a clip whose process was ended could not take back what it had begun
  if (alone) remove_unfinished(*folder, folders);
  if (!failed) return failure(failed.error());
  if (auto ended = finish_manifests(*folder, *shard, plan->known, console); !ended) {
    return failure(ended.error());
  }
  return *failed > 0 ? kRunFailed : kDone;
}

Result<ExitCode> merge_batch(const BatchOptions& options, Console& console) {
  const std::string folder = without_last_slash(options.output);
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return usage_failure("\"" + folder + "\" is not the output folder of a batch");
  }
  const auto lock = FolderLock::take(folder, kLockName, FolderLock::Kind::kAlone);
  if (!lock) return failure(lock.error());
  const auto failed = merge_manifests(folder, options.inputs, console);
  if (!failed) return failure(failed.error());
  return *failed > 0 ? kRunFailed : kDone;
}

}  // namespace

ExitCode batch(const BatchOptions& options, Console& console) {
  const auto code = options.merge ? merge_batch(options, console) : run_batch(options, console);
  return code ? *code : console.fail(code.error());
}

}  // namespace retarget::cli
