#include "edit/seam.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "edit/ground_pose.h"
#include "retarget/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/option_name.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

// Frames of one clip that are searched.
struct SearchBand {
  int begin = 0, end = 0;

  [[nodiscard]] std::int64_t size() const { return end - begin; }
};

struct PairOfFrames {
  int a = 0, b = 0;
  double cost = std::numeric_limits<double>::infinity();
};

bool has_contacts(const ContactPlan& contacts) {
  return !contacts.phases[0].empty() || !contacts.phases[1].empty();
}

// Metres: poses closer than this are equal.
constexpr double kSame = 1e-5;

// Metres: poses of the same motion are closer than this, also if it was edited.
constexpr double kAlike = 0.02;

bool is_most_of(int lost, int frames) {
  return lost > static_cast<int>(kMostLost * frames);
}

class SeamFinder {
 public:
  SeamFinder(const HumanClip& a, const HumanClip& b, const SeamOptions& options, bool any_overlap)
      : a_(a),
        b_(b),
        options_(options),
        any_overlap_(any_overlap),
        bones_(common_bones(a, b)),
        in_a_(a, bones_),
        in_b_(b, bones_),
        window_(frames_in(options.window, a.rate)),
        distance_(in_a_, in_b_, window_),
        contacts_a_(find_contacts(a)),
        contacts_b_(find_contacts(b)) {
    const int band = frames_in(options.band, a.rate);
    band_a_ = {options.search_all ? 0 : std::max(0, a.frame_count - 1 - band), a.frame_count};
    band_b_ = {0, options.search_all ? b.frame_count : std::min(b.frame_count, band + 1)};
    const int most_lost = (a.frame_count - 1 - band_a_.begin) + (band_b_.end - 1);
    share_motion_ = is_most_of(most_lost, shorter()) && have_common_motion();
  }

  [[nodiscard]] std::int64_t pair_count() const { return band_a_.size() * band_b_.size(); }

  SeamSearch run() const {
    SeamSearch result;
    result.map = {band_a_.begin, band_b_.begin, static_cast<int>(band_b_.size()),
                  distance_.map(band_a_.begin, band_a_.end, band_b_.begin, band_b_.end)};
    std::vector<PairOfFrames> taken;
    if (const int shared = shared_frames(); shared > 0) {
      taken.push_back({a_.frame_count - shared, 0, 0.0});
      result.first_is_shared = true;
    }
    while (static_cast<int>(taken.size()) < std::max(1, options_.max_seams)) {
      const PairOfFrames next = best_pair(result.map, taken);
      if (std::isinf(next.cost)) break;
      taken.push_back(next);
    }
    for (const PairOfFrames& pair : taken) result.seams.push_back(describe_seam(pair));
    return result;
  }

 private:
  [[nodiscard]] int shorter() const { return std::min(a_.frame_count, b_.frame_count); }

  // Whether half of the shorter clip, or more, is the same motion in both clips.
  [[nodiscard]] bool have_common_motion() const {
    const int common = (shorter() + 1) / 2;
    for (int shift = common - b_.frame_count; shift <= a_.frame_count - common; ++shift) {
      if (are_alike(std::max(0, shift), std::min(a_.frame_count, b_.frame_count + shift), shift)) {
        return true;
      }
    }
    return false;
  }

  // Whether frames of a are alike to those of b that are `shift` frames earlier.
  [[nodiscard]] bool are_alike(int begin, int end, int shift) const {
    constexpr int kSamples = 9;
    const std::vector<double> weights(bones_.size(), 1.0);
    for (int sample = 0; sample < kSamples; ++sample) {
      const int frame = begin + (end - 1 - begin) * sample / (kSamples - 1);
      const auto aligned = align_clouds(in_a_.frame(frame), in_b_.frame(frame - shift), weights);
      if (aligned.distance > kAlike) return false;
    }
    return true;
  }

  // Whether a seam leaves too little of a clip. If both clips contain the same motion, as when a
  // clip is joined to itself, the best match is the same moment in both clips, but the result then
  // contains the motion only once.
  [[nodiscard]] bool loses_a_clip(int lost_of_a, int lost_of_b) const {
    return is_most_of(lost_of_a, a_.frame_count) || is_most_of(lost_of_b, b_.frame_count) ||
           (share_motion_ && is_most_of(lost_of_a + lost_of_b, shorter()));
  }

  // Returns the number of frames at the end of a that equal the first frames of b, also if
  // translated. A match of the whole clip is ignored: a clip may be joined to itself on purpose.
  [[nodiscard]] int shared_frames() const {
    const int whole = shorter();
    const int near = static_cast<int>(band_a_.size());
    const int longest = any_overlap_ ? whole : std::min(whole, near);
    std::vector<int> found;  // The longest first.
    for (int shared = longest; shared > 0; --shared) {
      if (shares(shared)) found.push_back(shared);
    }
    // Excerpts of one clip match once. A motion that repeats exactly matches after every cycle;
    // then only matches within the search range count, which lose the fewest cycles.
    const auto matches = std::ranges::count_if(found, [&](int n) { return n >= window_; });
    if (matches == 1 && found.front() < whole) return found.front();
    const auto nearest = std::ranges::find_if(found, [&](int n) { return n <= near && n < whole; });
    return nearest == found.end() ? 0 : *nearest;
  }

  // Whether the last frames of a are the first ones of b.
  [[nodiscard]] bool shares(int frames) const {
    const int begin = a_.frame_count - frames;
    // A still body has the same pose everywhere, so a long match means no more than one frame.
    if (frames > 1 && !moves_after(begin)) return false;
    // Single frames differ almost always, so searching whole clips costs little.
    if (!is_same(begin, 0, 1)) return false;
    for (int k = 0; k < frames; k += window_) {
      if (!is_same(begin + k, k, std::min(window_, frames - k))) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_same(int i, int j, int frames) const {
    const auto points = in_a_.frames(i, i + frames);
    const std::vector<double> weights(points.size(), 1.0);
    return align_clouds(points, in_b_.frames(j, j + frames), weights).distance <= kSame;
  }

  [[nodiscard]] bool moves_after(int frame) const {
    const auto now = in_a_.frame(frame), then = in_a_.frame(a_.frame_count - 1);
    for (std::size_t k = 0; k < now.size(); ++k) {
      if ((now[k] - then[k]).norm() > 10.0 * kSame) return true;
    }
    return false;
  }

  // Returns the best pair of frames that is not close to the given ones.
  [[nodiscard]] PairOfFrames best_pair(const SeamMap& map,
                                       const std::vector<PairOfFrames>& others) const {
    const double cost_of_frame = options_.cost_of_second * a_.rate.frame_time() +
                                 options_.cost_of_all / (a_.frame_count + b_.frame_count);
    const int near = std::max(1, window_ / 2);
    PairOfFrames best;
    std::size_t at = 0;
    for (int i = band_a_.begin; i < band_a_.end; ++i) {
      for (int j = band_b_.begin; j < band_b_.end; ++j, ++at) {
        const int lost_of_a = a_.frame_count - 1 - i;
        if (loses_a_clip(lost_of_a, j)) continue;
        const double distance = distance_.counted(map.distances[at], i, j);
        double cost = distance + cost_of_frame * (lost_of_a + j);
        if (cost >= best.cost) continue;
        const bool known = std::ranges::any_of(others, [&](const PairOfFrames& other) {
          return std::abs(other.a - i) < near && std::abs(other.b - j) < near;
        });
        if (known) continue;
        if (!same_support(i, j)) cost += options_.other_support * distance;
        if (cost < best.cost) best = {i, j, cost};
      }
    }
    return best;
  }

  // Compares the supporting feet in the middle of the overlap.
  [[nodiscard]] bool same_support(int i, int j) const {
    // Clips too short for contact detection cannot be compared.
    if (!has_contacts(contacts_a_) || !has_contacts(contacts_b_)) return true;
    const int middle = (distance_.frames_at(i, j) - 1) / 2;
    for (int foot = 0; foot < 2; ++foot) {
      if (contacts_a_.in_contact(foot, i + middle) != contacts_b_.in_contact(foot, j + middle)) {
        return false;
      }
    }
    return true;
  }

  [[nodiscard]] Seam describe_seam(const PairOfFrames& pair) const {
    const CloudAlignment aligned = distance_.at(pair.a, pair.b);
    Seam seam;
    seam.a_frame = pair.a;
    seam.b_frame = pair.b;
    seam.overlap = distance_.frames_at(pair.a, pair.b);
    seam.a_from_b = aligned.a_from_b;
    const Eigen::Vector2d hips = b_.frame(pair.b)[Bone::kHips].translation.head<2>();
    seam.way = seam.a_from_b * hips - hips;
    seam.distance = aligned.distance;
    seam.same_support = same_support(pair.a, pair.b);
    const Pose to_a = seam.a_from_b.in_space();
    for (std::size_t k = 0; k < bones_.size(); ++k) {
      const Eigen::Vector3d apart = in_a_.frame(pair.a)[k] - to_a * in_b_.frame(pair.b)[k];
      if (apart.norm() >= seam.worst_distance) {
        seam.worst_distance = apart.norm();
        seam.worst_bone = bone_name(bones_[k]);
      }
    }
    return seam;
  }

  const HumanClip& a_;
  const HumanClip& b_;
  const SeamOptions& options_;
  const bool any_overlap_;
  const std::vector<Bone> bones_;
  const PoseClouds in_a_, in_b_;
  const int window_;  // In frames.
  const WindowDistance distance_;
  const ContactPlan contacts_a_, contacts_b_;
  SearchBand band_a_, band_b_;
  bool share_motion_ = false;
};

}  // namespace

Result<SeamSearch> find_seam(const HumanClip& a, const HumanClip& b, const SeamOptions& options,
                             bool any_overlap) {
  const SeamFinder finder(a, b, options, any_overlap);
  constexpr std::int64_t kMaxPairs = 16'000'000;
  if (finder.pair_count() > kMaxPairs) {
    return usage_failure(
        "the seam search covers " + std::to_string(finder.pair_count()) +
            " pairs of frames, which is too many",
        RETARGET_OPTION("search") " S searches only the last and the first S seconds");
  }
  return finder.run();
}

std::string format_pgm(const SeamMap& map) {
  const std::size_t width = static_cast<std::size_t>(map.width);
  const std::size_t height = width > 0 ? map.distances.size() / width : 0;
  std::string text = "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
  if (map.distances.empty()) return text;
  const auto [smallest, largest] = std::ranges::minmax(map.distances);
  const float range = std::max(largest - smallest, 1e-9F);
  for (const float distance : map.distances) {
    text += static_cast<char>(std::lround(255.0F * (distance - smallest) / range));
  }
  return text;
}

}  // namespace retarget
