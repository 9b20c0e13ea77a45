// to_robot, Plan and solve: from a clip to a robot motion.

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <chrono>
#include <mutex>
#include <span>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "raise.h"
#include "retarget/check_options.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "tables.h"
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

Options options_of(const nb::dict& keywords, const nb::dict& fit) {
  Options options;
  apply_keywords(solving_table(options), keywords);
  apply_keywords(fit_table(options.solve.fit), fit);
  for (const auto& [name, value] : fit) {
    if (!value.is_none()) options.solve.fit_given.push_back(nb::cast<std::string>(name));
  }
  // As in the command, a rate without effect is an error.
  if (const auto rate = check_rate(options); !rate) raise(rate.error());
  return options;
}

// Solves a plan, which is moved in; its clip is released after resampling.
MotionHandle solve_watched(Plan plan, const RobotHandle& robot, std::shared_ptr<const Clip> clip,
                           int threads, const nb::object& progress) {
  if (threads < 0) raise(usage_failure("threads: expected 0 or more").value());
  Watcher watcher(progress);
  SolveControl control;
  control.threads = threads;
  control.keep_going = [&](const Progress& now) { return watcher.keep_going(now); };
  std::string summary = plan.summary();
  const std::vector<Warning> doubts = plan.doubts();
  const std::size_t notes = plan.clip_notes.size();
  auto solved = [&] {
    const ReleasedGil released;
    return solve(std::move(plan), control);
  }();
  watcher.rethrow();
  const auto motion = std::make_shared<const Motion>(value_of(std::move(solved)));
  warn(doubts, clip->name());
  // Solving may change the timing, and notes that.
  summary += summary_text(std::span(motion->plan.clip_notes).subspan(notes));
  if (motion->fit) {
    summary += summary_text(fit_lines(*motion->fit, !motion->clip.robot().fixed_base(), false));
  }
  const std::shared_ptr<const RobotClip> result(motion, &motion->clip);
  const std::string name = clip->name();
  return {
      motion, result, robot, std::move(clip), name, std::move(summary), motion->plan.options.save};
}

MotionHandle to_robot(const ClipHandle& clip, const RobotHandle& robot, const nb::dict& keywords,
                      const nb::dict& fit, int threads, const nb::object& progress) {
  const Options options = options_of(keywords, fit);
  Plan plan = without_gil([&] { return make_plan(*clip, robot.loaded, options); });
  return solve_watched(std::move(plan), robot, clip.shared(), threads, progress);
}

PlanHandle plan_for(const ClipHandle& clip, const RobotHandle& robot, const nb::dict& keywords,
                    const nb::dict& fit) {
  const Options options = options_of(keywords, fit);
  Plan plan = without_gil([&] { return make_plan(*clip, robot.loaded, options); });
  return {std::make_shared<const Plan>(std::move(plan)), robot, clip.shared()};
}

MotionHandle solve_plan(const PlanHandle& plan, int threads, const nb::object& progress) {
  return solve_watched(*plan.plan, plan.robot, plan.clip, threads, progress);
}

// The options that differ from their defaults, by keyword, as text.
nb::dict changed_options(const PlanHandle& plan) {
  Options options = plan.plan->options;
  Options usual;
  const OptionTable table = solving_table(options);
  nb::dict changed;
  for (const std::string& name : retarget::changed_options(table, solving_table(usual))) {
    const Option& row = *find_option(table, name);
    changed[text_of(keyword_of(row))] = text_of(to_text(row.get()));
  }
  return changed;
}

std::string shown_plan(const PlanHandle& plan) {
  return fmt::format("<retarget.Plan of {} for {}: {} frames at {} fps>",
                     nb::cast<std::string>(nb::repr(text_of(plan.clip->name()))),
                     nb::cast<std::string>(text_of(plan.robot->name())), plan.plan->frame_count(),
                     to_text(plan.plan->rate));
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
  const HeldGil held;
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
  nb::class_<PlanHandle>(module, "Plan",
                         "All decisions for retargeting a clip to a robot; solve() makes the "
                         "motion. Immutable; it can be pickled.")
      .def_prop_ro(
          "summary", [](const PlanHandle& plan) { return text_of(plan.plan->summary()); },
          "The decisions, line by line, as the command prints them.")
      .def_prop_ro(
          "fps", [](const PlanHandle& plan) { return plan.plan->rate.fps(); },
          "Frames per second of the motion.")
      .def_prop_ro(
          "frame_count", [](const PlanHandle& plan) { return plan.plan->frame_count(); },
          "Number of frames of the motion.")
      .def_prop_ro(
          "part",
          [](const PlanHandle& plan) {
            return nb::make_tuple(plan.plan->part.begin, plan.plan->part.end);
          },
          nb::sig("def part(self) -> tuple[int, int]"),
          "Frames [begin, end) of the clip that are used.")
      .def_prop_ro(
          "body_height", [](const PlanHandle& plan) { return plan.plan->human.calibration.height; },
          "Height of the human, metres.")
      .def_prop_ro("options", &changed_options, nb::sig("def options(self) -> dict[str, str]"),
                   "Options that differ from their defaults, as text, by keyword.")
      .def_prop_ro(
          "clip", [](const PlanHandle& plan) { return ClipHandle(plan.clip); },
          nb::sig("def clip(self) -> Clip"), "The input clip.")
      .def_prop_ro(
          "robot", [](const PlanHandle& plan) { return plan.robot; },
          nb::sig("def robot(self) -> Robot"), "The robot.")
      .def("__repr__", &shown_plan);
  module.def("make_plan", &plan_for, "clip"_a, "robot"_a, "options"_a, "fit"_a);
  module.def("solve", &solve_plan, "plan"_a, "threads"_a, "progress"_a.none());
  module.def("to_robot", &to_robot, "clip"_a, "robot"_a, "options"_a, "fit"_a, "threads"_a,
             "progress"_a.none());
}

}  // namespace retarget::python
