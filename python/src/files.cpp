// Files of robot motions, and the robots: convert, compare, robots.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <array>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "notes_observer.h"
#include "raise.h"
#include "retarget/check_options.h"
#include "retarget/compare.h"
#include "retarget/option_table.h"
#include "retarget/rig.h"
#include "retarget/run.h"
#include "retarget/try.h"
#include "tables.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable convert_keywords(ConvertRequest& request) {
  OptionTable table = {memory_row(request.memory_gb)};
  append(table, reading_table(request.reading));
  append(table, without(rows_for(OptionUse::kConvert, robot_table(request.robot)), {"robot"}));
  append(table, time_table(request.time));
  append(table, without(save_table(request.save), {"scene-out"}));
  return table;
}

namespace {

// Returns the paths of the written files.
nb::list convert(const nb::object& input, const nb::object& output, const nb::object& robot,
                 const nb::dict& keywords, const nb::object& data_dir) {
  ConvertRequest request;
  apply_keywords(convert_keywords(request), keywords);
  request.input = bytes_of_path(input, "input");
  request.output = bytes_of_path(output, "output");
  if (request.output == "-") {
    raise(usage_failure("output: expected a file, found standard output").value());
  }
  std::string chosen = bytes_of_folder(data_dir);
  if (nb::isinstance<RobotHandle>(robot)) {
    const LoadedRobot& loaded = nb::cast<const RobotHandle&>(robot).loaded;
    request.robot = loaded.choice;
    chosen = loaded.data_folder;
  } else if (!robot.is_none()) {
    request.robot.name = bytes_of_path(robot, "robot");
  }
  WarningsObserver observer;
  const auto written = without_gil([&]() -> Result<std::vector<WrittenFile>> {
    RETARGET_TRY_ASSIGN(request.data_folder.chosen, data_folder_of(chosen));
    return convert_motion(request, observer);
  });
  observer.tell();
  nb::list paths;
  for (const WrittenFile& file : written) paths.append(path_of(file.item.path));
  return paths;
}

MotionTable table_of(const nb::object& motion, const char* what) {
  const MotionHandle* handle = nullptr;
  if (nb::try_cast(motion, handle) && handle != nullptr) {
    MotionTable table = motion_table(*handle->clip);
    if (handle->rate_known) table.others = {{"fps", {handle->clip->rate().fps()}}};
    return table;
  }
  const std::string path = bytes_of_path(motion, what);
  return without_gil([&] { return load_motion_table(path, memory_share(0.0)); });
}

// The arguments of retarget.Comparison. Two motions are compared as such, two paths as plain tables.
nb::tuple compare(const nb::object& a, const nb::object& b, double tolerance) {
  if (!(tolerance >= 0.0 && tolerance <= 1e6)) {
    raise(usage_failure("tolerance: expected a number from 0 to 1000000").value());
  }
  std::array<MotionTable, 2> tables = {table_of(a, "a"), table_of(b, "b")};
  const bool are_motions = nb::isinstance<MotionHandle>(a) && nb::isinstance<MotionHandle>(b);
  // Rates of motions count only if both are known.
  if (are_motions && (tables[0].others.empty() || tables[1].others.empty())) {
    tables[0].others = tables[1].others = {};
  }
  const MotionDifference found =
      without_gil([&] { return compare_motions(tables[0], tables[1], tolerance); });
  nb::list columns;
  for (const ColumnDifference& each : found.columns) {
    columns.append(nb::make_tuple(name_of(each.column), each.largest, each.largest_frame,
                                  each.first_frame, each.frames_beyond));
  }
  return nb::make_tuple(found.agree(), found.largest, found.frames_a, found.frames_b, columns,
                        texts_of(difference_lines(found)));
}

nb::str robots_json(const nb::object& data_dir) {
  const std::string chosen = bytes_of_folder(data_dir);
  return text_of(without_gil([&]() -> Result<std::string> {
    RETARGET_TRY_ASSIGN(const std::string folder, data_folder_of(chosen));
    RETARGET_TRY_ASSIGN(const auto robots, list_robot_sources(folder));
    return describe_robots(robots, TextForm::kJson);
  }));
}

nb::str robot_json(const nb::object& robot, const nb::object& data_dir) {
  const std::string name = bytes_of_path(robot, "robot");
  const std::string chosen = bytes_of_folder(data_dir);
  std::vector<Warning> warnings;
  const std::string json = without_gil([&]() -> Result<std::string> {
    RETARGET_TRY_ASSIGN(const std::string folder, data_folder_of(chosen));
    RETARGET_TRY_ASSIGN(const RobotSources sources, find_robot_sources(name, folder));
    if (!sources.warning.empty()) warnings.push_back({0, 0, sources.warning});
    return describe_robot(sources, TextForm::kJson);
  });
  warn(warnings, name);
  return text_of(json);
}

}  // namespace

void bind_files(nb::module_& module) {
  module.def("convert", &convert, "input"_a.none(), "output"_a.none(), "robot"_a.none(),
             "options"_a, "data_dir"_a.none());
  module.def("compare", &compare, "a"_a.none(), "b"_a.none(), "tolerance"_a);
  module.def("robots_json", &robots_json, "data_dir"_a.none());
  module.def("robot_json", &robot_json, "robot"_a.none(), "data_dir"_a.none());
}

}  // namespace retarget::python
