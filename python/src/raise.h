#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>  // A type caster: without it, texts become None.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gil.h"
#include "retarget/error.h"

// Conversion of the library's values and errors to Python.

namespace retarget::python {

namespace nb = nanobind;

/// Converts human-readable text; bytes that are not UTF-8 appear as `\xff`.
[[nodiscard]] nb::str text_of(std::string_view bytes);
[[nodiscard]] nb::list texts_of(const std::vector<std::string>& texts);
/// Converts a name that is data; bytes_of_name() returns the same bytes.
[[nodiscard]] nb::str name_of(std::string_view bytes);
[[nodiscard]] nb::list names_of(const std::vector<std::string>& names);
/// Converts a file name as os.fsdecode() does.
[[nodiscard]] nb::str path_of(std::string_view bytes);
/// Returns the bytes of a name. Errors (kUsage): not a text, or a text that cannot be encoded.
[[nodiscard]] std::string bytes_of_name(nb::handle name, const char* what);
/// Returns the UTF-8 of any Python text, for messages.
[[nodiscard]] std::string shown_text(nb::handle text);
/// Clears the current Python exception; rethrows it if it is not an Exception, such as
/// KeyboardInterrupt.
void forget_exception();
/// Returns the bytes of a path-like object or a text, as os.fsencode() returns them. Errors
/// (kUsage): another type, or a null byte.
[[nodiscard]] std::string bytes_of_path(nb::handle path, const char* what);
/// The same for a data folder; None: empty.
[[nodiscard]] std::string bytes_of_folder(nb::handle folder);

/// Raises the Python exception for an error (retarget/_errors.py). The GIL must be held.
[[noreturn]] void raise(const Error& error);

/// Raises ArgumentTypeError, which is both a UsageError and a TypeError.
[[noreturn]] void raise_type_error(const std::string& message);

/// Issues warnings through Python's `warnings`.
void warn(const std::vector<Warning>& warnings, std::string_view file);
void warn(const std::vector<std::string>& warnings, std::string_view file);

/// Returns the value of a result, or raises its error.
template <typename T>
T value_of(Result<T>&& result) {
  if (!result) raise(result.error());
  return *std::move(result);
}
inline void value_of(Result<void>&& result) {
  if (!result) raise(result.error());
}

/// Calls a library function while other Python threads run; returns its value or raises its error.
template <typename Function>
auto without_gil(const Function& function) {
  auto result = [&] {
    const ReleasedGil released;
    return function();
  }();
  return value_of(std::move(result));
}

}  // namespace retarget::python
