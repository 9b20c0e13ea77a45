// pickle and copy for Clip, Robot, Plan and Motion.

#include <nanobind/nanobind.h>

#include <new>
#include <string>
#include <string_view>

#include "bindings.h"
#include "handles.h"
#include "raise.h"
#include "stored.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

std::string_view view_of(const nb::bytes& bytes) {
  return {static_cast<const char*>(bytes.data()), bytes.size()};
}

// Adds the methods to the class. Its objects are immutable, so that a copy is the object itself.
template <typename Handle>
void add_pickle(nb::module_& module, const char* name, Result<Handle> (*read)(std::string_view)) {
  auto type = nb::borrow<nb::class_<Handle>>(module.attr(name));
  type.def("__getstate__",
           [](const Handle& self) {
             const std::string bytes =
                 without_gil([&] { return Result<std::string>(stored(self)); });
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def("__setstate__",
           [read](Handle& self, const nb::bytes& state) {
             new (&self) Handle(without_gil([&] { return read(view_of(state)); }));
           })
      .def("__copy__", [](nb::handle_t<Handle> self) { return nb::borrow(self); })
      .def(
          "__deepcopy__", [](nb::handle_t<Handle> self, nb::handle) { return nb::borrow(self); },
          "memo"_a);
}

}  // namespace

void bind_pickle(nb::module_& module) {
  add_pickle<ClipHandle>(module, "Clip", &clip_of_bytes);
  add_pickle<RobotHandle>(module, "Robot", &robot_of_bytes);
  add_pickle<PlanHandle>(module, "Plan", &plan_of_bytes);
  add_pickle<MotionHandle>(module, "Motion", &motion_of_bytes);
}

}  // namespace retarget::python
