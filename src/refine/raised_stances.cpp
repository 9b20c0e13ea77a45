#include "refine/raised_stances.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "math/statistics.h"

namespace retarget {
namespace {

// height of the up vector of a foot that stands with its whole sole
constexpr double kSoleUp = 0.75;
// metres by which heel and toe may differ on something flat
constexpr double kFlat = 0.03;

// whether both ends stay where they are
bool stays_in_place(const SourceFeet& source, int foot, int begin, int end, double drift) {
  for (const int foot_end : {kHeel, kToe}) {
    Eigen::AlignedBox3d box;
    for (int frame = begin; frame < end; ++frame) {
      box.extend(source.at(frame, foot).end(foot_end));
    }
    if (box.sizes().maxCoeff() > drift) return false;
  }
  return true;
}

}  // namespace

std::vector<RaisedStance> find_raised_stances(const SourceFeet& source,
                                              const StandingHeights& standing, int foot,
                                              const FitOptions& options) {
  const double size = source.size();
  const auto still = [&](int frame) {
    const SourceFoot& now = source.at(frame, foot);
    return now.up > kSoleUp && std::ranges::all_of(std::array{kHeel, kToe}, [&](int end) {
             return now.end(end).z() - standing.of(end) > options.contact_height * size &&
                    source.speed(frame, foot, end) < options.contact_speed * size;
           });
  };
  std::vector<RaisedStance> stances;
  const int frames = source.frame_count();
  for (int begin = 0; begin < frames;) {
    int end = begin;
    while (end < frames && still(end)) ++end;
    if (end > begin && (end - begin) * source.frame_time > options.support_time - 1e-9 &&
        stays_in_place(source, foot, begin, end, options.support_drift * size)) {
      RaisedStance stance{begin, end, {}};
      for (const int foot_end : {kHeel, kToe}) {
        std::vector<double> heights;
        for (int frame = begin; frame < end; ++frame) {
          heights.push_back(source.at(frame, foot).end(foot_end).z() - standing.of(foot_end));
        }
        stance.height[foot_end] = median(std::move(heights));
      }
      if (std::abs(stance.height[kHeel] - stance.height[kToe]) < kFlat * size) {
        stance.height.fill(0.5 * (stance.height[kHeel] + stance.height[kToe]));
      }
      stances.push_back(stance);
    }
    begin = end + 1;
  }
  return stances;
}

}  // namespace retarget
