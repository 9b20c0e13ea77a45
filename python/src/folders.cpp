// Whole commands besides batch: verify, gallery, add_robot.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <filesystem>
#include <string>
#include <utility>

#include "bindings.h"
#include "handles.h"
#include "keywords.h"
#include "notes_observer.h"
#include "raise.h"
#include "retarget/file.h"
#include "retarget/gallery.h"
#include "retarget/measure.h"
#include "retarget/option_table.h"
#include "retarget/rig.h"
#include "retarget/run.h"
#include "retarget/try.h"
#include "tables.h"
#include "watcher.h"

namespace retarget::python {

using namespace nb::literals;

OptionTable gallery_keywords(GalleryRequest& request) {
  OptionTable table = without(rows_for(OptionUse::kShow, robot_table(request.robot)), {"robot"});
  append(table, {gate_row(request.gates),
                 option("meshes", request.meshes, kOutputGroup, "DIR",
                        "Folder of meshes or another model of the robot for the pages (default: "
                        "no meshes, which keeps the pages small)")});
  return table;
}

namespace {

// Runs a command and returns its messages.
template <typename Function>
nb::list notes_of(const Function& function) {
  nb::list notes;
  Watcher watcher(nb::none());
  NotesObserver observer(watcher, notes);
  Result<void> done = [&] {
    const ReleasedGil released;
    return function(observer);
  }();
  watcher.rethrow();
  value_of(std::move(done));
  return notes;
}

nb::list verify(const nb::object& sidecar, const nb::object& data_dir) {
  const std::string file = bytes_of_path(sidecar, "sidecar");
  const DataFolder folder{value_of(data_folder_of(bytes_of_folder(data_dir)))};
  return notes_of([&](Observer& observer) { return verify_run(file, folder, observer); });
}

nb::list gallery(const nb::object& batch, const nb::object& output, const nb::object& robot,
                 const nb::dict& keywords, const nb::object& data_dir) {
  GalleryRequest request;
  apply_keywords(gallery_keywords(request), keywords);
  request.batch = bytes_of_path(batch, "batch");
  request.output = bytes_of_path(output, "output");
  if (!robot.is_none()) request.robot.name = bytes_of_path(robot, "robot");
  request.data_folder = DataFolder{value_of(data_folder_of(bytes_of_folder(data_dir)))};
  request.begin_worker = begin_worker;
  std::filesystem::path folder = std::filesystem::path(request.output).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  value_of(check_output_folder(folder.string()));
  return notes_of([&](Observer& observer) { return write_gallery(request, observer); });
}

// Returns the folder, the summary and the notes of a new robot.
nb::tuple add_robot(const nb::object& model, const nb::object& name, const nb::object& output,
                    const nb::dict& keywords, bool force) {
  RobotBase base = RobotBase::kAuto;
  apply_keywords({option("base", base, OptionInfo{})}, keywords);
  const std::string path = bytes_of_path(model, "model");
  const std::string robot = bytes_of_name(name, "name");
  const std::filesystem::path into = bytes_of_path(output, "output");
  std::string folder;
  const MadeRobot made = without_gil([&]() -> Result<MadeRobot> {
    RETARGET_TRY(check_new_robot(path, robot, into, force));
    RETARGET_TRY_ASSIGN(MadeRobot robot_folder, make_robot(path, robot, base));
    RETARGET_TRY_ASSIGN(folder, save_robot(robot_folder, into, force));
    return robot_folder;
  });
  return nb::make_tuple(path_of(folder), texts_of(made.summary), texts_of(made.notes));
}

}  // namespace

void bind_folders(nb::module_& module) {
  module.def("verify", &verify, "sidecar"_a.none(), "data_dir"_a.none());
  module.def("gallery", &gallery, "batch"_a.none(), "output"_a.none(), "robot"_a.none(),
             "options"_a, "data_dir"_a.none());
  module.def("add_robot", &add_robot, "model"_a.none(), "name"_a.none(), "output"_a.none(),
             "options"_a, "force"_a);
}

}  // namespace retarget::python
