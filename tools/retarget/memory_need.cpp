#include "memory_need.h"

#include <algorithm>
#include <utility>

#include "base/number_text.h"
#include "motion/resample.h"
#include "outputs.h"
#include "read_source.h"

namespace retarget::cli {
namespace {

// A frame of the output needs about so many bytes until the motion is written and measured. A few
// bytes of text must not stand for much more: no motion has fewer than a fortieth of this a frame.
constexpr std::uint64_t kBytesOfFrame = 5000;
constexpr std::uint64_t kMostOfFile = 200;
// of one that is read and written again; and what a pickle of it takes besides
constexpr std::uint64_t kBytesOfReadFrame = 1250;
constexpr std::uint64_t kBytesOfPickledFrame = 2250;
constexpr std::uint64_t kFreeBytes = 256'000'000;
// tracking files have all bodies' poses and velocities, at a rate of their own
constexpr std::uint64_t kBytesOfTrackingFrame = 8500;
constexpr std::uint64_t kMostOfTrackedFile = 1200;

// whether a file of one of two formats is asked for
bool makes(const OutputOptions& options, MotionFormat one, MotionFormat other) {
  const auto items = plan_outputs(options);
  return items && std::ranges::any_of(*items, [&](const OutputItem& item) {
           return item.format == one || item.format == other;
         });
}

std::uint64_t bytes_of_frame(const MotionNeed& need, const OutputOptions& options) {
  const std::uint64_t made = need.is_solved ? kBytesOfFrame : kBytesOfReadFrame;
  const bool pickled = makes(options, MotionFormat::kPklGmr, MotionFormat::kPklPbhc);
  return made + (pickled ? kBytesOfPickledFrame : 0);
}

}  // namespace

Result<void> check_need(const MotionNeed& need, const RunOptions& options) {
  std::uint64_t needed = static_cast<std::uint64_t>(need.frames) * bytes_of_frame(need, options);
  std::uint64_t of_file = kMostOfFile * need.file_bytes;
  if (makes(options, MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic)) {
    const auto count = static_cast<int>(std::min<std::int64_t>(need.frames, 1 << 30));
    const std::int64_t samples = resampled_frame_count(count, need.rate, {options.npz_fps, 1});
    needed += static_cast<std::uint64_t>(samples) * kBytesOfTrackingFrame;
    of_file = kMostOfTrackedFile * need.file_bytes;
  }
  const std::uint64_t by_file = std::max(kFreeBytes, of_file);
  const std::uint64_t given = memory_bound(options.source);
  const std::uint64_t most = given == 0 ? by_file : std::min(given, by_file);
  if (needed <= most) return {};
  const auto megabytes = [](std::uint64_t bytes) {
    return number_text(static_cast<double>(bytes) / 1e6, 1) + " MB";
  };
  std::string hint = most == given ? "--memory gives more"
                                   : "is the source's frame rate the true one? --source-fps gives "
                                     "another";
  if (need.is_solved) {
    hint += most == given ? "; or take parts of it with --frames" : "; --frames takes a part";
  }
  return input_failure(need.file,
                       std::to_string(need.frames) + " frames of output need about " +
                           megabytes(needed) + " of memory, at most " + megabytes(most) +
                           " are taken" + (most == given ? "" : " for a file of this size"),
                       std::move(hint));
}

}  // namespace retarget::cli
