#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cstdlib>

#include "bindings.h"
#include "retarget/version.h"

NB_MODULE(_retarget, module) {
  using namespace retarget::python;
  module.doc() = "The engine of retarget; use the package `retarget` instead.";
  module.def("version_number", &retarget::version_number, "`major.minor.patch`");
  module.def("version_text", &retarget::version_text,
             "Version, commit, compiler and libraries, one per line.");
  // Threads that still run at exit hold objects, so only tests look for leaks.
  nb::set_leak_warnings(std::getenv("RETARGET_REPORT_LEAKS") != nullptr);
  bind_options(module);
  bind_clip(module);
  bind_robot(module);
  bind_motion(module);
  bind_solve(module);
  bind_evaluate(module);
  bind_simulate(module);
  bind_certify(module);
  bind_edit(module);
  bind_batch(module);
  bind_frame_retargeter(module);
  bind_motion_arrays(module);
  bind_scene(module);
  bind_pages(module);
  bind_files(module);
  bind_folders(module);
  bind_live(module);
  bind_serve(module);
  bind_pickle(module);
}
