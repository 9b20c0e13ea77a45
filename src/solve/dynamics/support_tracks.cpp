#include "solve/dynamics/support_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "retarget/robot.h"
#include "retarget/statistics.h"
#include "solve/dynamics/contact_forces.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Thresholds for a robot of a G1's size.
constexpr double kContactHeight = 0.02;    // Metres.
constexpr double kContactSpeed = 0.5;      // Metres per second.
constexpr double kNeighbour = 1.0 / 30.0;  // Extension of a contact on either side, seconds.

}  // namespace

SupportTracks::SupportTracks(const std::vector<SupportPoint>& points, std::size_t samples,
                             double rate)
    : points_(&points),
      samples_(samples),
      rate_(rate),
      places_(points.size() * samples),
      pushed_by_(places_.size(), kNothing) {}

void SupportTracks::set(std::size_t sample, const TreeState& state) {
  for (std::size_t p = 0; p < points_->size(); ++p) {
    places_[sample * points_->size() + p] = lowest_of((*points_)[p], state);
  }
}

void SupportTracks::find_contacts(double floor, const BodySizes& sizes) {
  for (std::size_t p = 0; p < points_->size(); ++p) {
    for (std::size_t i = 0; i < samples_; ++i) {
      const bool low = at(i, p).z() - floor < kContactHeight * sizes.length;
      const bool slow = velocity(i, p).norm() * rate_ < kContactSpeed * sizes.speed;
      if (low && slow) mark(i, p, kFloor);
    }
  }
}

void SupportTracks::find_contacts(const SceneSupports& scene,
                                  const std::function<int(std::size_t)>& frame_of,
                                  const BodySizes& sizes) {
  for (std::size_t i = 0; i < samples_; ++i) {
    const int frame = frame_of(i);
    for (std::size_t p = 0; p < points_->size(); ++p) {
      const auto body =
          scene.touched(frame, centre(i, p), (*points_)[p].radius, velocity(i, p) * rate_,
                        kContactHeight * sizes.length, kContactSpeed * sizes.speed);
      if (body) mark(i, p, static_cast<Surface>(kFirstBody + *body));
    }
  }
}

Vector3d SupportTracks::centre(std::size_t sample, std::size_t point) const {
  return at(sample, point) + (*points_)[point].radius * Vector3d::UnitZ();
}

std::optional<std::size_t> SupportTracks::body_under(std::size_t sample, std::size_t point) const {
  const Surface surface = pushed_by_[sample * points_->size() + point];
  if (surface < kFirstBody) return std::nullopt;
  return static_cast<std::size_t>(surface - kFirstBody);
}

ContactPlace SupportTracks::place(std::size_t sample, std::size_t point, const SceneSupports* scene,
                                  int frame) const {
  const auto body = body_under(sample, point);
  if (!body) return {at(sample, point)};
  return scene->place(frame, centre(sample, point), (*points_)[point].radius, *body);
}

void SupportTracks::list_contacts(std::size_t sample, std::vector<int>& chosen) const {
  chosen.clear();
  const std::size_t count = points_->size();
  for (std::size_t p = 0; p < count; ++p) {
    if (pushed_by_[sample * count + p] != kNothing) chosen.push_back(static_cast<int>(p));
  }
  keep_outermost(at(sample), ContactForces::kMaxPoints, chosen);
}

// Marks a contact at a sample and at the samples at most kNeighbour before and after it.
void SupportTracks::mark(std::size_t sample, std::size_t point, Surface surface) {
  const std::size_t count = points_->size();
  const auto reach = static_cast<std::size_t>(std::lround(kNeighbour * rate_));
  const std::size_t end = std::min(samples_, sample + reach + 1);
  for (std::size_t k = sample < reach ? 0 : sample - reach; k < end; ++k) {
    Surface& pushed = pushed_by_[k * count + point];
    if (pushed == kNothing) pushed = surface;
  }
}

// Velocity of a point, metres per sample.
Vector3d SupportTracks::velocity(std::size_t sample, std::size_t point) const {
  const std::size_t before = sample == 0 ? 0 : sample - 1;
  const std::size_t after = std::min(sample + 1, samples_ - 1);
  if (after == before) return Vector3d::Zero();
  return (at(after, point) - at(before, point)) / static_cast<double>(after - before);
}

namespace {

// Heights of a sole at a sample at which it is level and slow.
struct StandingSole {
  double lowest = 0.0, middle = 0.0;
};

std::vector<StandingSole> standing_soles(const SupportTracks& tracks, const BodySizes& sizes) {
  const std::vector<SupportPoint>& points = tracks.points();
  const double slow = 0.15 * sizes.speed;
  const double flat = 0.02 * sizes.length;
  std::vector<StandingSole> soles;
  for (std::size_t begin = 0; begin < points.size() && points[begin].of_sole;) {
    std::size_t end = begin;
    while (end < points.size() && points[end].of_sole && points[end].link == points[begin].link)
      ++end;
    const auto middle = [&](std::size_t sample) {
      Vector3d sum = Vector3d::Zero();
      for (std::size_t p = begin; p < end; ++p) sum += tracks.at(sample, p);
      return Vector3d(sum / static_cast<double>(end - begin));
    };
    for (std::size_t i = 1; i + 1 < tracks.sample_count(); ++i) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t p = begin; p < end; ++p) {
        low = std::min(low, tracks.at(i, p).z());
        high = std::max(high, tracks.at(i, p).z());
      }
      if (!(high - low < flat)) continue;
      if ((middle(i + 1) - middle(i - 1)).norm() * tracks.rate() / 2.0 < slow) {
        soles.push_back({low, middle(i).z()});
      }
    }
    begin = end;
  }
  return soles;
}

std::size_t samples_in(double seconds, const SupportTracks& tracks) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(seconds * tracks.rate())));
}

// Number of samples for which soles stand on a floor.
std::size_t least_samples(const SupportTracks& tracks) {
  return samples_in(0.5, tracks);
}

// The height below which some point of the body is for a tenth of a second in total: single frames
// may be wrong.
double depth_of_body(const SupportTracks& tracks) {
  std::vector<double> lowest;
  for (std::size_t i = 0; i < tracks.sample_count(); ++i) {
    double low = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < tracks.points().size(); ++p) {
      low = std::min(low, tracks.at(i, p).z());
    }
    lowest.push_back(low);
  }
  const std::size_t rank = std::min(samples_in(0.1, tracks), lowest.size()) - 1;
  std::ranges::nth_element(lowest, lowest.begin() + static_cast<std::ptrdiff_t>(rank));
  return lowest[rank];
}

}  // namespace

double standing_height(const SupportTracks& tracks, const BodySizes& sizes) {
  const double bottom = -0.06 * sizes.length, top = 0.08 * sizes.length;
  std::vector<double> heights;
  for (const StandingSole& sole : standing_soles(tracks, sizes)) {
    if (sole.lowest > bottom && sole.lowest < top) heights.push_back(sole.middle);
  }
  if (heights.size() < least_samples(tracks)) return 0.0;
  return median(std::move(heights));
}

double lowest_standing_height(const SupportTracks& tracks, const BodySizes& sizes) {
  const double one_level = 0.08 * sizes.length, sinks = 0.06 * sizes.length;
  std::vector<double> heights;
  for (const StandingSole& sole : standing_soles(tracks, sizes)) heights.push_back(sole.middle);
  std::ranges::sort(heights);
  const std::size_t least = least_samples(tracks);
  for (std::size_t i = 0; i + least <= heights.size(); ++i) {
    if (heights[i + least - 1] - heights[i] > one_level) continue;
    const auto end = std::ranges::upper_bound(heights, heights[i] + one_level);
    const double height = median({heights.begin() + static_cast<std::ptrdiff_t>(i), end});
    // A body that also moves far below these soles stands on a box.
    if (depth_of_body(tracks) < height - sinks) break;
    return height;
  }
  return standing_height(tracks, sizes);
}

}  // namespace retarget
