#include "solve/fit/root_reference.h"

#include <algorithm>
#include <cmath>

#include "retarget/filter.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kHorizontalCutoff = 3.5, kVerticalCutoff = 6.0;  // Hz, at half amplitude.
constexpr double kPeriods = 1.5;   // Half width of the filters, in periods of the cutoff.
constexpr double kKaiserBeta = 5;  // Stop-band gain below 0.4 %.

std::vector<double> taps_of(double cutoff, double frame_time) {
  const double cycles = std::min(0.5, cutoff * frame_time);
  const int half_width = std::max(1, static_cast<int>(kPeriods / cycles));
  return design_low_pass(cycles, half_width, kKaiserBeta);
}

// Index of a displacement in a sequence that is mirrored at both ends.
int mirrored(int index, int count) {
  if (index < 0) index = -1 - index;
  if (index >= count) index = 2 * count - 1 - index;
  return std::clamp(index, 0, count - 1);
}

}  // namespace

RootReference::RootReference(const FitModel& model, double frame_time)
    : tasks_(static_cast<int>(model.tasks.size())),
      horizontal_(taps_of(kHorizontalCutoff, frame_time)),
      vertical_(taps_of(kVerticalCutoff, frame_time)) {
  const auto find = [&](const auto& is_wanted) {
    const auto found = std::ranges::find_if(model.tasks, [&](const FitTask& task) {
      return is_wanted(task) && (task.horizontal_weight > 0.0 || task.height_weight > 0.0);
    });
    return found == model.tasks.end() ? -1 : static_cast<int>(found - model.tasks.begin());
  };
  task_ = find([](const FitTask& task) { return task.link == 0; });
  if (task_ < 0) task_ = find([](const FitTask& task) { return task.bone == Bone::kHips; });
}

Vector3d RootReference::step(const FitClip& clip, int frame) const {
  const int count = clip.frame_count - 1;
  const auto target = [&](int t) -> const Vector3d& {
    return clip.targets[at(t) * at(tasks_) + at(task_)].position;
  };
  const int wide = static_cast<int>(horizontal_.size()) / 2;
  const int narrow = static_cast<int>(vertical_.size()) / 2;
  Vector3d sum = Vector3d::Zero();
  for (int d = -wide; d <= wide; ++d) {
    const int t = mirrored(frame + d, count);
    const Vector3d own = target(t + 1) - target(t);
    sum.head<2>() += horizontal_[at(d + wide)] * own.head<2>();
    if (std::abs(d) <= narrow) sum.z() += vertical_[at(d + narrow)] * own.z();
  }
  return sum;
}

}  // namespace retarget
