#include "keywords.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "raise.h"
#include "retarget/text.h"

namespace retarget::python {
namespace {

bool is_word(nb::handle object, const char* word) {
  return PyUnicode_Check(object.ptr()) && PyUnicode_CompareWithASCIIString(object.ptr(), word) == 0;
}

// Returns a short description of any object, for messages.
std::string found_text(nb::handle object) {
  constexpr std::size_t kLongest = 60;
  const bool is_plain =
      nb::isinstance<nb::str>(object) || PyFloat_Check(object.ptr()) || PyLong_Check(object.ptr());
  const nb::object ascii = nb::steal(is_plain ? PyObject_ASCII(object.ptr()) : nullptr);
  if (!ascii.is_valid()) {
    // Not plain, or an integer with more digits than Python prints.
    forget_exception();
    return "a value of type " + shown_text(object.type().attr("__name__"));
  }
  std::string text = shown_text(ascii);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

bool is_flag(nb::handle object) {
  // numpy's flag type: `bool` since numpy 2, `bool_` before.
  if (PyBool_Check(object.ptr())) return true;
  const nb::handle type = object.type();
  return is_word(nb::getattr(type, "__module__", nb::none()), "numpy") &&
         (is_word(type.attr("__name__"), "bool_") || is_word(type.attr("__name__"), "bool"));
}

std::optional<std::int64_t> whole_number(nb::handle object) {
  if (is_flag(object) || !PyIndex_Check(object.ptr())) return std::nullopt;
  const nb::object index = nb::steal(PyNumber_Index(object.ptr()));
  int overflow = 0;
  const std::int64_t value =
      index.is_valid() ? PyLong_AsLongLongAndOverflow(index.ptr(), &overflow) : 0;
  forget_exception();
  if (!index.is_valid() || overflow != 0) return std::nullopt;
  return value;
}

std::optional<double> number(nb::handle object) {
  if (is_flag(object) || nb::isinstance<nb::str>(object) || !PyNumber_Check(object.ptr())) {
    return std::nullopt;
  }
  // The conversion below warns or fails for arrays of one number, so reject arrays first.
  const nb::object axes = nb::getattr(object, "ndim", nb::none());
  int count = 0;
  if (!axes.is_none() && (!nb::try_cast(axes, count) || count != 0)) return std::nullopt;
  const double value = PyFloat_AsDouble(object.ptr());
  if (PyErr_Occurred() == nullptr) return value;
  forget_exception();
  return std::nullopt;
}

std::optional<std::string> text(nb::handle object) {
  if (const auto count = whole_number(object)) return std::to_string(*count);
  if (const auto value = number(object)) return fmt::format("{}", *value);
  const bool is_path = nb::isinstance<nb::str>(object) || nb::isinstance<nb::bytes>(object) ||
                       nb::hasattr(object, "__fspath__");
  if (!is_path) return std::nullopt;
  return bytes_of_path(object, "option");
}

std::optional<std::vector<std::string>> texts(nb::handle object) {
  std::vector<std::string> words;
  if (nb::isinstance<nb::str>(object)) {
    const std::string all = bytes_of_path(object, "option");
    std::string_view rest = all;
    while (true) {
      const std::size_t comma = rest.find(',');
      words.emplace_back(rest.substr(0, comma));
      if (comma == std::string_view::npos) return words;
      rest.remove_prefix(comma + 1);
    }
  }
  if (nb::hasattr(object, "__fspath__")) return std::vector{bytes_of_path(object, "option")};
  if (PySequence_Check(object.ptr()) == 0 || nb::isinstance<nb::bytes>(object)) return std::nullopt;
  for (nb::handle each : object) {
    if (!nb::isinstance<nb::str>(each) && !nb::hasattr(each, "__fspath__")) return std::nullopt;
    words.push_back(bytes_of_path(each, "option"));
  }
  return words;
}

std::optional<OptionValue> value_of_kind(const OptionValue& kind, nb::handle object) {
  const auto wrapped = [](auto&& value) {
    return value ? std::optional<OptionValue>(*std::forward<decltype(value)>(value)) : std::nullopt;
  };
  if (std::holds_alternative<bool>(kind)) {
    const int truth = is_flag(object) ? PyObject_IsTrue(object.ptr()) : -1;
    forget_exception();
    return truth < 0 ? std::nullopt : std::optional<OptionValue>(truth == 1);
  }
  if (std::holds_alternative<std::int64_t>(kind)) return wrapped(whole_number(object));
  if (std::holds_alternative<double>(kind)) return wrapped(number(object));
  if (std::holds_alternative<std::string>(kind)) return wrapped(text(object));
  return wrapped(texts(object));
}

bool has_empty_text(const OptionValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return text->empty();
  const auto* texts = std::get_if<std::vector<std::string>>(&value);
  return texts != nullptr && std::ranges::any_of(*texts, &std::string::empty);
}

[[noreturn]] void refuse_keyword(const std::string& message) {
  raise(usage_failure(message).value());
}

// Raises an error with the keyword as prefix: `fps: expected ...`.
[[noreturn]] void refuse_keyword(const Option& row, Error error) {
  error.message = keyword_of(row) + ": " + error.message;
  raise(error);
}

// Whether a text option also accepts numbers: a rate, a factor, a unit.
bool takes_numbers(const Option& row) {
  const std::string& type = row.info.type;
  return std::holds_alternative<std::string>(row.get()) &&
         (type == "N|source" || type == "N" || type == "S|auto" || type == "UNIT");
}

void apply(const Option& row, nb::handle object) {
  const OptionValue kind = row.get();
  const auto value = value_of_kind(kind, object);
  if (!value) {
    const std::string wanted = takes_numbers(row) ? "a number or a string" : expectation(row);
    raise_type_error(
        fmt::format("{}: expected {}, found {}", keyword_of(row), wanted, found_text(object)));
  }
  // As on the command line: an unset variable must not look like an omitted option.
  if (has_empty_text(*value)) {
    refuse_keyword(
        fmt::format("{}: expected {}, found an empty string", keyword_of(row), expectation(row)));
  }
  if (const auto checked = check_option(row, *value); !checked)
    refuse_keyword(row, checked.error());
  if (auto set = row.set(*value); !set) refuse_keyword(row, set.error());
}

std::string annotation(const Option& row) {
  const OptionValue kind = row.get();
  std::string choices;
  for (const std::string& choice : row.choices) {
    choices += (choices.empty() ? "" : ", ") + fmt::format("'{}'", choice);
  }
  if (!choices.empty()) choices = "Literal[" + choices + "]";
  if (std::holds_alternative<bool>(kind)) return "bool";
  if (std::holds_alternative<std::int64_t>(kind)) return "int";
  if (std::holds_alternative<double>(kind)) return "float";
  if (row.is_list()) return "str | Sequence[" + (choices.empty() ? "str" : choices) + "]";
  if (!choices.empty()) return choices;
  const std::string& type = row.info.type;
  if (type.find("FILE") != std::string::npos || type == "DIR") return "StrPath";
  return takes_numbers(row) ? "str | float" : "str";
}

}  // namespace

void apply_keywords(const OptionTable& table, const nb::dict& keywords) {
  std::vector<std::string> names;
  for (const Option& row : table) names.push_back(keyword_of(row));
  for (const auto& [key, value] : keywords) {
    const std::string name = nb::cast<std::string>(text_of(bytes_of_path(key, "option")));
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      // Accept the command line's spelling in the suggestion.
      std::string meant = name;
      std::ranges::replace(meant, '-', '_');
      raise_type_error(fmt::format("unknown option \"{}\"{}", name, did_you_mean(meant, names)));
    }
    if (!value.is_none()) apply(table[static_cast<std::size_t>(found - names.begin())], value);
  }
}

std::string keyword_of(const Option& row) {
  std::string name = option_as_field(row.name);
  // These names are Python keywords.
  if (name == "for" || name == "from" || name == "with") name += "_";
  return name;
}

nb::list described(const OptionTable& table) {
  nb::list rows;
  for (const Option& row : table) {
    nb::dict entry;
    entry["name"] = keyword_of(row);
    entry["type"] = annotation(row);
    entry["default"] = text_of(to_text(row.get()));
    entry["choices"] = texts_of(row.choices);
    entry["help"] = text_of(spell_options(row.info.help));
    rows.append(entry);
  }
  return rows;
}

}  // namespace retarget::python
