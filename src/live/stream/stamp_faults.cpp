#include "live/stream/stamp_faults.h"

#include <fmt/format.h>
#include <array>
#include <utility>

#include "retarget/option_name.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr int kSteps = 12;
constexpr double kLongStep = 0.5;  // Seconds; motions have more frames.

// The unit in which a step is at most as long as a frame, and not shorter than any sensor's.
const char* unit_of(double step) {
  constexpr double kMostNumbers = 1.5;  // Per frame; a third of the frames may be lost.
  if (step < 1.0) return nullptr;
  if (step <= kMostNumbers) return "frame numbers";
  struct Unit {
    double per_second;
    const char* name;
  };
  constexpr std::array kUnits = {Unit{1e3, "milliseconds"}, Unit{1e6, "microseconds"},
                                 Unit{1e9, "nanoseconds"}};
  constexpr double kLongestFrame = 0.2;  // seconds
  for (const Unit& unit : kUnits) {
    if (step <= kLongestFrame * unit.per_second) return unit.name;
  }
  return nullptr;
}

}  // namespace

std::string StampFaults::add(double stamp, double arrival) {
  if (!std::exchange(has_begun_, true)) {
    begin(stamp, arrival);
    return {};
  }
  const double step = stamp - last_;
  constant_ += step == 0.0 ? 1 : 0;
  falling_ += step < 0.0 ? 1 : 0;
  long_ += step > kLongStep ? 1 : 0;
  last_ = stamp;
  if (++steps_ < kSteps) return {};
  const std::string found = fault(arrival - arrival_);
  begin(stamp, arrival);
  return found;
}

void StampFaults::begin(double stamp, double arrival) {
  first_ = last_ = stamp;
  arrival_ = arrival;
  steps_ = constant_ = falling_ = long_ = 0;
}

// @param passed  seconds in which these frames arrived.
std::string StampFaults::fault(double passed) const {
  constexpr const char* kRemedy =
      "so the robot does not follow most frames in time: send times in seconds, or "
      "use " RETARGET_OPTION("clock") " arrival";
  if (constant_ == kSteps) {
    return fmt::format("the timestamps stay at {}, {}", number_text(first_, 3), kRemedy);
  }
  if (falling_ == kSteps) return fmt::format("the timestamps fall, {}", kRemedy);
  const double step = (last_ - first_) / kSteps;
  if (long_ < kSteps || passed > 0.5 * (last_ - first_)) return {};
  const char* unit = unit_of(step);
  return fmt::format("the timestamps increase by {} per frame{}, {}", number_text(step, 1),
                     unit == nullptr ? std::string() : fmt::format(" and look like {}", unit),
                     kRemedy);
}

}  // namespace retarget
