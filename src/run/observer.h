#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/solve.h"

namespace retarget {

/// Who follows a run: is told what is found and how far it is, and may stop it. Texts have options
/// marked (spell_options).
class Observer {
 public:
  virtual ~Observer() = default;

  /// A line of the summary: a short label, then what there is to say.
  virtual void line(std::string_view /*label*/, std::string_view /*text*/) {}
  void lines(const std::vector<SummaryLine>& lines) {
    for (const auto& [label, text] : lines) line(label, text);
  }
  virtual void warn(const std::vector<Warning>& /*warnings*/, std::string_view /*file*/) {}
  /// An error that does not end the work.
  virtual void fault(const Error& /*error*/) {}
  virtual void progress(const Progress& /*progress*/) {}
  /// How far a longer work is, in words.
  virtual void status(std::string_view /*text*/) {}
  virtual void end_progress() {}
  /// While the result lives, who stops the work is told of it by is_stopped() alone and nothing ends
  /// the process: from when there is something to be cleaned up.
  [[nodiscard]] virtual std::shared_ptr<void> hold_interrupts() { return {}; }
  /// Whether the work should end; asked often, from any thread.
  [[nodiscard]] virtual bool is_stopped() const { return false; }
  /// Whether anybody reads the summary: what costs time for it alone is left out otherwise.
  [[nodiscard]] virtual bool is_read() const { return false; }
};

}  // namespace retarget
