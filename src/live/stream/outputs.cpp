#include "live/stream/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "live/stream/output_formats.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {

Result<void> Outputs::add(const StreamAddress& to, const FrameOutputContext& context) {
  RETARGET_TRY_ASSIGN(auto output, open_frame_output(to, context));
  all_.push_back(std::move(output));
  return {};
}

void Outputs::take(const RobotFrame& frame) {
  ++frames_;
  for (const auto& output : all_) output->take(frame);
}

bool Outputs::are_closed() const {
  return std::ranges::all_of(all_,
                             [](const auto& output) { return output->statistics().is_closed; });
}

Result<void> Outputs::finish() {
  for (const auto& output : all_) output->finish();
  for (const OutputStatistics& each : statistics()) {
    if (!each.is_incomplete) continue;
    return run_failure(each.name,
                       fmt::format("{} could not be written: {}",
                                   count_text(each.dropped, "robot frame"), each.last_error));
  }
  return {};
}

std::vector<OutputStatistics> Outputs::statistics() const {
  std::vector<OutputStatistics> all;
  all.reserve(all_.size());
  for (const auto& output : all_) all.push_back(output->statistics());
  return all;
}

}  // namespace retarget
