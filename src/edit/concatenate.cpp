#include "retarget/edit/concatenate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "edit/join_clips.h"
#include "retarget/edit/pose_distance.h"
#include "retarget/edit/put_on_floor.h"

namespace retarget {
namespace {

// the largest distance of a bone in a frame from where the three frames before lead it, metres
double departure(const std::array<std::span<const Pose>, 4>& frames,
                 const std::vector<int>& bones) {
  double largest = 0.0;
  for (const int bone : bones) {
    const auto at = [&](int i) {
      return frames[static_cast<std::size_t>(i)][static_cast<std::size_t>(bone)].translation;
    };
    largest = std::max(largest, (at(3) - (3.0 * (at(2) - at(1)) + at(0))).norm());
  }
  return largest;
}

// whether b begins where a ends, a frame later: a clip that was cut in two, as it lies
bool goes_on(const HumanClip& a, const HumanClip& b) {
  // frames on either side by which a step across is judged
  constexpr int kBeside = 8, kFewest = 4;
  const int beside_frames = std::min({kBeside, a.frame_count, b.frame_count});
  if (beside_frames < kFewest) return false;
  const std::vector<int> bones = common_bones(a, b);
  const auto frame = [&](int i) { return i < 0 ? a.frame(a.frame_count + i) : b.frame(i); };
  const auto departure_at = [&](int i) {
    return departure({frame(i - 3), frame(i - 2), frame(i - 1), frame(i)}, bones);
  };
  double across = 0.0, beside = 0.0;
  for (int i = 3 - beside_frames; i < beside_frames; ++i) {
    double& largest = i >= 0 && i < 3 ? across : beside;
    largest = std::max(largest, departure_at(i));
  }
  double step = 0.0;
  for (const int bone : bones) {
    const auto index = static_cast<std::size_t>(bone);
    step = std::max(step, (frame(0)[index].translation - frame(-1)[index].translation).norm());
  }
  // as smooth as beside, and a step rather than the same frame again
  constexpr double kAsSmooth = 1.5, kRounding = 1e-5;
  return across <= kAsSmooth * beside + kRounding && step > kRounding;
}

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
        motion_a_(a, mapping) {
    const auto floor_a = floor_height(a, mapping, a_file),
               floor_b = floor_height(b, mapping, b_file);
    if (!floor_a || !floor_b) return;
    const double lift = *floor_a - *floor_b;
    if (std::abs(lift) > options.same_floor) lift_ = lift;
  }

  // as wide as it takes for a good seam; without one as narrow as can be
  Result<Concatenation> run() {
    SeamOptions seam = options_.seam;
    auto first = join(seam);
    if (first && goes_on(motion_a_.human, to_human(b_, mapping_))) {
      return put_together(std::move(first->map));
    }
    if (!first || first->check.faults.empty() || seam.search_all) return first;
    const double longest = std::max(a_.duration(), b_.duration());
    while (seam.band > 0.0 && seam.band < std::min(longest, options_.widest_band)) {
      seam.band = std::min(2.0 * seam.band, options_.widest_band);
      auto wider = join(seam);
      // too much to search
      if (!wider) return first;
      if (wider->check.faults.empty()) return wider;
    }
    first->band = seam.band;
    return first;
  }

 private:
  // one after the other, as they lie
  [[nodiscard]] Concatenation put_together(SeamMap map) const {
    Clip whole = a_;
    whole.resize(a_.frame_count() + b_.frame_count());
    for (int frame = 0; frame < b_.frame_count(); ++frame) {
      const int at = a_.frame_count() + frame;
      std::ranges::copy(b_.rotations(frame), whole.rotations(at).begin());
      std::ranges::copy(b_.translations(frame), whole.translations(at).begin());
    }
    Seam seam;
    seam.a_frame = a_.frame_count();
    seam.overlap = 0;
    return {std::move(whole), seam, std::move(map), 0.0, 0.0, {}};
  }

  Result<Concatenation> join(const SeamOptions& options) {
    Clip on_floor = b_;
    double lift = 0.0;
    auto search = find_seam(motion_a_.human, to_human(b_, mapping_), options, a_file_, b_file_);
    if (!search) return failure(search.error());
    if (lift_ != 0.0) {
      Clip raised = b_;
      mover_.move_all(raised, {Eigen::Quaterniond::Identity(), {0.0, 0.0, lift_}});
      auto other =
          find_seam(motion_a_.human, to_human(raised, mapping_), options, a_file_, b_file_);
      if (!other) return failure(other.error());
      if (other->seam.distance < search->seam.distance) {
        search = std::move(other);
        on_floor = std::move(raised);
        lift = lift_;
      }
    }
    auto joined = join_at(search->seam, std::move(on_floor));
    if (!joined) return joined;
    joined->map = std::move(search->map);
    joined->lift = lift;
    joined->band = options.band;
    return joined;
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
  double lift_ = 0.0;  // from b's floor to a's, metres; 0: they are one
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
  const auto of_a = BodyMover::of(a, mapping, a_file), of_b = BodyMover::of(b, mapping, b_file);
  if (!of_a || !of_b) return failure(of_a ? of_b.error() : of_a.error());
  // what moves in either clip
  const BodyMover& mover = of_a->joint() < of_b->joint() ? *of_a : *of_b;
  return Joiner(a, b, mapping, mover, options, a_file, b_file).run();
}

}  // namespace retarget
