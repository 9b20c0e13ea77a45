// certify: measures, simulates and predicts a motion file, in one document.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <utility>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "notes_observer.h"
#include "raise.h"
#include "retarget/certificate.h"
#include "retarget/check_options.h"
#include "retarget/measure.h"
#include "retarget/measure_files.h"
#include "retarget/try.h"
#include "tables.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable certify_keywords(MeasureRequest& request) {
  OptionTable table = {
      option("fps", request.fps, kTimeGroup, "N|source",
             "Frame rate of the source, and of a motion whose file states none, in frames per "
             "second, or `source` (default: the rate of the motion)",
             {.decides = false}),
      gate_row(request.gates)};
  OptionTable of_run = source_table(request.run.options.source);
  append(of_run, human_table(request.run.options.human));
  append(of_run, part_table(request.run.options.part));
  append(of_run, without(robot_table(request.run.robot), {"robot"}));
  append(of_run, solve_table(request.run.options.solve));
  append(of_run, time_table(request.run.options.time));
  append(table, without_rows_of(table, rows_for(OptionUse::kMeasure, std::move(of_run))));
  append(table, without_rows_of(table, reading_table(request.reading)));
  return table;
}

namespace {

// Returns the certificate as JSON.
nb::str certify(const nb::object& motion, const nb::object& robot, const nb::object& clip,
                bool mirror, const nb::dict& keywords, const nb::object& data_dir) {
  MeasureRequest request;
  apply_keywords(certify_keywords(request), keywords);
  request.motions = {bytes_of_path(motion, "motion")};
  if (!robot.is_none()) request.run.robot.name = bytes_of_path(robot, "robot");
  if (!clip.is_none()) request.run.motion = bytes_of_path(clip, "clip");
  request.of_source.mirror = mirror;
  request.data_folder = DataFolder{value_of(data_folder_of(bytes_of_folder(data_dir)))};
  nb::list notes;
  Watcher watcher(nb::none());
  NotesObserver observer(watcher, notes);
  Result<Certificate> done = [&]() -> Result<Certificate> {
    const ReleasedGil released;
    RETARGET_TRY(check_robot_choice(request.run.robot));
    return retarget::certify(request, observer);
  }();
  watcher.rethrow();
  return text_of(value_of(std::move(done)).json);
}

}  // namespace

void bind_certify(nb::module_& module) {
  module.def("certify", &certify, "motion"_a.none(), "robot"_a.none(), "clip"_a.none(), "mirror"_a,
             "options"_a, "data_dir"_a.none());
}

}  // namespace retarget::python
