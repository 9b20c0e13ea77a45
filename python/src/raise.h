#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>  // a caster: without it texts are none

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"

// Values and errors of the library, on their way to Python.

namespace retarget::python {

namespace nb = nanobind;

/// A text of the library for people; bytes that are not UTF-8 are shown as `\xff`.
[[nodiscard]] nb::str text_of(std::string_view bytes);
[[nodiscard]] nb::list texts_of(const std::vector<std::string>& texts);
/// A name that is data: what bytes_of_name() takes for the same bytes.
[[nodiscard]] nb::str name_of(std::string_view bytes);
[[nodiscard]] nb::list names_of(const std::vector<std::string>& names);
/// The name of a file, as os.fsdecode() gives it.
[[nodiscard]] nb::str path_of(std::string_view bytes);
/// The bytes of a name. Errors (kUsage): no text, or one that has none.
[[nodiscard]] std::string bytes_of_name(nb::handle name, const char* what);
/// UTF-8 of any text of Python's, for messages.
[[nodiscard]] std::string shown_text(nb::handle text);
/// Forgets what was raised; but what is no Exception, such as KeyboardInterrupt, goes on.
void forget_exception();
/// The bytes of a path-like object or a text, as os.fsencode() gives them. Errors (kUsage): neither
/// of them, or with a null byte.
[[nodiscard]] std::string bytes_of_path(nb::handle path, const char* what);
/// The same of a folder with data; None: empty.
[[nodiscard]] std::string bytes_of_folder(nb::handle folder);

/// Raises the Python exception of an error (retarget/_errors.py). The GIL must be held.
[[noreturn]] void raise(const Error& error);

/// Warns of what did not stop the work, by Python's `warnings`.
void warn(const std::vector<Warning>& warnings, std::string_view file);
void warn(const std::vector<std::string>& warnings, std::string_view file);

/// The value of a result; raises its error.
template <typename T>
T value_of(Result<T>&& result) {
  if (!result) raise(result.error());
  return *std::move(result);
}
inline void value_of(Result<void>&& result) {
  if (!result) raise(result.error());
}

/// What a function of the library gives, while other threads of Python run.
template <typename Function>
auto without_gil(const Function& function) {
  auto result = [&] {
    const nb::gil_scoped_release released;
    return function();
  }();
  return value_of(std::move(result));
}

}  // namespace retarget::python
