#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "retarget/version.h"

NB_MODULE(_retarget, module) {
  module.doc() = "The engine of retarget: use the package `retarget`.";
  module.attr("__version__") = retarget::version_number();
  module.def("version_text", &retarget::version_text,
             "Version, commit, compiler and libraries, one a line.");
}
