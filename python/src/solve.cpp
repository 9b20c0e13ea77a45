// to_robot: converts a clip to a robot motion.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <chrono>
#include <mutex>
#include <optional>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "raise.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/try.h"
#include "solving_table.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable solving_table(Options& options) {
  OptionTable table = human_table(options.human);
  append(table, part_table(options.part));
  append(table, solve_table(options.solve));
  append(table, time_table(options.time));
  append(table, save_table(options.save));
  table.push_back(memory_row(options.source.memory_gb));
  return table;
}

namespace {

struct Solved {
  std::shared_ptr<const Motion> motion;
  std::string summary;
  std::vector<Warning> doubts;
};

Result<Solved> solve_clip(const Clip& clip, const LoadedRobot& robot, const Options& options,
                          const SolveControl& control) {
  RETARGET_TRY_ASSIGN(Plan plan, make_plan(clip, robot, options));
  Solved solved{nullptr, plan.summary(), plan.doubts()};
  RETARGET_TRY_ASSIGN(Motion motion, solve(std::move(plan), control));
  solved.motion = std::make_shared<const Motion>(std::move(motion));
  return solved;
}

MotionHandle to_robot(const ClipHandle& clip, const RobotHandle& robot, const nb::dict& keywords,
                      const nb::dict& fit, int threads, const nb::object& progress) {
  Options options;
  apply_keywords(solving_table(options), keywords);
  apply_keywords(fit_table(options.solve.fit), fit);
  for (const auto& [name, value] : fit) {
    if (!value.is_none()) options.solve.fit_given.push_back(nb::cast<std::string>(name));
  }
  if (threads < 0) raise(usage_failure("threads: expected 0 or more").value());
  Watcher watcher(progress);
  SolveControl control;
  control.threads = threads;
  control.keep_going = [&](const Progress& now) { return watcher.keep_going(now); };
  auto solved = [&] {
    const nb::gil_scoped_release released;
    return solve_clip(*clip, robot.loaded, options, control);
  }();
  watcher.rethrow();
  auto [motion, summary, doubts] = value_of(std::move(solved));
  warn(doubts, clip->name());
  const std::shared_ptr<const RobotClip> result(motion, &motion->clip);
  return {motion, result, robot, clip.shared(), clip->name(), spell_options(summary)};
}

}  // namespace

Watcher::Watcher(nb::object progress) : progress_(std::move(progress)) {}

bool Watcher::keep_going(const Progress& now) {
  constexpr std::chrono::milliseconds kInterval{50};
  {
    // This is called often and from any thread, so it takes the GIL only at intervals.
    const std::lock_guard lock(mutex_);
    const auto time = std::chrono::steady_clock::now();
    if (time < next_) return true;
    next_ = time + kInterval;
  }
  const nb::gil_scoped_acquire acquired;
  if (error_) return false;
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress_.is_none()) {
      progress_(now.stage == Stage::kFrames ? "frames" : "fit", now.done, now.total);
    }
  } catch (nb::python_error& error) {
    error_.emplace(std::move(error));
    return false;
  }
  return true;
}

void Watcher::rethrow() {
  if (error_) throw nb::python_error(std::move(*error_));
}

void bind_solve(nb::module_& module) {
  module.def("to_robot", &to_robot, "clip"_a, "robot"_a, "options"_a, "fit"_a, "threads"_a,
             "progress"_a.none());
}

}  // namespace retarget::python
