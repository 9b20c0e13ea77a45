#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Whose fault an error is. Each kind has one exit code in the command line tool.
enum class ErrorKind {
  kRun,          ///< The run failed: an output could not be written, a gate was missed.
  kUsage,        ///< The call is wrong: contradicting options, an output folder that is not there.
  kInput,        ///< The motion file is bad: malformed, without frames, lacking a mapped bone.
  kConfig,       ///< A mapping, profile, model or robot name is bad.
  kInterrupted,  ///< The user stopped the run.
};

/// A place in a file.
struct Location {
  std::string file;        ///< As the user named it; may be empty.
  std::size_t line = 0;    ///< 1-based; 0 when no line is meant.
  std::size_t column = 0;  ///< 1-based, in bytes; 0 when no column is meant.
};

/// An error as a value: what is wrong, where, and what the user can do.
///
/// The library neither prints nor exits; `describe` gives the one readable text. Options that its
/// texts name are marked: shown elsewhere, they go through spell_options.
struct Error {
  ErrorKind kind = ErrorKind::kRun;
  Location location;
  std::string message;  ///< What was expected and what was found, one sentence, no full stop.
  std::vector<std::string> details;  ///< Where there are several faults: each, in a sentence.
  std::string hint;                  ///< What to do about it; may be empty.
};

/// Something odd that did not stop the work, at a place in a file.
struct Warning {
  std::size_t line = 0;    ///< 1-based; 0 when no line is meant.
  std::size_t column = 0;  ///< 1-based, in bytes; 0 when no column is meant.
  std::string message;
};

/// A value or the error that stood in its way. No exception crosses a module boundary.
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

/// How an option is written for those who read a text, by its name in the schema (`source-fps`).
using OptionSpelling = std::string (*)(std::string_view name);

/// `source_fps`, as a member of options or a keyword.
[[nodiscard]] std::string option_as_field(std::string_view name);
/// `--source-fps`
[[nodiscard]] std::string option_as_flag(std::string_view name);

/// A text of the library with the options in it spelled out.
[[nodiscard]] std::string spell_options(std::string_view text,
                                        OptionSpelling spelling = option_as_field);

/// The message of an error with its details, options not spelled out.
[[nodiscard]] std::string full_message(const Error& error);

/// `file:line:column: error: message`, details as `\n  - detail` and, where there is one,
/// `\n  hint: ...`; no final newline. Parts that are not known are left out.
[[nodiscard]] std::string describe(const Error& error, OptionSpelling spelling = option_as_field);

/// `file:line:column: warning: message`, no final newline.
[[nodiscard]] std::string describe(const Warning& warning, std::string_view file,
                                   OptionSpelling spelling = option_as_field);

}  // namespace retarget
