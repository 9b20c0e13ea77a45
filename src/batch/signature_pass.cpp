#include "batch/signature_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <utility>

#include "batch/duplicates.h"
#include "batch/motion_signature.h"
#include "retarget/load.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Signature of a clip as a run would read it; empty if it cannot be read.
std::string signature_in(const BatchRobot& robot, const BatchInput& clip, double memory_gb) {
  try {
    const Run run = run_of_clip(robot, clip, memory_gb);
    auto loaded = load_clip(run.motion, recorded_source(run.motion, run.options.source),
                            DataFolder{robot.setup.loaded.data_folder});
    if (!loaded) return {};
    const auto plan = make_plan(std::move(*loaded), robot.setup, run.options);
    if (!plan) return {};
    return signature_of(*plan);
  } catch (const std::exception&) {
    // For example, out of memory; the run itself reports it.
    return {};
  }
}

// Clips without mirror images and variations, in the order in which the first duplicate is kept.
std::vector<BatchInput*> originals(std::vector<BatchInput>& inputs) {
  std::vector<BatchInput*> clips;
  for (BatchInput& input : inputs) {
    if (!input.variant.is_derived()) clips.push_back(&input);
  }
  std::ranges::sort(clips, {}, &BatchInput::relative);
  return clips;
}

}  // namespace

std::string signature_of(const Plan& plan) {
  return signature_bytes(
      motion_signature(*plan.clip, plan.human.calibration, plan.part.begin, plan.part.end));
}

Result<void> find_signatures(std::vector<BatchInput>& inputs, const BatchRobot& robot,
                             const BatchRequest& request, const FinishedClips& finished,
                             Observer& observer) {
  const auto interrupts = observer.hold_interrupts();
  std::vector<BatchInput*> unknown;
  for (BatchInput* clip : originals(inputs)) {
    clip->signature =
        finished.signature_of(clip->relative, robot.fingerprint.hash, clip->path, clip->variant);
    if (clip->signature.empty()) unknown.push_back(clip);
  }
  ClipPool pool = clip_pool({unknown.begin(), unknown.end()}, request);
  std::size_t done = 0;
  pool.options.keep_going = [&] { return !observer.is_stopped(); };
  const auto work = [&](std::size_t task) {
    return signature_in(robot, *unknown[task], pool.memory_gb(task));
  };
  const auto ended = [&](std::size_t task, const TaskEnd& end) {
    if (end.answered) unknown[task]->signature = end.answer;
    observer.status(
        fmt::format("searching for duplicate motions: {} of {}", ++done, unknown.size()));
  };
  if (!unknown.empty()) RETARGET_TRY(run_in_processes(pool.memory, pool.options, work, ended));
  observer.end_progress();
  if (observer.is_stopped()) return interrupted_failure();
  return {};
}

Result<std::map<std::string, RepeatedClip>> repeated_inputs(const std::vector<BatchInput>& inputs,
                                                            Observer& observer) {
  const auto interrupts = observer.hold_interrupts();
  std::vector<std::pair<std::string, std::string>> clips;
  for (const BatchInput& input : inputs) {
    if (!input.variant.is_derived()) clips.emplace_back(input.relative, input.signature);
  }
  auto repeated = repeated_clips(clips, [&] { return !observer.is_stopped(); });
  if (observer.is_stopped()) return interrupted_failure();
  // A mirror image or variation shares the result of its original.
  for (const BatchInput& input : inputs) {
    const auto of = repeated.find(input.variant.original());
    if (input.variant.is_derived() && of != repeated.end()) repeated[input.relative] = of->second;
  }
  return repeated;
}

}  // namespace retarget
