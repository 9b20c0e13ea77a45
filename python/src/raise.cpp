#include "raise.h"

namespace retarget::python {
namespace {

const char* kind_name(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return "usage";
    case ErrorKind::kInput:
      return "input";
    case ErrorKind::kConfig:
      return "config";
    case ErrorKind::kInterrupted:
      return "interrupted";
    default:
      return "run";
  }
}

nb::str decoded(std::string_view bytes, const char* errors) {
  PyObject* text =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), errors);
  if (text == nullptr) throw nb::python_error();
  return nb::steal<nb::str>(text);
}

// Returns the bytes of a Python bytes object; raises UsageError if the encoding before has failed.
std::string bytes_in(const nb::object& encoded, const char* what) {
  char* bytes = nullptr;
  Py_ssize_t size = 0;
  if (!encoded.is_valid() || PyBytes_AsStringAndSize(encoded.ptr(), &bytes, &size) != 0) {
    forget_exception();
    raise(usage_failure(std::string(what) + ": invalid characters in the string").value());
  }
  return {bytes, static_cast<std::size_t>(size)};
}

nb::object errors_attribute(const char* name) {
  return nb::module_::import_("retarget._errors").attr(name);
}

}  // namespace

nb::str text_of(std::string_view bytes) {
  return decoded(bytes, "backslashreplace");
}

nb::list texts_of(const std::vector<std::string>& texts) {
  nb::list list;
  for (const std::string& text : texts) list.append(text_of(text));
  return list;
}

nb::str name_of(std::string_view bytes) {
  return decoded(bytes, "surrogateescape");
}

nb::list names_of(const std::vector<std::string>& names) {
  nb::list list;
  for (const std::string& name : names) list.append(name_of(name));
  return list;
}

nb::str path_of(std::string_view bytes) {
  PyObject* path =
      PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<Py_ssize_t>(bytes.size()));
  if (path == nullptr) throw nb::python_error();
  return nb::steal<nb::str>(path);
}

std::string bytes_of_name(nb::handle name, const char* what) {
  if (!PyUnicode_Check(name.ptr())) {
    raise(usage_failure(std::string(what) + ": expected a string").value());
  }
  return bytes_in(nb::steal(PyUnicode_AsEncodedString(name.ptr(), "utf-8", "surrogateescape")),
                  what);
}

std::string shown_text(nb::handle text) {
  return bytes_in(nb::steal(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "backslashreplace")),
                  "text");
}

void forget_exception() {
  if (PyErr_Occurred() == nullptr) return;
  if (PyErr_ExceptionMatches(PyExc_Exception) == 0) throw nb::python_error();
  PyErr_Clear();
}

std::string bytes_of_path(nb::handle path, const char* what) {
  nb::object plain = nb::steal(PyOS_FSPath(path.ptr()));
  if (!plain.is_valid()) {
    forget_exception();
    raise_type_error(std::string(what) + ": expected a path, found " +
                     shown_text(path.type().attr("__name__")));
  }
  if (PyUnicode_Check(plain.ptr())) plain = nb::steal(PyUnicode_EncodeFSDefault(plain.ptr()));
  std::string bytes = bytes_in(plain, what);
  if (bytes.find('\0') != std::string::npos) {
    raise(usage_failure(std::string(what) + ": a path with a null byte").value());
  }
  return bytes;
}

std::string bytes_of_folder(nb::handle folder) {
  if (folder.is_none()) return {};
  std::string path = bytes_of_path(folder, "data_dir");
  if (path.empty())
    raise(usage_failure("data_dir: expected a path, found an empty string").value());
  return path;
}

void raise_type_error(const std::string& message) {
  const nb::object exception =
      errors_attribute("make_error")("type", text_of(message), "", "", 0, 0, nb::list(), "");
  PyErr_SetObject(exception.type().ptr(), exception.ptr());
  throw nb::python_error();
}

void raise(const Error& error) {
  const nb::object make = errors_attribute("make_error");
  const auto& [file, line, column] = error.location;
  // The exception name already identifies an error.
  constexpr std::string_view kWithoutPlace = "error: ";
  const std::string whole = describe(error);
  std::string_view text = whole;
  if (text.starts_with(kWithoutPlace)) text.remove_prefix(kWithoutPlace.size());
  nb::list details;
  for (const std::string& detail : error.details) details.append(text_of(spell_options(detail)));
  const nb::object exception =
      make(kind_name(error.kind), text_of(text), text_of(spell_options(error.message)),
           path_of(file), line, column, details, text_of(spell_options(error.hint)));
  PyErr_SetObject(exception.type().ptr(), exception.ptr());
  throw nb::python_error();
}

void warn(const std::vector<Warning>& warnings, std::string_view file) {
  if (warnings.empty()) return;
  const nb::object tell = errors_attribute("warn");
  for (const Warning& each : warnings) tell(text_of(describe(each, file)));
}

void warn(const std::vector<std::string>& warnings, std::string_view file) {
  std::vector<Warning> placed;
  for (const std::string& each : warnings) placed.push_back({0, 0, each});
  warn(placed, file);
}

}  // namespace retarget::python
