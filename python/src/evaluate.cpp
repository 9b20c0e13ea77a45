// evaluate: how good a motion is.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <filesystem>
#include <optional>

#include "base/suggest.h"
#include "base/try.h"
#include "bindings.h"
#include "evaluate_table.h"
#include "handles.h"
#include "keywords.h"
#include "options/run_tables.h"
#include "plan/gates.h"
#include "plan/measure_motion.h"
#include "quality/measure.h"
#include "raise.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "robot/resample_robot.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable evaluate_table(Options& options, bool& dynamics) {
  OptionTable table = only(solve_table(options.solve), {"limits", "ik-config"});
  append(table, human_table(options.human));
  append(table, only(part_table(options.part), {"start", "lead-in"}));
  append(table, only(time_table(options.time), {"fps"}));
  table.push_back(dynamics_row(dynamics));
  return table;
}

namespace {

// of a metric: its largest value, (smallest, largest) or None, which removes its gate
Gate gate_of(nb::handle key, nb::handle bounds) {
  Gate gate{bytes_of_name(key, "gates"), std::nullopt, std::nullopt};
  if (find_metric(gate.metric) == nullptr) {
    raise(usage_failure("gates: there is no metric \"" + gate.metric + "\"" +
                        did_you_mean(gate.metric, metric_keys()))
              .value());
  }
  const auto number = [&](nb::handle object) -> std::optional<double> {
    if (object.is_none()) return std::nullopt;
    const double value = PyFloat_AsDouble(object.ptr());
    if (PyErr_Occurred() == nullptr) return value;
    forget_exception();
    raise(usage_failure("gates: " + gate.metric +
                        ": expected a largest value, (smallest, largest) or None")
              .value());
  };
  const bool is_pair = nb::isinstance<nb::tuple>(bounds) || nb::isinstance<nb::list>(bounds);
  if (is_pair && nb::len(bounds) == 2) {
    gate.min = number(bounds[0]);
    gate.max = number(bounds[1]);
  } else {
    gate.max = number(bounds);
  }
  return gate;
}

// None: the default ones; else what a dictionary or a file changes of them; False: none at all
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

Result<QualityReport> measure(const MotionHandle& motion, const ClipHandle* clip, Options options,
                              bool dynamics) {
  const Robot& robot = *motion.robot;
  std::string& limits_name = options.solve.limits;
  if (limits_name.empty()) limits_name = robot.limits_for({});
  TRY_ASSIGN(const LimitSet limits, load_limits(robot, limits_name));
  if (clip == nullptr) {
    QualityReport report = measure_motion(*motion.clip, limits, nullptr).report;
    if (dynamics) add_dynamics(*motion.clip, report);
    return report;
  }
  TRY_ASSIGN(const RobotSetup setup, set_up_robot(motion.robot.loaded, options));
  TRY_ASSIGN(Plan plan, make_plan(**clip, setup, options));
  // as the command does: what a body without some bones lacks is measured, too
  plan.config = setup.config_for(plan.human);
  TRY_ASSIGN(const MeasuredSource source, measured_source(std::move(plan)));
  TRY_ASSIGN(const RobotClip at_rate, resample_robot(*motion.clip, source.rate));
  QualityReport report = measure_motion(at_rate, limits, &source).report;
  if (dynamics) add_dynamics(at_rate, report);
  return report;
}

// beside the clip it was made from only limits may be others: what else is given must be as it was
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
  // it may be called the source's rate as well
  if (!plan.options.time.fps && given.contains("fps") &&
      nb::str(given["fps"]).equal(nb::str("source"))) {
    nb::del(given["fps"]);
  }
  apply_keywords(table, given);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (to_text(table[i].get()) == before[i]) continue;
    const std::string name = keyword_of(table[i]);
    raise(usage_failure(name + ": the motion is measured as it was made, with " + name + " \"" +
                        before[i] + "\"; to_robot() takes another one")
              .value());
  }
}

Result<QualityReport> measure_as_solved(const MotionHandle& handle, const std::string& limits,
                                        bool dynamics) {
  if (limits == handle.solved->plan.options.solve.limits) {
    return retarget::evaluate(*handle.solved, dynamics);
  }
  Motion motion = *handle.solved;
  TRY_ASSIGN(motion.plan.limits, load_limits(*handle.robot, limits));
  return retarget::evaluate(motion, dynamics);
}

// text, JSON and whether the motion passed
nb::tuple evaluate(const MotionHandle& motion, const nb::object& clip, const nb::dict& keywords,
                   const nb::object& given_gates) {
  const Gates gates = gates_of(given_gates, motion.robot.loaded.data_folder);
  const ClipHandle* source = clip.is_none() ? nullptr : nb::cast<const ClipHandle*>(clip);
  const bool is_own = motion.solved != nullptr &&
                      (source == nullptr || motion.made_from.lock() == source->shared() ||
                       motion.solved->source == source->shared());
  // of another clip, or measured in another way: what the motion was made with stays where nothing is given
  Options options = motion.solved ? motion.solved->plan.options : Options{};
  if (motion.solved) options.time.fps = motion.clip->rate().fps();
  if (is_own) check_kept(options, motion.solved->plan, keywords);
  bool dynamics = false;
  apply_keywords(evaluate_table(options, dynamics), keywords);
  QualityReport report = without_gil([&]() -> Result<QualityReport> {
    if (is_own) return measure_as_solved(motion, options.solve.limits, dynamics);
    return measure(motion, source, options, dynamics);
  });
  report.file = std::filesystem::path(motion.name).filename().string();
  gates.judge(report);
  return nb::make_tuple(text_of(report_text({&report, 1})), text_of(report_json({&report, 1})));
}

}  // namespace

void bind_evaluate(nb::module_& module) {
  module.def("evaluate", &evaluate, "motion"_a, "clip"_a.none(), "options"_a, "gates"_a.none());
}

}  // namespace retarget::python
