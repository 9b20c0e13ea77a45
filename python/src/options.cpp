// The rows of options, for signatures, stubs and docs.

#include <nanobind/nanobind.h>

#include "batch_keywords.h"
#include "bindings.h"
#include "evaluate_table.h"
#include "io/reading_table.h"
#include "keywords.h"
#include "options/fit_options.h"
#include "options/run_tables.h"
#include "raise.h"
#include "retarget/report.h"
#include "solving_table.h"

namespace retarget::python {
namespace {

// by the name of the class that has them in stubs
nb::dict option_tables() {
  Options options;
  RobotChoice robot;
  BatchRequest batch;
  ReadingOptions reading;
  FitOptions fit;
  nb::dict tables;
  tables["SourceOptions"] = described(source_table(options.source));
  tables["HumanOptions"] = described(human_table(options.human));
  tables["RobotOptions"] = described(without(robot_table(robot), {"robot"}));
  tables["SolvingOptions"] = described(solving_table(options));
  tables["FitOptions"] = described(fit_table(fit));
  tables["SaveOptions"] = described(save_table(options.save));
  tables["TrackingOptions"] =
      described(only(save_table(options.save), {"format", "npz-fps", "npz-velocity"}));
  OptionTable read = reading_table(reading);
  read.push_back(memory_row(options.source.memory_gb));
  tables["ReadingOptions"] = described(read);
  tables["EvaluateOptions"] = described(evaluate_table(options));
  tables["BatchOptions"] = described(batch_keywords(batch));
  OptionTable edit = human_table(options.human);
  append(edit, only(part_table(options.part), {"start", "end", "frames"}));
  tables["EditOptions"] = described(edit);
  return tables;
}

// (key, unit, definition) of each
nb::list metrics() {
  nb::list all;
  for (const Metric& metric : quality_metrics()) {
    all.append(
        nb::make_tuple(text_of(metric.key), text_of(metric.unit), text_of(metric.definition)));
  }
  return all;
}

}  // namespace

void bind_options(nb::module_& module) {
  module.def("option_tables", &option_tables,
             "The options of each function, from the tables that the command has them from.");
  module.def("metrics", &metrics, "Key, unit and definition of each figure of a report.");
}

}  // namespace retarget::python
