#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/memory_clip.h"
#include "edit/seam.h"
#include "retarget/clip.h"
#include "retarget/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/human.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

class Joiner {
 public:
  Joiner(const Clip& a, const Clip& b, const Calibration& calibration, const BodyMover& mover,
         const ConcatenateOptions& options)
      : a_(a),
        b_(b),
        calibration_(calibration),
        mover_(mover),
        options_(options),
        motion_a_(a, calibration),
        human_b_(to_human(b, calibration)) {
    const auto floor_a = floor_height(a, calibration), floor_b = floor_height(b, calibration);
    if (!floor_a || !floor_b) return;
    const double lift = *floor_a - *floor_b;
    if (std::abs(lift) <= options.same_floor) return;
    lift_ = lift;
    raised_ = b;
    mover.move_all(*raised_, {Eigen::Quaterniond::Identity(), {0.0, 0.0, lift}});
  }

  // Widens the search band until a good seam is found. Keeps the narrowest band if there is no good
  // seam.
  Result<Concatenation> run() {
    SeamOptions seam = options_.seam;
    RETARGET_TRY_ASSIGN(auto first, join(seam));
    if (continues_motion(motion_a_.human, human_b_)) {
      auto whole = put_together(first.map);
      if (whole.check.faults.empty()) return whole;
    }
    if (first.check.faults.empty() || seam.search_all) return first;
    const double longest = std::max(a_.duration(), b_.duration());
    while (seam.band > 0.0 && seam.band < std::min(longest, options_.widest_band)) {
      seam.band = std::min(2.0 * seam.band, options_.widest_band);
      auto wider = join(seam);
      // The wider search would exceed the size limit.
      if (!wider) break;
      if (wider->check.faults.empty()) return wider;
      first.band = seam.band;
    }
    return first;
  }

 private:
  // Appends b to a without changes.
  [[nodiscard]] Concatenation put_together(SeamMap map) const {
    Clip whole = without_file_size(a_);
    whole.resize(a_.frame_count() + b_.frame_count());
    for (int frame = 0; frame < b_.frame_count(); ++frame) {
      copy_frame(b_, frame, whole, a_.frame_count() + frame);
    }
    Seam seam;
    seam.a_frame = a_.frame_count();
    seam.overlap = 0;
    SeamRegion region;
    region.begin = region.end = region.b_shift = seam.a_frame;
    SeamCheck check = check_motion(motion_a_.human, human_b_, to_human(whole, calibration_), region,
                                   options_.limits);
    return {{std::move(whole)}, seam, std::move(map), 0.0, 0.0, std::move(check)};
  }

  Result<Concatenation> join(const SeamOptions& options) {
    const Clip* on_floor = &b_;
    // A search range that cannot grow is a limit.
    const bool any_overlap = options_.widest_band > options_.seam.band;
    RETARGET_TRY_ASSIGN(auto search, find_seam(motion_a_.human, human_b_, options, any_overlap));
    if (raised_) {
      RETARGET_TRY_ASSIGN(auto other, find_seam(motion_a_.human, to_human(*raised_, calibration_),
                                                options, any_overlap));
      if (other.seams[0].distance < search.seams[0].distance) {
        search = std::move(other);
        on_floor = &*raised_;
      }
    }
    // Take the first seam without faults, otherwise the best one.
    std::optional<Concatenation> best;
    for (const Seam& seam : search.seams) {
      RETARGET_TRY_ASSIGN(auto joined, join_at(seam, *on_floor));
      const bool is_shared = search.first_is_shared && &seam == search.seams.data();
      if (!is_shared) joined.doubts = doubt_dropped_frames(seam);
      const bool good = joined.check.faults.empty();
      if (!best || good) best = std::move(joined);
      if (good) break;
    }
    best->map = std::move(search.map);
    best->lift = on_floor == &b_ ? 0.0 : lift_;
    best->band = options.band;
    return std::move(*best);
  }

  // Doubts a seam that drops most of a clip.
  [[nodiscard]] std::vector<Warning> doubt_dropped_frames(const Seam& seam) const {
    std::vector<Warning> doubts;
    const auto add = [&](int dropped, int frames, const char* clip) {
      if (2 * dropped <= frames) return;
      doubts.push_back({0, 0,
                        fmt::format("the seam drops {} of the {} of the {} clip", dropped,
                                    count_text(frames, "frame"), clip)});
    };
    add(a_.frame_count() - seam.a_frame - seam.overlap, a_.frame_count(), "first");
    add(seam.b_frame, b_.frame_count(), "second");
    return doubts;
  }

  Result<Concatenation> join_at(const Seam& seam, Clip moved) {
    mover_.move_all(moved, seam.a_from_b.in_space());
    RETARGET_TRY_ASSIGN(auto joined, join_clips(motion_a_, HumanMotion(moved, calibration_), seam,
                                                calibration_, mover_, options_));
    return Concatenation{{std::move(joined.clip)}, seam, {}, 0.0, 0.0, std::move(joined.check)};
  }

  const Clip& a_;
  const Clip& b_;
  const Calibration& calibration_;
  const BodyMover& mover_;
  const ConcatenateOptions& options_;
  const HumanMotion motion_a_;
  const HumanClip human_b_;
  double lift_ = 0.0;           // Height of a's floor above b's, metres.
  std::optional<Clip> raised_;  // Clip b raised to a's floor, if it moves.
};

void describe_seam(Concatenation& joined, const FrameRate& rate) {
  const Seam& seam = joined.seam;
  auto& notes = joined.notes;
  if (seam.overlap == 0) {
    notes = {{"seam", "the second clip continues where the first ends: joined unchanged"}};
    return;
  }
  const auto frame_text = [&rate](int frame) {
    return fmt::format("frame {} ({} s)", frame, number_text(rate.time_of(frame), 3));
  };
  const std::string lifted = joined.lift == 0.0
                                 ? std::string()
                                 : fmt::format(", and {} by {} m to the first clip's floor",
                                               joined.lift < 0.0 ? "lowered" : "raised",
                                               number_text(std::abs(joined.lift), 3));
  const SeamCheck& check = joined.check;
  notes = {
      {"seam", fmt::format("{} meets {}, {} in common", frame_text(seam.a_frame),
                           frame_text(seam.b_frame), count_text(seam.overlap, "frame"))},
      {"", fmt::format("the second clip is rotated by {} degrees about its hips at the seam and "
                       "moved by {}, {} m{}",
                       number_text(seam.a_from_b.heading * 180.0 / std::numbers::pi, 2),
                       number_text(seam.way.x(), 3), number_text(seam.way.y(), 3), lifted)},
      {"", fmt::format("{} cm apart, {} feet on the floor", number_text(100.0 * seam.distance, 2),
                       seam.same_support ? "the same" : "other")},
      {"", fmt::format("largest speed relative to the clips: {} {} m/s (in the clips {}); planted "
                       "feet slip at {} m/s",
                       check.fastest_bone, number_text(check.largest_speed, 2),
                       number_text(check.usual_speed, 2), number_text(check.slip, 3))}};
  if (check.jolted_bone.empty()) return;
  notes.push_back(
      {"", fmt::format("largest acceleration relative to the clips: {} {} m/s2 (in the clips {})",
                       check.jolted_bone, number_text(check.largest_acceleration, 1),
                       number_text(check.usual_acceleration, 1))});
}

// Frame pairs of which seams are possible.
std::string searched_range(const Concatenation& joined, bool everywhere, double shortest) {
  if (everywhere) return "anywhere that enough of both clips remains";
  const std::string within = "within " + number_text(joined.band, 1) + " s";
  // The search tries all pairs of a range in which no seam drops most of the shorter clip.
  const bool all_pairs = 2.0 * joined.band <= kMostLost * shortest;
  return all_pairs ? within : within + " where enough of both clips remains";
}

void judge_seam(Concatenation& joined, bool searched_all, const Clip& a, const Clip& b,
                const std::string& a_name, const std::string& b_name) {
  const std::vector<std::string>& faults = joined.check.faults;
  for (Warning& fault : as_warnings(faults)) joined.doubts.push_back(std::move(fault));
  if (faults.empty()) return;
  // A band as long as the clips has covered everything.
  const auto [shortest, longest] = std::minmax({a.duration(), b.duration()});
  const bool everywhere = searched_all || joined.band >= longest;
  joined.misfit =
      run_failure(b_name,
                  "does not fit " + a_name + " " + searched_range(joined, everywhere, shortest) +
                      ": " + list_names(faults),
                  std::string(RETARGET_OPTION("force") " joins them anyway") +
                      (everywhere ? "" : "; " RETARGET_OPTION("search") " all searches everywhere"))
          .value();
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

bool same_body(const Subject& a, const Subject& b) {
  return same_skeleton(a.clip.skeleton(), b.clip.skeleton()) &&
         a.calibration.human_from_source.isApprox(b.calibration.human_from_source, 1e-9) &&
         std::abs(a.calibration.metres_per_unit - b.calibration.metres_per_unit) <=
             1e-9 * a.calibration.metres_per_unit;
}

}  // namespace

Result<Edited> like_first(const Subject& next, const Subject& first) {
  Edited result{next.clip};
  if (!same_body(next, first)) {
    Transferred moved = transfer(next, first);
    result = {std::move(moved.clip),
              {{"", "transferred to the first clip's skeleton through the T-pose"}}};
    result.notes.insert(result.notes.end(), moved.notes.begin(), moved.notes.end());
  }
  const FrameRate from = next.clip.rate(), to = first.clip.rate();
  if (same_rate(from, to)) return result;
  result.notes.push_back({"", "from " + to_text(from) + " to " + to_text(to) + " fps"});
  RETARGET_TRY_ASSIGN(result.clip, change_timing(std::move(result.clip), {.rate = to}));
  return result;
}

Result<void> ConcatenateOptions::search(std::string_view text) {
  if (text.empty()) return {};
  if (text == "all") {
    seam.search_all = true;
    seam.cost_of_second = 0.001;
    return {};
  }
  constexpr double kMaxSeconds = 1e5;
  const auto seconds = number_from_text(text);
  if (!seconds || !(*seconds >= 0.0 && *seconds <= kMaxSeconds)) {
    return usage_failure(
        RETARGET_OPTION("search") " must be seconds from 0 to 100000 or `all`, found \"" +
        std::string(text) + "\"");
  }
  seam.band = widest_band = *seconds;
  return {};
}

Result<Concatenation> concatenate(const Clip& a, const Clip& b, const Calibration& calibration,
                                  const ConcatenateOptions& options, const std::string& a_name,
                                  const std::string& b_name) {
  if (!same_rate(a.rate(), b.rate())) {
    return input_failure(b_name, "has " + to_text(b.rate()) + " frames per second, " + a_name +
                                     " " + to_text(a.rate()));
  }
  if (a.skeleton().names() != b.skeleton().names() ||
      a.skeleton().translated_count() != b.skeleton().translated_count()) {
    return input_failure(b_name, "has a different skeleton than " + a_name);
  }
  auto mover = BodyMover::of(a, calibration, &b);
  if (!mover) {
    mover.error().location.file = a_name;
    return failure(std::move(mover).error());
  }
  for (const auto& [clip, name] : {std::pair(&a, &a_name), std::pair(&b, &b_name)}) {
    if (clip->frame_count() > 0) continue;
    return input_failure(*name, "the clip has no frames to join");
  }
  RETARGET_TRY_ASSIGN(auto joined, Joiner(a, b, calibration, *mover, options).run());
  describe_seam(joined, a.rate());
  judge_seam(joined, options.seam.search_all, a, b, a_name, b_name);
  return joined;
}

namespace {

ClipFeet feet_of(const Clip& clip, const Calibration& calibration, const HumanClip& human) {
  ClipFeet feet;
  feet.contacts = find_contacts(human);
  const auto legs = find_legs(clip.skeleton(), calibration);
  for (int foot = 0; foot < 2; ++foot) {
    if (legs[foot]) feet.ankles[foot] = ankle_poses(clip, calibration, *legs[foot]);
  }
  return feet;
}

}  // namespace

HumanMotion::HumanMotion(const Clip& of, const Calibration& calibration)
    : clip(of), human(to_human(of, calibration)), feet(feet_of(of, calibration, human)) {}

Result<JoinedClips> join_clips(const HumanMotion& a, const HumanMotion& b, const Seam& seam,
                               const Calibration& calibration, const BodyMover& mover,
                               const ConcatenateOptions& options) {
  const FrameRate& rate = a.clip.rate();
  const SeamRegion region = seam_region(seam, options, rate, b.clip.frame_count());
  Clip joined = blend_clips(a.clip, b.clip, region, calibration, mover);
  const ClipFeet blended = feet_of(joined, calibration, to_human(joined, calibration));
  const auto plants = joined_plants(a.feet, b.feet, blended, region, rate);
  RETARGET_TRY(plant_feet(joined, calibration, plants, options.plant));

  const HumanMotion result(joined, calibration);
  SeamCheck check = check_motion(a.human, b.human, result.human, region, options.limits);
  check_feet(check, a.feet, b.feet, result.feet, plants, region, rate);
  find_faults(check, seam, options);
  return JoinedClips{std::move(joined), std::move(check)};
}

}  // namespace retarget
