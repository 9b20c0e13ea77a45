#include "edit/seam_blend.h"

#include <algorithm>
#include <cmath>

#include "edit/fading_offset.h"
#include "retarget/math/so3.h"
#include "retarget/math/spline.h"

namespace retarget {
namespace {

int count_frames(double seconds, const FrameRate& rate) {
  return std::max(1, static_cast<int>(std::lround(seconds * rate.fps())));
}

void crossfade(Clip& result, const Clip& a, const Clip& b, const SeamRegion& region) {
  for (int frame = region.begin; frame < region.end; ++frame) {
    const double of_b = 1.0 - region.weight_of_a(frame);
    const auto rotations_a = a.rotations(frame), rotations_b = b.rotations(frame - region.b_shift);
    const auto rotations = result.rotations(frame);
    for (std::size_t joint = 0; joint < rotations.size(); ++joint) {
      rotations[joint] = interpolate_linear(rotations_a[joint], rotations_b[joint], of_b);
    }
    const auto places_a = a.translations(frame), places_b = b.translations(frame - region.b_shift);
    const auto places = result.translations(frame);
    for (std::size_t slot = 0; slot < places.size(); ++slot) {
      places[slot] = places_a[slot] + of_b * (places_b[slot] - places_a[slot]);
    }
  }
}

// what fades in b: at the seam b is a's pose, and steps as a stepped
void fade_in(Clip& result, const Clip& a, const Clip& b, const SeamRegion& region) {
  const int at_a = region.begin, at_b = region.begin - region.b_shift;
  // steps at one time: to the seam, or on from it where both clips have one; else they are not
  // known to differ
  const int after = at_a > 0 && at_b > 0 ? 0 : 1;
  const int step_a = at_a + after, step_b = at_b + after;
  const bool steps = step_a < a.frame_count() && step_b < b.frame_count();
  const double length = region.end - region.begin;
  const auto turn = [](const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
    return log_so3(to * from.conjugate());
  };
  for (std::size_t joint = 0; joint < result.rotations(0).size(); ++joint) {
    const auto in = [joint](const Clip& clip, int frame) { return clip.rotations(frame)[joint]; };
    const Eigen::Vector3d gap = turn(in(b, at_b), in(a, at_a));
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    if (steps) {
      velocity = turn(in(a, step_a - 1), in(a, step_a)) - turn(in(b, step_b - 1), in(b, step_b));
    }
    for (int frame = region.begin; frame < region.end; ++frame) {
      Eigen::Quaterniond& rotation = result.rotations(frame)[joint];
      rotation =
          (exp_so3(fade(gap, velocity, length, frame - region.begin)) * rotation).normalized();
    }
  }
  for (std::size_t slot = 0; slot < result.translations(0).size(); ++slot) {
    const auto in = [slot](const Clip& clip, int frame) { return clip.translations(frame)[slot]; };
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    if (steps) {
      velocity = (in(a, step_a) - in(a, step_a - 1)) - (in(b, step_b) - in(b, step_b - 1));
    }
    const Eigen::Vector3d gap = in(a, at_a) - in(b, at_b);
    for (int frame = region.begin; frame < region.end; ++frame) {
      result.translations(frame)[slot] += fade(gap, velocity, length, frame - region.begin);
    }
  }
}

}  // namespace

double SeamRegion::weight_of_a(int frame) const {
  if (frame < b_begin) return 1.0;
  if (frame >= a_end) return 0.0;
  const double share = static_cast<double>(frame - begin + 1) / (end - begin);
  return share * share * (2.0 * share - 3.0) + 1.0;
}

SeamRegion seam_region(const Seam& seam, const ConcatenateOptions& options, const FrameRate& rate,
                       int frames_of_b) {
  SeamRegion region;
  region.begin = region.b_begin = seam.a_frame;
  region.b_shift = seam.a_frame - seam.b_frame;
  const bool whole = seam.overlap >= count_frames(options.seam.window, rate);
  if (options.blend == SeamBlend::kCrossfade && whole) {
    region.end = region.a_end = seam.a_frame + seam.overlap;
  } else {
    region.a_end = seam.a_frame;
    region.end =
        std::min(seam.a_frame + count_frames(options.fade, rate), frames_of_b + region.b_shift);
  }
  return region;
}

Clip blend_clips(const Clip& a, const Clip& b, const SeamRegion& region) {
  Clip result = cut(a, 0, region.begin);
  result.resize(b.frame_count() + region.b_shift);
  for (int frame = region.begin; frame < result.frame_count(); ++frame) {
    std::ranges::copy(b.rotations(frame - region.b_shift), result.rotations(frame).begin());
    std::ranges::copy(b.translations(frame - region.b_shift), result.translations(frame).begin());
  }
  if (region.a_end > region.b_begin) {
    crossfade(result, a, b, region);
  } else {
    fade_in(result, a, b, region);
  }
  return result;
}

}  // namespace retarget
