// Option tables for signatures, stubs and docs.

#include <nanobind/nanobind.h>

#include "bindings.h"
#include "edit_source.h"
#include "keywords.h"
#include "live_keywords.h"
#include "raise.h"
#include "retarget/batch.h"
#include "retarget/edit_tables.h"
#include "retarget/gallery.h"
#include "retarget/measure_files.h"
#include "retarget/option_table.h"
#include "retarget/report.h"
#include "retarget/run.h"
#include "retarget/serve_table.h"
#include "tables.h"

namespace retarget::python {
namespace {

// Returns the tables by the name of their class in the stubs.
nb::dict option_tables() {
  Options options;
  RobotChoice robot;
  BatchRequest batch;
  ReadingOptions reading;
  FitOptions fit;
  bool dynamics = false;
  nb::dict tables;
  tables["SourceOptions"] = described(source_table(options.source));
  tables["HumanOptions"] = described(human_table(options.human));
  tables["RobotOptions"] = described(without(robot_table(robot), {"robot"}));
  tables["SolvingOptions"] = described(solving_table(options));
  tables["FitOptions"] = described(fit_table(fit));
  tables["SaveOptions"] = described(save_table(options.save));
  tables["TrackingOptions"] = described(rows_for(OptionUse::kTrack, save_table(options.save)));
  OptionTable read = reading_table(reading);
  read.push_back(memory_row(options.source.memory_gb));
  tables["ReadingOptions"] = described(read);
  tables["EvaluateOptions"] = described(evaluate_table(options, dynamics));
  MeasureRequest certificate;
  tables["CertifyOptions"] = described(certify_keywords(certificate));
  tables["BatchOptions"] = described(batch_keywords(batch));
  ConvertRequest convert;
  tables["ConvertOptions"] = described(convert_keywords(convert));
  LiveKeywords live;
  tables["LiveOptions"] = described(live_keywords(live));
  ServeRequest serve;
  tables["ServeOptions"] = described(serve_keywords(serve));
  tables["PlayerOptions"] = described(rows_for(OptionUse::kLive, human_table(options.human)));
  GalleryRequest gallery;
  tables["GalleryOptions"] = described(gallery_keywords(gallery));
  EditOptions edit;
  EditSettings own;
  tables["EditOptions"] = described(edit_table(edit));
  tables["ResampleOptions"] = described(resample_table(own));
  tables["GroundOptions"] = described(ground_table(own));
  tables["LoopOptions"] = described(loop_table(own));
  tables["ConcatenateOptions"] = described(concatenate_table(own));
  tables["PathOptions"] = described(path_table(own));
  return tables;
}

// Returns a list of (key, unit, definition).
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
             "Options of every function, from the option tables of the command line.");
  module.def("metrics", &metrics, "Key, unit and definition of every metric of a report.");
}

}  // namespace retarget::python
