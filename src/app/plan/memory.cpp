#include "retarget/check_options.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/option_name.h"
#include "retarget/machine.h"
#include "retarget/motion_io.h"
#include "retarget/resample.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Four objects share the memory: a motion's text, its clip, the resampled clip, and the result.
constexpr std::uint64_t kShares = 4;

// Approximate bytes per output frame until the motion is written and measured, and the most memory
// per byte of the source, so that a tiny file cannot request a huge clip. Motion files have at
// least a fortieth of kBytesOfFrame per frame.
constexpr std::uint64_t kBytesOfFrame = 5000;
constexpr std::uint64_t kMaxOfFile = 200;
// Bytes per frame of a motion that is only converted, and additional bytes for a pickle.
constexpr std::uint64_t kBytesOfReadFrame = 1250;
constexpr std::uint64_t kBytesOfPickledFrame = 2250;
// Poses of all bodies and of the human's joints.
constexpr std::uint64_t kBytesOfShownFrame = 4000;
constexpr std::uint64_t kFreeBytes = 256'000'000;
// Tracking files contain poses and velocities of all bodies, at their own rate.
constexpr std::uint64_t kBytesOfTrackingFrame = 8500;
constexpr std::uint64_t kMaxOfTrackedFile = 1200;

}  // namespace

std::uint64_t memory_bound(double memory_gb) {
  if (memory_gb > 0.0) return static_cast<std::uint64_t>(memory_gb * 1e9);
  return usable_memory() / 4 * 3;
}

std::size_t memory_share(double memory_gb) {
  const std::uint64_t bound = memory_bound(memory_gb);
  return bound == 0 ? std::numeric_limits<std::size_t>::max() : bound / kShares;
}

Result<void> check_need(const MotionNeed& need, double memory_gb, const SaveOptions& save) {
  const std::uint64_t made = need.is_solved ? kBytesOfFrame : kBytesOfReadFrame;
  const auto makes = [&](MotionFormat format) {
    return std::ranges::find(save.formats, format) != save.formats.end();
  };
  const bool pickled = std::ranges::any_of(
      save.formats, [](MotionFormat format) { return format_ending(format) == ".pkl"; });
  std::uint64_t needed =
      static_cast<std::uint64_t>(need.frames) * (made + (pickled ? kBytesOfPickledFrame : 0));
  std::uint64_t of_file = kMaxOfFile * need.file_bytes;
  if (std::ranges::any_of(save.formats, format_has_own_rate)) {
    const auto count = static_cast<int>(std::min<std::int64_t>(need.frames, 1 << 30));
    const std::int64_t samples = resampled_frame_count(count, need.rate, {save.npz_fps, 1});
    // If other formats have another rate, the motion is solved twice.
    const bool again = need.is_solved && !std::ranges::all_of(save.formats, format_has_own_rate);
    needed += static_cast<std::uint64_t>(samples) * (kBytesOfTrackingFrame + (again ? made : 0));
    of_file = kMaxOfTrackedFile * need.file_bytes;
  }
  if (makes(MotionFormat::kGlb)) {
    needed += static_cast<std::uint64_t>(need.frames) * kBytesOfShownFrame;
  }
  if (makes(MotionFormat::kProtoMotions)) {
    needed += static_cast<std::uint64_t>(need.frames) * kBytesOfTrackingFrame;
  }
  const std::uint64_t by_file = std::max(kFreeBytes, of_file);
  const std::uint64_t given = memory_bound(memory_gb);
  const std::uint64_t max = given == 0 ? by_file : std::min(given, by_file);
  if (needed <= max) return {};
  const auto megabytes = [](std::uint64_t bytes) {
    return number_text(static_cast<double>(bytes) / 1e6, 1) + " MB";
  };
  std::string hint =
      max == given ? OPTION("memory") " allows more"
                   : "is the source's frame rate correct? " OPTION("source-fps") " overrides it";
  if (need.is_solved) {
    hint += max == given ? "; or select a part with " OPTION("frames")
                         : "; " OPTION("frames") " selects a part";
  }
  return input_failure(need.file,
                       std::to_string(need.frames) + " frames of output need about " +
                           megabytes(needed) + " of memory, at most " + megabytes(max) +
                           " are allowed" + (max == given ? "" : " for a source of this size"),
                       std::move(hint));
}

}  // namespace retarget
