#include "batch/batch_runner.h"

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>

#include "batch/batch_worker.h"
#include "batch/input_variants.h"
#include "retarget/check_options.h"
#include "retarget/machine.h"
#include "retarget/text.h"

namespace retarget {

std::string batch_output(const SaveOptions& options, const std::string& relative) {
  // With several formats, each replaces this extension by its own.
  const MotionFormat format =
      options.formats.size() == 1 ? options.formats.front() : MotionFormat::kCsv;
  return output_stem(relative) + std::string(format_ending(format));
}

std::string contacts_output(const std::string& relative) {
  return output_stem(relative) + ".contacts.csv";
}

// Later entries of a clip take precedence, so this one must be later than all known ones.
std::string finished_now(const FinishedClips& finished, const ManifestEntry& entry) {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return finished_after(std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count(),
                        finished.last_finished(entry.relative, entry.robot));
}

double ClipPool::memory_gb(std::size_t task) const {
  return static_cast<double>(std::min(memory[task], options.memory)) / 1e9;
}

ClipPool clip_pool(const std::vector<const BatchInput*>& clips, const BatchRequest& request) {
  ClipPool pool;
  ProcessPoolOptions& options = pool.options;
  options.workers = std::min(request.jobs > 0 ? request.jobs : usable_cores(),
                             static_cast<int>(std::max<std::size_t>(1, clips.size())));
  options.memory = memory_bound(request.run.options.source.memory_gb);
  // Each clip may use its estimated memory, and at least an even share of the total.
  const std::uint64_t even = options.memory / static_cast<std::uint64_t>(options.workers);
  pool.memory.reserve(clips.size());
  for (const BatchInput* clip : clips) {
    pool.memory.push_back(std::max(memory_of_clip(clip->relative, clip->bytes), even));
  }
  if (options.memory > 0) {
    const std::uint64_t largest = pool.memory.empty() ? 0 : *std::ranges::max_element(pool.memory);
    options.max_memory = std::max(options.memory, largest) + kMemoryOfProcess;
  }
  options.timeout_s = request.clip_timeout_s;
  options.end_process = ::_exit;
  options.begin_worker = request.begin_worker;
  return pool;
}

Run run_of_clip(const BatchRobot& robot, const BatchInput& clip, double memory_gb) {
  Run run = robot.run;
  run.motion = clip.path;
  SourceOptions& source = run.options.source;
  // The body model applies only to the SMPL motions among the clips.
  const std::string extension = std::filesystem::path(clip.relative).extension().generic_string();
  if (lower_case(extension) == ".bvh") source.smpl_model.clear();
  source.memory_gb = memory_gb;
  if (!clip.variant.part.empty()) {
    const LeadIn lead_in = run.options.part.lead_in;
    run.options.part = part_options(clip.variant.part);
    run.options.part.lead_in = lead_in;
  }
  apply_changes(clip.variant.changes, run.options.solve);
  return run;
}

Result<void> run_batch_tasks(const std::vector<BatchTask>& tasks, const BatchRequest& request,
                             const BatchContext& context) {
  const auto interrupts = context.observer.hold_interrupts();
  std::vector<const BatchInput*> clips;
  clips.reserve(tasks.size());
  for (const BatchTask& task : tasks) clips.push_back(task.input);
  ClipPool pool = clip_pool(clips, request);
  BatchWorker worker(context, request, std::max(1, usable_cores() / pool.options.workers));
  pool.options.keep_going = [&] { return worker.keep_going(); };
  const auto work = [&](std::size_t task) {
    return worker.work(tasks[task], pool.memory_gb(task));
  };
  auto ran = run_in_processes(
      pool.memory, pool.options, work,
      [&](std::size_t task, const TaskEnd& end) { worker.take(tasks[task], end); });
  if (!ran) return ran;
  context.progress.show();
  return worker.result();
}

}  // namespace retarget
