#pragma once

#include <nanobind/nanobind.h>

// Parts of the module, one per file.

namespace retarget::python {

void bind_options(nanobind::module_& module);
void bind_clip(nanobind::module_& module);
void bind_robot(nanobind::module_& module);
void bind_motion(nanobind::module_& module);
void bind_solve(nanobind::module_& module);
void bind_evaluate(nanobind::module_& module);
void bind_simulate(nanobind::module_& module);
void bind_certify(nanobind::module_& module);
void bind_edit(nanobind::module_& module);
void bind_batch(nanobind::module_& module);
void bind_frame_retargeter(nanobind::module_& module);
void bind_motion_arrays(nanobind::module_& module);
void bind_scene(nanobind::module_& module);
void bind_pages(nanobind::module_& module);
void bind_files(nanobind::module_& module);
void bind_folders(nanobind::module_& module);
void bind_live(nanobind::module_& module);
void bind_serve(nanobind::module_& module);
/// After the classes that can be pickled.
void bind_pickle(nanobind::module_& module);

}  // namespace retarget::python
