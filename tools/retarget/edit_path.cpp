// `retarget edit path`: the way over the ground.

#include <cmath>
#include <numbers>
#include <utility>

#include "base/file.h"
#include "edit/path_picture.h"
#include "edit/rethread.h"
#include "edits.h"

namespace retarget::cli {
namespace {

bool has_new_path(const PathCliOptions& options) {
  return !options.to.empty() || options.scale != 1.0 || options.rotate_deg != 0.0;
}

Result<void> check_options(const EditOptions& options) {
  const PathCliOptions& path = options.path;
  if (options.output.empty() && path.fit.empty() && path.svg.empty()) {
    return usage_failure("edit path needs --fit, --svg or -o",
                         "--fit and --svg show the motion's own path; -o follows another");
  }
  if (!options.output.empty() && !has_new_path(path)) {
    return usage_failure("edit path -o needs a path to follow", "--to, --scale or --rotate");
  }
  if (options.output.empty() && has_new_path(path) && path.svg.empty()) {
    return usage_failure("edit path needs -o for the motion on its new path");
  }
  constexpr double kSmallestRadius = 0.01;
  if (!(std::abs(path.radius) >= kSmallestRadius)) {
    return usage_failure("--radius must be 0.01 m at least");
  }
  return {};
}

// the path to follow, where the motion's own begins
Result<GroundPath> new_path(const PathCliOptions& options, const GroundPath& own) {
  const GroundPose start = own.at(0.0);
  const auto shaped = [&]() -> Result<GroundPath> {
    if (options.to.empty()) return own;
    if (options.to == "line") return line_path(start, own.length());
    if (options.to == "circle") return circle_path(start, options.radius, own.length());
    if (options.to == "figure8") return figure8_path(start, own.length());
    return load_path(options.to);
  }();
  if (!shaped) return failure(shaped.error());
  const GroundPath& path = *shaped;
  const double angle = options.rotate_deg / 180.0 * std::numbers::pi;
  return path.scaled(options.scale).moved(turn_about(path.control_points().front(), angle));
}

std::string path_text(const GroundPath& path) {
  return number_text(path.length(), 3) + " m in " +
         count_text(static_cast<long>(path.segment_count()), "segment");
}

RethreadOptions rethread_options(const PathCliOptions& options) {
  RethreadOptions result;
  result.fit.tolerance = options.tolerance;
  result.keep = options.keep == "speed"    ? PathKeep::kSpeed
                : options.keep == "stride" ? PathKeep::kStride
                                           : PathKeep::kTime;
  return result;
}

std::vector<Warning> doubts_about(const Rethreaded& moved) {
  const PlantSummary& feet = moved.feet;
  std::vector<Warning> doubts = as_warnings(moved.check.faults);
  constexpr double kNotedMiss = 0.005, kNotedCorrection = 0.15;
  if (feet.largest_miss > kNotedMiss) {
    doubts.push_back({0, 0,
                      "a leg is too short for its place by " +
                          number_text(100.0 * feet.largest_miss, 1) + " cm"});
  }
  if (feet.largest_correction > kNotedCorrection) {
    doubts.push_back({0, 0,
                      "a foot had to be moved by " +
                          number_text(100.0 * feet.largest_correction, 0) +
                          " cm to stand: the new path turns or hurries where these steps do not; "
                          "a gentler path or --keep stride suits them better"});
  }
  return doubts;
}

// a motion on a new path, drawn with the old one
Result<Clip> follow(const EditSource& source, const EditOptions& options, const PathMotion& own,
                    Console& console) {
  const auto path = new_path(options.path, own.path);
  if (!path) return failure(path.error());
  auto moved = rethread(source.clip, source.mapping(), *path, rethread_options(options.path),
                        source_name(options.source));
  if (!moved) return failure(moved.error());
  console.line("new path", path_text(*path) + ", " + number_text(moved->clip.duration(), 3) + " s");
  console.line("feet", planted_text(moved->feet));
  console.warn(doubts_about(*moved), source_name(options.source));
  if (!options.path.svg.empty()) {
    const HumanClip before = to_human(source.clip, source.mapping());
    const HumanClip after = to_human(moved->clip, source.mapping());
    const auto written =
        write_file(options.path.svg, draw_paths({{&before, &own.path}, {&after, &*path}}));
    if (!written) return failure(written.error());
  }
  return std::move(moved->clip);
}

}  // namespace

Result<std::optional<Clip>> edit_path(const EditOptions& options, Console& console) {
  if (auto good = check_options(options); !good) return failure(good.error());
  const auto source = read_edit_source(options, console);
  if (!source) return failure(source.error());
  const HumanClip human = to_human(source->clip, source->mapping());
  const auto own = fit_path(human, rethread_options(options.path).fit, source_name(options.source));
  if (!own) return failure(own.error());
  console.line("path", path_text(own->path) + ", within " +
                           number_text(100.0 * own->largest_distance, 1) +
                           " cm of the hips' track");
  if (!options.path.fit.empty()) {
    const auto written = write_file(options.path.fit, format_path(own->path));
    if (!written) return failure(written.error());
  }
  if (has_new_path(options.path)) {
    auto clip = follow(*source, options, *own, console);
    if (!clip) return failure(clip.error());
    return options.output.empty() ? std::optional<Clip>() : std::optional<Clip>(std::move(*clip));
  }
  if (!options.path.svg.empty()) {
    const auto written = write_file(options.path.svg, draw_paths({{&human, &own->path}}));
    if (!written) return failure(written.error());
  }
  return std::optional<Clip>();
}

}  // namespace retarget::cli
