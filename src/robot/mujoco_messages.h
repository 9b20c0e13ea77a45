#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// Takes what MuJoCo would print, log into a file or end the process with, while it lives.
///
/// MuJoCo's handlers belong to the whole process: one guard at a time (the caller holds a lock).
/// Messages of other threads, whose MuJoCo work is not ours, are dropped meanwhile.
class MessageGuard {
 public:
  MessageGuard();
  ~MessageGuard();
  MessageGuard(const MessageGuard&) = delete;
  MessageGuard& operator=(const MessageGuard&) = delete;

  [[nodiscard]] const std::vector<std::string>& errors() const { return errors_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::vector<std::string> errors_;
  std::vector<std::string> warnings_;
  void (*old_error_)(const char*);
  void (*old_warning_)(const char*);
};

/// A message of MuJoCo's as one line.
[[nodiscard]] std::string one_line(const std::string& text);

/// What MuJoCo says about a model, in its words but as our error: the place becomes the error's
/// place, and what the parser calls by number is said in words.
[[nodiscard]] Failure model_failure(const std::string& path, const std::string& text);

}  // namespace retarget
