#pragma once

#include <nanobind/nanobind.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "options/option_table.h"

// Keywords of Python are the options' names with underscores: rows of the tables in src/options.

namespace retarget::python {

namespace nb = nanobind;

/// Sets the options that keywords name; None leaves an option as it is. Raises UsageError for a
/// name that no row has (with the nearest one) and for values of another kind or out of range.
void apply_keywords(const OptionTable& table, const nb::dict& keywords);

/// A table without the rows of these names, or of these alone.
[[nodiscard]] OptionTable without(OptionTable rows, std::initializer_list<std::string_view> names);
[[nodiscard]] OptionTable only(OptionTable rows, std::initializer_list<std::string_view> names);

/// `lead_in`; `from_` where the name is a word of Python's.
[[nodiscard]] std::string keyword_of(const Option& row);

/// The rows of a table for signatures, stubs and docs: a list of dictionaries with `name`, `type`
/// (an annotation of Python), `default`, `choices`, `help`.
[[nodiscard]] nb::list described(const OptionTable& table);

}  // namespace retarget::python
