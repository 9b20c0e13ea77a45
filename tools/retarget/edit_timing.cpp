// `retarget edit` resample, trim, mirror, ground, turn, move, loop.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "base/suggest.h"
#include "edit/ground_pose.h"
#include "edit/make_loop.h"
#include "edit/mirror.h"
#include "edit/put_on_floor.h"
#include "edits.h"
#include "motion/resample.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

// metres and degrees: more than any motion, less than any slip
constexpr double kFarthest = 1e6;

std::optional<double> number_from_text(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && std::abs(value) <= kFarthest ? std::optional<double>(value) : std::nullopt;
}

std::string clip_text(const Clip& clip) {
  return count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) + " fps, " +
         number_text(clip.duration(), 3) + " s";
}

Result<Clip> edit_resample(const EditOptions& options, Console& console) {
  const TimingOptions& timing = options.timing;
  if (timing.fps.empty() && !(timing.speed > 0.0)) {
    return usage_failure("edit resample needs --fps or --speed");
  }
  const auto rate = output_rate(timing.fps.empty() ? "source" : timing.fps);
  if (!rate) return failure(rate.error());
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  Result<Clip> clip = choose_part(std::move(motion->clip), options.part);
  if (!clip) return clip;
  ResampleOptions how;
  how.interpolation =
      timing.interpolation == "linear" ? Interpolation::kLinear : Interpolation::kCubic;
  how.antialias = !timing.no_antialias;
  console.line("source", clip_text(*clip));
  // one step for both: the source taken as a faster clip
  const FrameRate own = clip->rate();
  if (timing.speed > 0.0) clip->set_rate(frame_rate_from_fps(own.fps() * timing.speed));
  clip = resample(std::move(*clip), rate->value_or(own), how);
  if (!clip) clip.error().location.file = source_name(options.source);
  return clip;
}

Result<Clip> edit_trim(const EditOptions& options, Console& console) {
  const PartOptions& part = options.part;
  if (part.frames.empty() && part.start_s < 0.0 && part.end_s < 0.0) {
    return usage_failure("edit trim needs --start, --end or --frames");
  }
  auto motion = read_source(options.source, false, console);
  if (!motion) return failure(motion.error());
  return choose_part(std::move(motion->clip), part);
}

Result<Clip> edit_ground(EditSource source, const EditOptions& options, Console& console) {
  const std::string name = source_name(options.source);
  const auto floor = options.floor.empty()
                         ? floor_height(source.clip, source.mapping(), name)
                         : Result<double>(number_from_text(options.floor).value_or(0.0));
  if (!floor) return failure(floor.error());
  console.line("floor", "was at " + number_text(*floor, 4) + " m");
  return put_on_floor(std::move(source.clip), source.mapping(), *floor, name);
}

Result<Clip> edit_place(EditSource source, const EditOptions& options) {
  const auto mover = BodyMover::of(source.clip, source.mapping(), source_name(options.source));
  if (!mover) return failure(mover.error());
  GroundPose over_ground;
  if (options.edit == Edit::kTurn) {
    if (source.clip.frame_count() > 0) {
      const HumanClip first = to_human(cut(source.clip, 0, 1), source.mapping());
      const double degrees = number_from_text(options.amount).value_or(0.0);
      over_ground =
          turn_about(hips_over_ground(first).front().position, degrees / 180.0 * std::numbers::pi);
    }
  } else {
    const std::string_view text = options.amount;
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto x = number_from_text(text.substr(0, comma));
    const auto y = number_from_text(text.substr(std::min(comma + 1, text.size())));
    if (!x || !y) {
      return usage_failure("a move is X,Y in metres, up to 1000000, found \"" + options.amount +
                           "\"");
    }
    over_ground.position = {*x, *y};
  }
  mover->move_all(source.clip, over_ground.in_space());
  return std::move(source.clip);
}

Result<Clip> edit_loop(const EditSource& source, const EditOptions& options, Console& console) {
  LoopOptions how;
  how.shortest = options.cycle.shortest_s;
  how.in_place = options.cycle.in_place;
  how.times = options.cycle.times;
  how.seam.threshold = 0.01 * options.cycle.threshold_cm;
  auto loop = make_loop(source.clip, source.mapping(), how, source_name(options.source));
  if (!loop) return failure(loop.error());
  const GroundPose& advance = loop->advance;
  console.line("cycle", count_text(loop->cycle, "frame") + ", " +
                            number_text(source.clip.rate().time_of(loop->cycle), 3) +
                            " s; its ends were " + number_text(100.0 * loop->distance, 2) +
                            " cm apart");
  console.line("advance", number_text(loop->way.norm(), 3) + " m and " +
                              number_text(advance.heading * 180.0 / std::numbers::pi, 2) +
                              " degrees a cycle" + (how.in_place ? ", taken out" : ""));
  const std::vector<std::string>& faults = loop->check.faults;
  if (!faults.empty() && !options.cycle.force) {
    return run_failure(source_name(options.source),
                       "its end does not fit to its beginning: " + list_names(faults),
                       "--start and --end choose a part that comes back to its first pose; --force "
                       "closes it all the same");
  }
  console.warn(as_warnings(faults), source_name(options.source));
  return std::move(loop->clip);
}

Result<Clip> edit_body(const EditOptions& options, Console& console) {
  auto source = read_edit_source(options, console);
  if (!source) return failure(source.error());
  switch (options.edit) {
    case Edit::kMirror:
      return mirror(source->clip, source->mapping(), source_name(options.source));
    case Edit::kGround:
      return edit_ground(std::move(*source), options, console);
    case Edit::kLoop:
      return edit_loop(*source, options, console);
    default:
      return edit_place(std::move(*source), options);
  }
}

}  // namespace

Result<Clip> edit_time_or_place(const EditOptions& options, Console& console) {
  auto clip = options.edit == Edit::kResample ? edit_resample(options, console)
              : options.edit == Edit::kTrim   ? edit_trim(options, console)
                                              : edit_body(options, console);
  if (clip) console.line("result", clip_text(*clip));
  return clip;
}

}  // namespace retarget::cli
