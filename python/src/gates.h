#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "retarget/report.h"

namespace retarget::python {

/// Reads gates from an argument. None: the defaults of the data folder; a dictionary or a file:
/// changes to them; False: no gates. Raises UsageError or ConfigError.
[[nodiscard]] Gates gates_of(const nanobind::object& given, const std::string& data_folder);

}  // namespace retarget::python
