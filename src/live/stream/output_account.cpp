#include "live/stream/output_account.h"

#include <fmt/format.h>

#include "retarget/text.h"

namespace retarget {
namespace {

constexpr int kMaxReports = 10;  // For intermittent outputs; further troubles are only counted.

}  // namespace

void OutputAccount::report_trouble(std::string_view reason) {
  if (statistics_.is_closed) return;
  statistics_.last_error = printable(reason);
  if (std::exchange(in_trouble_, true)) return;
  dropped_before_ = statistics_.dropped;
  if (++reports_ > kMaxReports) return;
  tell_("output",
        fmt::format("{} does not accept robot frames: {}; retrying{}", statistics_.name,
                    statistics_.last_error,
                    reports_ == kMaxReports ? ". Further failures are only counted" : ""));
}

void OutputAccount::report_recovery() {
  if (!std::exchange(in_trouble_, false) || reports_ > kMaxReports) return;
  const auto dropped = statistics_.dropped - dropped_before_;
  tell_("output", fmt::format("{} accepts robot frames again; {} dropped", statistics_.name,
                              count_text(dropped, "frame")));
}

void OutputAccount::close(std::string_view reason) {
  if (std::exchange(statistics_.is_closed, true)) return;
  statistics_.last_error = printable(reason);
  tell_("output", fmt::format("{} no longer accepts robot frames: {}", statistics_.name,
                              statistics_.last_error));
}

}  // namespace retarget
