#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Category of an error. Each kind has its own exit code in the command-line tool.
enum class ErrorKind {
  kRun,          ///< The run failed: an output could not be written, a gate was missed.
  kUsage,        ///< The call is wrong: contradictory options, an output folder that does not
                 ///< exist.
  kInput,        ///< The motion file is bad: malformed, without frames, lacking a mapped bone.
  kConfig,       ///< A retargeting configuration, profile, model or robot name is bad.
  kInterrupted,  ///< The user stopped the run.
};

/// Exit code of a process that ends with an error of this kind. The README lists the codes for
/// users.
[[nodiscard]] constexpr int exit_code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return 2;
    case ErrorKind::kInput:
      return 3;
    case ErrorKind::kConfig:
      return 4;
    case ErrorKind::kInterrupted:
      return 130;
    case ErrorKind::kRun:
      break;
  }
  return 1;
}

/// A location in a file.
struct Location {
  std::string file;        ///< File name given by the user; may be empty.
  std::size_t line = 0;    ///< 1-based; 0: unknown.
  std::size_t column = 0;  ///< 1-based, in bytes; 0: unknown.
};

/// An error as a value: the problem, its location, and a remedy.
///
/// The library neither prints nor exits; `describe` gives the readable text. Options named in the
/// texts are marked; to show such a text elsewhere, pass it through spell_options.
struct Error {
  ErrorKind kind = ErrorKind::kRun;
  Location location;
  std::string message;               ///< Expected and found values, one sentence, no full stop.
  std::vector<std::string> details;  ///< If there are several errors: one sentence each.
  std::string hint;                  ///< Suggested remedy; may be empty.
};

/// A problem that did not stop the work, at a location in a file.
struct Warning {
  std::size_t line = 0;    ///< 1-based; 0: unknown.
  std::size_t column = 0;  ///< 1-based, in bytes; 0: unknown.
  std::string message;
};

/// A value, or the error that prevented it. No exception crosses a module boundary.
template <typename T>
using Result = tl::expected<T, Error>;

/// Shorthand for `return failure(...)` in functions that return a Result.
using Failure = tl::unexpected<Error>;

[[nodiscard]] inline Failure failure(Error error) {
  return Failure(std::move(error));
}

[[nodiscard]] Failure input_failure(std::string file, std::string message, std::string hint = {});
[[nodiscard]] Failure config_failure(std::string file, std::string message, std::string hint = {});
[[nodiscard]] Failure usage_failure(std::string message, std::string hint = {});
[[nodiscard]] Failure run_failure(std::string file, std::string message, std::string hint = {});

/// The error of a run that the user stopped.
[[nodiscard]] Failure interrupted_failure();

/// Spelling of an option in a text, given its name in the schema (`source-fps`).
using OptionSpelling = std::string (*)(std::string_view name);

/// `source_fps`, as a member of options or a keyword.
[[nodiscard]] std::string option_as_field(std::string_view name);
/// `--source-fps`
[[nodiscard]] std::string option_as_flag(std::string_view name);

/// A text of the library with its option marks spelled out.
[[nodiscard]] std::string spell_options(std::string_view text,
                                        OptionSpelling spelling = option_as_field);

/// The message of an error with its details, options not spelled out.
[[nodiscard]] std::string full_message(const Error& error);

/// `file:line:column: message`, details and hint as those of describe(); no final newline. Unknown
/// parts are omitted.
[[nodiscard]] std::string located_message(const Error& error,
                                          OptionSpelling spelling = option_as_field);

/// `file:line:column: error: message`, details as `\n  - detail` and, where there is one,
/// `\n  hint: ...`; no final newline. Unknown parts are omitted.
[[nodiscard]] std::string describe(const Error& error, OptionSpelling spelling = option_as_field);

/// `file:line:column: warning: message`, no final newline.
[[nodiscard]] std::string describe(const Warning& warning, std::string_view file,
                                   OptionSpelling spelling = option_as_field);

}  // namespace retarget
