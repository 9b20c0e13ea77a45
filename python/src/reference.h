#pragma once

#include <nanobind/nanobind.h>

#include "handles.h"

namespace retarget::python {

namespace nb = nanobind;

/// The arrays of a motion's reference for controllers (docs/references.md), by their names in the
/// NPZ file.
[[nodiscard]] nb::dict reference_arrays(const MotionHandle& motion, double rate);

}  // namespace retarget::python
