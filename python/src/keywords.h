#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "retarget/option_table.h"

// Python keyword arguments are option names with underscores; the tables are in src/app/options.

namespace retarget::python {

namespace nb = nanobind;

/// Sets the options that keywords name; None leaves an option unchanged. Raises
/// ArgumentTypeError, a UsageError and TypeError, for an unknown name (with the nearest one) and for
/// values of a wrong type, and UsageError for values out of range.
void apply_keywords(const OptionTable& table, const nb::dict& keywords);

/// Returns the keyword of an option, such as `lead_in`; `from_` if the name is a Python keyword.
[[nodiscard]] std::string keyword_of(const Option& row);

/// Returns the rows of a table for signatures, stubs and docs: a list of dictionaries with `name`,
/// `type` (a Python annotation), `default`, `choices`, `help`.
[[nodiscard]] nb::list described(const OptionTable& table);

}  // namespace retarget::python
