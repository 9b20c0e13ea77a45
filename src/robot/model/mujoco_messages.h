#pragma once

#include <tinyxml2.h>
#include <mutex>
#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// Held while MuJoCo reads, compiles or writes a model: it reports through process-wide handlers and
/// keeps the last XML in a global.
[[nodiscard]] std::mutex& mujoco_mutex();

/// While alive, captures the messages that MuJoCo would print, log to a file or end the process
/// with.
///
/// MuJoCo's handlers are process-wide: use one guard at a time (the caller holds a lock). Messages
/// of other threads are dropped meanwhile.
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

/// Joins a multi-line MuJoCo message into one line.
[[nodiscard]] std::string one_line(const std::string& text);

/// Removes the kinds of errors in front of a MuJoCo message about a model.
void remove_prefixes(std::string& line);

/// Rejects a URDF in which two links or two joints have the same name: MuJoCo does not name the
/// links, and accepts the joints.
[[nodiscard]] Result<void> check_urdf_names(const tinyxml2::XMLElement& robot,
                                            const std::string& file);

/// Converts a MuJoCo message about a model to an error: extracts its line and column and replaces
/// parser error codes with text.
[[nodiscard]] Failure model_failure(const std::string& path, const std::string& text);

}  // namespace retarget
