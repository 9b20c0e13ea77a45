// evaluate: measures the quality of a motion.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "bindings.h"
#include "gates.h"
#include "handles.h"
#include "keywords.h"
#include "notes_observer.h"
#include "raise.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/measure.h"
#include "retarget/measure_files.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "tables.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable evaluate_table(Options& options, bool& dynamics) {
  OptionTable table = rows_for(OptionUse::kMeasure, solve_table(options.solve));
  append(table, rows_for(OptionUse::kMeasure, human_table(options.human)));
  append(table, rows_for(OptionUse::kMeasure, part_table(options.part)));
  append(table, rows_for(OptionUse::kMeasure, time_table(options.time)));
  table.push_back(dynamics_row(dynamics));
  return table;
}

namespace {

// Parses the gate of a metric: an upper bound, a pair (lower, upper), or None, which removes the
// gate.
Gate gate_of(nb::handle key, nb::handle bounds) {
  Gate gate{bytes_of_name(key, "gates"), std::nullopt, std::nullopt};
  if (find_metric(gate.metric) == nullptr) {
    raise(usage_failure("gates: unknown metric \"" + gate.metric + "\"" +
                        did_you_mean(gate.metric, metric_keys()))
              .value());
  }
  const auto number = [&](nb::handle object) -> std::optional<double> {
    if (object.is_none()) return std::nullopt;
    const double value = PyFloat_AsDouble(object.ptr());
    if (PyErr_Occurred() == nullptr && !std::isnan(value)) return value;
    if (PyErr_Occurred() != nullptr) forget_exception();
    raise(
        usage_failure("gates: " + gate.metric + ": expected a maximum, (minimum, maximum) or None")
            .value());
  };
  const bool is_pair = nb::isinstance<nb::tuple>(bounds) || nb::isinstance<nb::list>(bounds);
  if (is_pair && nb::len(bounds) == 2) {
    gate.min = number(bounds[0]);
    gate.max = number(bounds[1]);
  } else {
    gate.max = number(bounds);
  }
  // False for NaN, too.
  if (gate.min && gate.max && !(*gate.min <= *gate.max)) {
    raise(usage_failure("gates: " + gate.metric + ": the minimum is above the maximum").value());
  }
  return gate;
}

}  // namespace

Gates gates_of(const nb::object& given, const std::string& data_folder) {
  if (given.is(nb::handle(Py_False))) return {};
  Gates gates = value_of(default_gates(data_folder));
  if (given.is_none()) return gates;
  if (nb::isinstance<nb::dict>(given)) {
    for (const auto& [key, bounds] : nb::borrow<nb::dict>(given)) gates.set(gate_of(key, bounds));
  } else {
    value_of(gates.add_file(bytes_of_path(given, "gates")));
  }
  return gates;
}

namespace {

Result<QualityReport> measure_alone(const MotionHandle& motion, std::string limits_name,
                                    bool dynamics) {
  const Robot& robot = *motion.robot;
  if (limits_name.empty()) limits_name = robot.limits_for({});
  RETARGET_TRY_ASSIGN(const LimitSet limits, load_limits(robot, limits_name));
  return measure_motion(*motion.clip, limits, nullptr, dynamics).report;
}

// For the clip that the motion was made from, only limits (and dynamics) may differ; other options
// must equal those of the motion.
void check_kept(Options options, const Plan& plan, const nb::dict& keywords) {
  options.time.fps = plan.rate.fps();
  bool dynamics = false;
  const OptionTable table = without(evaluate_table(options, dynamics), {"limits", "dynamics"});
  std::vector<std::string> before;
  for (const Option& row : table) before.push_back(to_text(row.get()));
  nb::dict given;
  for (const auto& [key, value] : keywords) given[key] = value;
  for (const char* name : {"limits", "dynamics"}) {
    if (given.contains(name)) nb::del(given[name]);
  }
  // "source" is another way to give the source's rate.
  if (!plan.options.time.fps && given.contains("fps") &&
      nb::str(given["fps"]).equal(nb::str("source"))) {
    nb::del(given["fps"]);
  }
  apply_keywords(table, given);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (to_text(table[i].get()) == before[i]) continue;
    const std::string name = keyword_of(table[i]);
    raise(usage_failure(name + ": the motion is measured with the options of its run, " + name +
                        " \"" + before[i] + "\"; set another value in to_robot()")
              .value());
  }
}

Result<QualityReport> measure_as_solved(const MotionHandle& handle, const std::string& limits,
                                        bool dynamics) {
  if (limits == handle.solved->plan.options.solve.limits) {
    return retarget::evaluate(*handle.solved, dynamics);
  }
  Motion motion = *handle.solved;
  RETARGET_TRY_ASSIGN(motion.plan.limits, load_limits(*handle.robot, limits));
  return retarget::evaluate(motion, dynamics);
}

bool is_recorded_source(const RecordedMotion& record, const Clip& source) {
  if (!record.recorded || record.recorded->source_hash.empty() || !is_file(source.name())) {
    return false;
  }
  const auto hash = motion_hash(source.name());
  return hash && *hash == record.recorded->source_hash;
}

// Returns text, JSON and whether the motion passed.
nb::tuple evaluate(const MotionHandle& motion, const nb::object& clip, const nb::dict& keywords,
                   const nb::object& given_gates) {
  const Gates gates = gates_of(given_gates, motion.robot.loaded.data_folder);
  const ClipHandle* source = clip.is_none() ? nullptr : nb::cast<const ClipHandle*>(clip);
  const bool is_own =
      motion.solved != nullptr && (source == nullptr || motion.made_from == source->shared() ||
                                   motion.solved->source == source->shared());
  // For another clip or measurement, options that are not given default to those of the motion.
  Options options = measuring_options(motion);
  bool dynamics = false;
  {
    // First, so that suggestions for an unknown name include every option.
    Options scratch = options;
    apply_keywords(evaluate_table(scratch, dynamics), keywords);
  }
  if (is_own) check_kept(options, motion.solved->plan, keywords);
  WarningsObserver observer;
  RecordedMotion record =
      source == nullptr ? record_of(motion) : record_against(motion, *source, observer);
  const auto is_given = [&](const char* name) {
    return keywords.contains(name) && !keywords[name].is_none();
  };
  if (is_given("start") || is_given("frames")) {
    record.part_start.reset();
    // Another part of the source than that of the run.
    options.part = without_part(options.part);
  } else if (is_given("end") && source != nullptr && is_recorded_source(record, **source)) {
    // The part begins where the run's does.
    if (options.part.start_s < 0.0 && options.part.frames.empty()) {
      options.part.start_s = record.recorded->run.options.part.start_s;
    }
  }
  apply_keywords(evaluate_table(options, dynamics), keywords);
  QualityReport report = without_gil([&]() -> Result<QualityReport> {
    if (is_own) return measure_as_solved(motion, options.solve.limits, dynamics);
    if (source == nullptr) return measure_alone(motion, options.solve.limits, dynamics);
    RETARGET_TRY_ASSIGN(MotionBeside measured,
                        measure_against(*motion.clip, record, **source, motion.robot.loaded,
                                        options, dynamics, observer));
    return std::move(measured.report);
  });
  observer.tell();
  report.file = std::filesystem::path(motion.name).filename().string();
  gates.judge(report);
  return nb::make_tuple(text_of(report_text({&report, 1})), text_of(report_json({&report, 1})));
}

}  // namespace

void bind_evaluate(nb::module_& module) {
  module.def("evaluate", &evaluate, "motion"_a, "clip"_a.none(), "options"_a, "gates"_a.none());
}

}  // namespace retarget::python
