// `retarget edit concat`: several clips as one.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/file.h"
#include "base/suggest.h"
#include "edit/concatenate.h"
#include "edits.h"
#include "motion/resample.h"

namespace retarget::cli {
namespace {

Result<ConcatenateOptions> concatenate_options(const SeamCliOptions& options) {
  ConcatenateOptions result;
  result.seam.window = options.window_s;
  result.threshold = 0.01 * options.threshold_cm;
  result.blend = options.blend == "inertial" ? SeamBlend::kInertial : SeamBlend::kCrossfade;
  result.seam.search_all = options.search == "all";
  if (result.seam.search_all) {
    // who searches everywhere would rather have a good seam than all of both clips
    constexpr double kCostOfSecond = 0.001;
    result.seam.cost_of_second = kCostOfSecond;
    return result;
  }
  if (options.search.empty()) return result;
  const std::string& text = options.search;
  double seconds = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size() || !(seconds >= 0.0) ||
      !(seconds <= 1e5)) {
    return usage_failure("--search must be seconds from 0 to 100000 or `all`, found \"" + text +
                         "\"");
  }
  result.seam.band = result.widest_band = seconds;
  return result;
}

Result<EditSource> read_one(const EditOptions& options, const std::string& file, bool first,
                            Console& console) {
  EditOptions one = options;
  one.source.file = file;
  // a mapping file is of the first clip's joints
  if (!first) one.human.map.clear();
  one.human.write_map = first ? options.human.write_map : std::string();
  console.line("motion", file);
  return read_edit_source(one, console);
}

bool same_skeleton(const Skeleton& a, const Skeleton& b) {
  if (a.joint_count() != b.joint_count()) return false;
  for (int i = 0; i < a.joint_count(); ++i) {
    const Joint &one = a.joint(i), &other = b.joint(i);
    if (one.name != other.name || one.parent != other.parent || one.channels != other.channels ||
        (i > 0 && (one.offset - other.offset).norm() > 1e-6 * one.offset.norm())) {
      return false;
    }
  }
  return true;
}

bool same_body(const EditSource& a, const EditSource& b) {
  return same_skeleton(a.clip.skeleton(), b.clip.skeleton()) &&
         a.mapping().human_from_source.isApprox(b.mapping().human_from_source, 1e-9) &&
         std::abs(a.mapping().metres_per_unit - b.mapping().metres_per_unit) <=
             1e-9 * a.mapping().metres_per_unit;
}

// the clip on the first one's skeleton and at its rate
Result<Clip> like_first(EditSource source, const EditSource& first, const std::string& file,
                        Console& console) {
  const bool same = same_body(source, first);
  Clip clip = std::move(source.clip);
  if (!same) {
    console.line("", "brought to the first clip's skeleton through the T-pose");
    clip = to_skeleton(clip, source.mapping(),
                       {first.clip.shared_skeleton(), first.human.map, first.mapping()}, file,
                       console);
  }
  if (same_rate(clip.rate(), first.clip.rate())) return clip;
  console.line("", "from " + to_text(clip.rate()) + " to " + to_text(first.clip.rate()) + " fps");
  auto resampled = resample(std::move(clip), first.clip.rate());
  if (!resampled) resampled.error().location.file = file;
  return resampled;
}

void print_seam(const Concatenation& joined, const FrameRate& rate, Console& console) {
  const Seam& seam = joined.seam;
  if (seam.overlap == 0) {
    console.line("seam", "the second goes on where the first ends: put together as they are");
    return;
  }
  console.line("seam", "frame " + std::to_string(seam.a_frame) + " (" +
                           number_text(rate.time_of(seam.a_frame), 3) + " s) meets frame " +
                           std::to_string(seam.b_frame) + " (" +
                           number_text(rate.time_of(seam.b_frame), 3) + " s), " +
                           count_text(seam.overlap, "frame") + " in common");
  const GroundPose& move = seam.a_from_b;
  console.line(
      "", "the second is turned by " + number_text(move.heading * 180.0 / std::numbers::pi, 2) +
              " degrees about its hips at the seam and moved by " + number_text(seam.way.x(), 3) +
              ", " + number_text(seam.way.y(), 3) + " m" +
              (joined.lift == 0.0
                   ? std::string()
                   : (joined.lift < 0.0 ? ", and lowered by " : ", and raised by ") +
                         number_text(std::abs(joined.lift), 3) + " m to the first's floor"));
  console.line("",
               number_text(100.0 * seam.distance, 2) + " cm apart, " +
                   (seam.same_support ? "the same feet on the floor" : "other feet on the floor"));
  console.line("", "fastest for what it does: " + joined.check.fastest_bone + " " +
                       number_text(joined.check.largest_speed, 2) + " m/s (in the clips " +
                       number_text(joined.check.usual_speed, 2) + "); planted feet slip at " +
                       number_text(joined.check.slip, 3) + " m/s");
  if (joined.check.jolted_bone.empty()) return;
  console.line("", "largest acceleration for what it does: " + joined.check.jolted_bone + " " +
                       number_text(joined.check.largest_acceleration, 1) + " m/s2 (in the clips " +
                       number_text(joined.check.usual_acceleration, 1) + ")");
}

// a failure for one that is not good
Result<void> judge_seam(const Concatenation& joined, const std::string& before,
                        const std::string& file, double longest, const SeamCliOptions& options,
                        Console& console) {
  const std::vector<std::string>& faults = joined.check.faults;
  if (faults.empty()) return {};
  if (options.force) {
    console.warn(as_warnings(faults), file);
    return {};
  }
  // a band as long as the clips leaves nothing to look at
  const bool everywhere = options.search == "all" || joined.band >= longest;
  const std::string where =
      everywhere ? "anywhere" : "within " + number_text(joined.band, 1) + " s";
  return run_failure(file, "does not fit to " + before + " " + where + ": " + list_names(faults),
                     std::string("--force joins them all the same") +
                         (everywhere ? "" : "; --search all looks everywhere"));
}

}  // namespace

Result<Clip> edit_concat(const EditOptions& options, Console& console) {
  const auto how = concatenate_options(options.concat);
  if (!how) return failure(how.error());
  const std::vector<std::string>& files = options.concat.files;
  if (files.size() < 2) return usage_failure("edit concat joins two files or more");
  if (std::ranges::count(files, "-") > 1) {
    return usage_failure("standard input is one clip, `-` stands for two");
  }
  auto first = read_one(options, files[0], true, console);
  if (!first) return failure(first.error());
  for (std::size_t i = 1; i < files.size(); ++i) {
    auto source = read_one(options, files[i], false, console);
    if (!source) return failure(source.error());
    const auto next = like_first(std::move(*source), *first, files[i], console);
    if (!next) return failure(next.error());
    const std::string before = i == 1 ? files[0] : "what goes before";
    auto joined = concatenate(first->clip, *next, first->mapping(), *how, before, files[i]);
    if (!joined) return failure(joined.error());
    if (i == 1 && !options.concat.matrix.empty()) {
      const auto written = write_file(options.concat.matrix, format_pgm(joined->map));
      if (!written) return failure(written.error());
    }
    print_seam(*joined, first->clip.rate(), console);
    const double longest = std::max(first->clip.duration(), next->duration());
    const auto good = judge_seam(*joined, before, files[i], longest, options.concat, console);
    if (!good) return failure(good.error());
    first->clip = std::move(joined->clip);
  }
  console.line("result", count_text(first->clip.frame_count(), "frame"));
  return std::move(first->clip);
}

}  // namespace retarget::cli
