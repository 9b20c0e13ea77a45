// batch: converts folders of clips to folders of motions, in separate processes.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "notes_observer.h"
#include "raise.h"
#include "retarget/batch.h"
#include "retarget/option_table.h"
#include "retarget/repeated_clips.h"
#include "tables.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable batch_keywords(BatchRequest& request) {
  OptionTable table = batch_table(request, request.run);
  // The rows of a batch replace those of a run.
  append(table, without_rows_of(table, source_table(request.run.options.source)));
  append(table, without_rows_of(table, solving_table(request.run.options)));
  append(table, without_rows_of(table, robot_table(request.run.robot)));
  table.push_back(dynamics_row(request.of_clip.dynamics));
  // Python has separate parameters for these.
  return without(std::move(table), {"robot", "output"});
}

namespace {

std::vector<std::string> paths_of(const nb::object& given, const char* what) {
  const bool is_one = nb::isinstance<nb::str>(given) || nb::isinstance<nb::bytes>(given) ||
                      nb::hasattr(given, "__fspath__");
  if (is_one) return {bytes_of_path(given, what)};
  if (!nb::hasattr(given, "__iter__")) {
    raise_type_error(std::string(what) + ": expected a path or several, found " +
                     shown_text(given.type().attr("__name__")));
  }
  std::vector<std::string> paths;
  for (nb::handle each : given) paths.push_back(bytes_of_path(each, what));
  return paths;
}

// Returns the number of failed clips and the summary lines.
nb::tuple batch(const nb::object& inputs, const nb::object& output, const nb::object& robots,
                const nb::dict& keywords, bool quality, bool sidecar, const nb::object& data_dir) {
  BatchRequest request;
  apply_keywords(batch_keywords(request), keywords);
  request.inputs = paths_of(inputs, "inputs");
  request.output = bytes_of_path(output, "output");
  if (nb::isinstance<RobotHandle>(robots)) {
    const LoadedRobot& loaded = nb::cast<const RobotHandle&>(robots).loaded;
    request.run.robot = loaded.choice;
    request.data_folder = loaded.data_folder;
    if (!loaded.choice.name.empty()) request.robots = {loaded.choice.name};
  } else if (!robots.is_none()) {
    request.robots = paths_of(robots, "robots");
  }
  request.quality = quality;
  request.of_clip.sidecar = sidecar;
  request.begin_worker = begin_worker;
  if (request.data_folder.empty()) {
    request.data_folder = value_of(data_folder_of(bytes_of_folder(data_dir)));
  }
  nb::list notes;
  Watcher watcher(nb::none());
  NotesObserver observer(watcher, notes);
  auto failed = [&] {
    const ReleasedGil released;
    return run_batch(request, observer);
  }();
  watcher.rethrow();
  return nb::make_tuple(value_of(std::move(failed)), notes);
}

// Returns a list of (index of the repeated clip, index of the clip that it repeats, mirrored, degrees).
nb::list repeated(const nb::list& names, const nb::list& signatures) {
  std::vector<std::pair<std::string, std::string>> clips;
  std::map<std::string, std::size_t> indices;
  for (std::size_t i = 0; i < nb::len(names); ++i) {
    const auto signature = nb::cast<nb::bytes>(signatures[i]);
    clips.emplace_back(bytes_of_name(names[i], "names"),
                       std::string(signature.c_str(), signature.size()));
    indices.emplace(clips.back().first, i);
  }
  Watcher watcher(nb::none());
  const auto found = [&] {
    const ReleasedGil released;
    return repeated_clips(clips, [&] { return watcher.keep_going({}); });
  }();
  watcher.rethrow();
  nb::list all;
  for (const auto& [name, clip] : found) {
    all.append(nb::make_tuple(indices.at(name), indices.at(clip.of), clip.mirrored, clip.distance));
  }
  return all;
}

}  // namespace

void bind_batch(nb::module_& module) {
  module.def("batch", &batch, "inputs"_a.none(), "output"_a.none(), "robots"_a.none(), "options"_a,
             "quality"_a, "sidecar"_a, "data_dir"_a.none());
  module.def("repeated_clips", &repeated, "names"_a, "signatures"_a);
}

}  // namespace retarget::python
