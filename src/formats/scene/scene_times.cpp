#include "formats/scene/scene_times.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/option_name.h"

namespace retarget {
namespace {

constexpr double kDefaultRate = 30.0;
// Limit on the sampling rate relative to the keys: some programs write an arbitrary clock as the
// rate.
constexpr double kMaxRateRatio = 4.01;
// glTF stores key times as floats: tolerance in seconds and relative to the time.
constexpr double kSameTime = 2e-6, kTimeRounding = 1.2e-7;
// An interval ends at a frame if it ends this much before it, in frames.
constexpr double kAtFrame = 1e-3;
// Times of one key in different channels, seconds.
constexpr double kSameKey = 2e-5;

bool is_key_rate(const KeyGrid& grid) {
  return grid.rate.fps() >= kMinKeyRate && grid.rate.fps() <= kMaxKeyRate;
}

// How many frames of the file's own rate lie between two keys' frames; 0 if it does not fit.
int frames_per_key(double own_fps, const KeyGrid& grid) {
  const double ratio = own_fps / grid.fps;
  const bool fits =
      ratio > 0.99 && ratio < kMaxRateRatio && std::abs(ratio - std::round(ratio)) < 1e-3;
  return fits ? static_cast<int>(std::round(ratio)) : 0;
}

}  // namespace

SceneTimes::SceneTimes(const SceneGraph& scene, const SceneMotionChoice& choice,
                       const std::vector<bool>& chain, const std::optional<double>& source_fps)
    : begin_(choice.begin), end_(choice.end) {
  if (choice.take >= 0) keys_ = scene.motion->key_times(choice.take, chain);
  std::erase_if(keys_, [](double time) { return !std::isfinite(time); });
  std::ranges::sort(keys_);
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
  grid_ = grid_of_keys(keys_);
  choose_rate(scene.fps, source_fps);
}

void SceneTimes::choose_rate(double own_fps, const std::optional<double>& source_fps) {
  if (source_fps) {
    is_requested_ = true;
    rate_ = frame_rate_from_fps(*source_fps);
    reason_ = "set by " OPTION("source-fps");
    if (grid_ && same_rate(rate_, grid_->rate)) use_keys(1);
    return;
  }
  const bool is_usable = grid_ && is_key_rate(*grid_);
  const int ratio = is_usable ? frames_per_key(own_fps, *grid_) : 0;
  if (own_fps > 0.0 && (!is_usable || ratio > 0)) {
    rate_ = frame_rate_from_fps(own_fps);
    reason_ = "the file's own rate";
    if (ratio > 0) use_keys(ratio);
    return;
  }
  if (is_usable) {
    rate_ = grid_->rate;
    reason_ = "from the key spacing";
    use_keys(1);
    return;
  }
  rate_ = frame_rate_from_fps(kDefaultRate);
  if (keys_.size() < 3) {
    fallback_ = reason_ = "too few keys to determine a rate";
    return;
  }
  fallback_ = !grid_ ? "its keys are not evenly spaced"
                     : fmt::format("its keys are at {} fps, {} {}", to_text(grid_->rate),
                                   grid_->fps < kMinKeyRate ? "below" : "above",
                                   grid_->fps < kMinKeyRate ? kMinKeyRate : kMaxKeyRate);
  reason_ = fallback_ + ": " OPTION("source-fps") " N sets another rate";
}

void SceneTimes::use_keys(int ratio) {
  const std::vector<double>& times = grid_->times;
  const double same = std::max(kSameKey, kTimeRounding * std::abs(end_));
  const auto first = std::ranges::lower_bound(times, begin_ - same);
  const auto last = std::ranges::upper_bound(times, end_ + same);
  // A take may begin between keys.
  if (first == times.end() || last <= first || *first > begin_ + same) return;
  on_keys_ = true;
  for (std::int64_t& frame : grid_->frames) frame *= ratio;
  grid_->rate = rate_;
  first_ = grid_->frames[static_cast<std::size_t>(first - times.begin())];
  last_ = grid_->frames[static_cast<std::size_t>(last - times.begin()) - 1];
  const double rest = end_ - *(last - 1);
  if (rest > 0.0) last_ += static_cast<std::int64_t>(rest * rate_.fps() + kAtFrame);
}

double SceneTimes::frame_count() const {
  if (on_keys_) return static_cast<double>(last_ - first_) + 1.0;
  return std::floor((end_ - begin_) * rate_.fps() + kAtFrame) + 1.0;
}

double SceneTimes::seconds_of(int frame) const {
  if (on_keys_) return grid_->time_of(first_ + frame);
  const double seconds = std::min(begin_ + rate_.time_of(frame), end_);
  const double tolerance = kSameTime + kTimeRounding * std::abs(seconds);
  const auto key = std::ranges::lower_bound(keys_, seconds - tolerance);
  return key != keys_.end() && *key <= seconds + tolerance ? *key : seconds;
}

Result<void> SceneTimes::check(const std::string& file_name) const {
  if (is_requested_ || keys_.size() < 3) return {};
  const double length = keys_.back() - keys_.front();
  const double rate = static_cast<double>(keys_.size() - 1) / length;
  if (rate <= 1.001 * kMaxKeyRate) return {};
  return input_failure(
      file_name,
      fmt::format("its {} key times lie within {:.3g} s, which is {:.6g} per second; at most {} "
                  "are read as frames",
                  keys_.size(), length, rate, kMaxKeyRate),
      "check the unit of its times: they are seconds; " OPTION(
          "source-fps") " N samples it N times per second");
}

std::size_t SceneTimes::keys_inside() const {
  const auto distinct = distinct_times(keys_);
  return static_cast<std::size_t>(std::ranges::count_if(distinct, [this](double time) {
    return time >= begin_ - kSameKey && time <= end_ + kSameKey;
  }));
}

std::string SceneTimes::outside_text() const {
  if (keys_.empty()) return {};
  const double before = std::max(0.0, begin_ - keys_.front());
  const double after = std::max(0.0, keys_.back() - end_);
  // Less than a frame is rounding.
  if ((before + after) * rate_.fps() < 1.0 - kAtFrame) return {};
  return fmt::format(
      "the take lasts from {:.6g} s to {:.6g} s, as the file states, but its keys from {:.6g} s to "
      "{:.6g} s: {:.6g} s of keys are not read; export the take with the whole range to read them",
      begin_, end_, keys_.front(), keys_.back(), before + after);
}

std::vector<Warning> SceneTimes::warnings() const {
  std::vector<Warning> warnings;
  if (std::string text = outside_text(); !text.empty()) warnings.push_back({0, 0, std::move(text)});
  const auto keys = static_cast<double>(keys_inside());
  const bool is_lossy = !fallback_.empty() ? frame_count() != keys : frame_count() < keys;
  if (is_requested_ || on_keys_ || !is_lossy || keys_.empty()) return warnings;
  warnings.push_back(
      {0, 0,
       fmt::format("{}: {} key times became {} frames at {} fps; " OPTION(
                       "source-fps") " N sets another rate",
                   fallback_.empty() ? "the keys are denser than the frames of the file's own rate"
                                     : fallback_,
                   keys, frame_count(), to_text(rate_))});
  return warnings;
}

std::string SceneTimes::far_key_hint() const {
  double gap = 0.0, before = 0.0, after = 0.0;
  for (std::size_t i = 1; i < keys_.size(); ++i) {
    if (keys_[i] - keys_[i - 1] <= gap) continue;
    before = keys_[i - 1];
    after = keys_[i];
    gap = after - before;
  }
  if (keys_.size() <= 2 || gap <= 0.5 * (end_ - begin_)) return {};
  return fmt::format(
      "there are no keys between {:.6g} s and {:.6g} s: remove stray keys before the export, or "
      "export only the required frame range",
      before, after);
}

}  // namespace retarget
