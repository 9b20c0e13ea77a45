#include "edit/concatenate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "edit/goes_on.h"
#include "edit/join_clips.h"
#include "edit/put_on_floor.h"
#include "edit/seam_check.h"

namespace retarget {
namespace {

class Joiner {
 public:
  Joiner(const Clip& a, const Clip& b, const HumanMapping& mapping, const BodyMover& mover,
         const ConcatenateOptions& options, const std::string& a_file, const std::string& b_file)
      : a_(a),
        b_(b),
        mapping_(mapping),
        mover_(mover),
        options_(options),
        a_file_(a_file),
        b_file_(b_file),
        motion_a_(a, mapping),
        human_b_(to_human(b, mapping)) {
    const auto floor_a = floor_height(a, mapping, a_file),
               floor_b = floor_height(b, mapping, b_file);
    if (!floor_a || !floor_b) return;
    const double lift = *floor_a - *floor_b;
    if (std::abs(lift) <= options.same_floor) return;
    lift_ = lift;
    raised_ = b;
    mover.move_all(*raised_, {Eigen::Quaterniond::Identity(), {0.0, 0.0, lift}});
  }

  // as wide as it takes for a good seam; without one as narrow as can be
  Result<Concatenation> run() {
    SeamOptions seam = options_.seam;
    auto first = join(seam);
    if (!first) return first;
    if (goes_on(motion_a_.human, human_b_)) {
      auto whole = put_together(first->map);
      if (whole.check.faults.empty()) return whole;
    }
    if (first->check.faults.empty() || seam.search_all) return first;
    const double longest = std::max(a_.duration(), b_.duration());
    while (seam.band > 0.0 && seam.band < std::min(longest, options_.widest_band)) {
      seam.band = std::min(2.0 * seam.band, options_.widest_band);
      auto wider = join(seam);
      // too much to search
      if (!wider) break;
      if (wider->check.faults.empty()) return wider;
      first->band = seam.band;
    }
    return first;
  }

 private:
  // one after the other, as they lie
  [[nodiscard]] Concatenation put_together(SeamMap map) const {
    Clip whole = a_;
    whole.resize(a_.frame_count() + b_.frame_count());
    for (int frame = 0; frame < b_.frame_count(); ++frame) {
      copy_frame(b_, frame, whole, a_.frame_count() + frame);
    }
    Seam seam;
    seam.a_frame = a_.frame_count();
    seam.overlap = 0;
    SeamRegion region;
    region.begin = region.end = region.b_shift = seam.a_frame;
    SeamCheck check =
        check_motion(motion_a_.human, human_b_, to_human(whole, mapping_), region, options_.limits);
    return {std::move(whole), seam, std::move(map), 0.0, 0.0, std::move(check)};
  }

  Result<Concatenation> join(const SeamOptions& options) {
    const Clip* on_floor = &b_;
    auto search = find_seam(motion_a_.human, human_b_, options, a_file_, b_file_);
    if (!search) return failure(search.error());
    if (raised_) {
      auto other =
          find_seam(motion_a_.human, to_human(*raised_, mapping_), options, a_file_, b_file_);
      if (!other) return failure(other.error());
      if (other->seams[0].distance < search->seams[0].distance) {
        search = std::move(other);
        on_floor = &*raised_;
      }
    }
    // the best of those that turn out well
    std::optional<Concatenation> best;
    for (const Seam& seam : search->seams) {
      auto joined = join_at(seam, *on_floor);
      if (!joined) return joined;
      const bool good = joined->check.faults.empty();
      if (!best || good) best = std::move(*joined);
      if (good) break;
    }
    best->map = std::move(search->map);
    best->lift = on_floor == &b_ ? 0.0 : lift_;
    best->band = options.band;
    return std::move(*best);
  }

  Result<Concatenation> join_at(const Seam& seam, Clip moved) {
    mover_.move_all(moved, seam.a_from_b.in_space());
    auto joined = join_clips(motion_a_, HumanMotion(moved, mapping_), seam, mapping_, mover_,
                             options_, a_file_);
    if (!joined) return failure(joined.error());
    return Concatenation{std::move(joined->clip), seam, {}, 0.0, 0.0, std::move(joined->check)};
  }

  const Clip& a_;
  const Clip& b_;
  const HumanMapping& mapping_;
  const BodyMover& mover_;
  const ConcatenateOptions& options_;
  const std::string& a_file_;
  const std::string& b_file_;
  const HumanMotion motion_a_;
  const HumanClip human_b_;
  double lift_ = 0.0;           // from b's floor to a's, metres,
  std::optional<Clip> raised_;  // and b there, where that is not the same
};

}  // namespace

Result<Concatenation> concatenate(const Clip& a, const Clip& b, const HumanMapping& mapping,
                                  const ConcatenateOptions& options, const std::string& a_file,
                                  const std::string& b_file) {
  if (!same_rate(a.rate(), b.rate())) {
    return input_failure(b_file, "has " + to_text(b.rate()) + " frames per second, " + a_file +
                                     " " + to_text(a.rate()));
  }
  if (a.skeleton().names() != b.skeleton().names() ||
      a.skeleton().translated_count() != b.skeleton().translated_count()) {
    return input_failure(b_file, "has another skeleton than " + a_file);
  }
  const auto mover = BodyMover::of(a, mapping, a_file, &b);
  if (!mover) return failure(mover.error());
  return Joiner(a, b, mapping, *mover, options, a_file, b_file).run();
}

}  // namespace retarget
