#include "retarget/quality/measure.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "quality/body_tracks.h"
#include "quality/draft.h"
#include "quality/floor_metrics.h"
#include "quality/joint_metrics.h"
#include "quality/tracking_metrics.h"
#include "retarget/human/foot_contacts.h"

namespace retarget {
namespace {

// the first frames of a human
HumanClip first_frames(const HumanClip& human, int frames) {
  HumanClip part = human;
  part.frame_count = frames;
  part.world_from_bone.resize(static_cast<std::size_t>(frames) * kBoneCount);
  return part;
}

FootContacts contacts_of(const HumanClip& human, int frames) {
  // what stands is learned from the part that is compared
  return frames == human.frame_count ? find_foot_contacts(human)
                                     : find_foot_contacts(first_frames(human, frames));
}

}  // namespace

QualityReport measure_quality(const RobotClip& clip, const LimitSet& limits,
                              const QualitySource* source, const QualityOptions& options) {
  QualityReport report;
  report.robot = clip.robot().name();
  report.frames = clip.frame_count();
  report.fps = clip.rate().fps();
  report.limits = limits.name;
  const Draft draft{clip, options, report};
  measure_joints(draft, limits);

  const bool tracked = source != nullptr && source->tables != nullptr;
  const BodyTracks tracks = track_bodies(
      clip, tracked ? tracked_bodies(clip.robot(), *source->tables) : std::vector<int>(),
      options.self_collision_stride);
  measure_bodies(draft, tracks);
  if (source != nullptr) {
    const int frames = std::min(clip.frame_count(), source->human->frame_count);
    report.source_frames = frames;
    measure_contacts(draft, tracks, contacts_of(*source->human, frames), frames);
    if (tracked) measure_tracking(draft, tracks, *source, frames);
  }
  std::ranges::sort(report.values, {}, &MetricValue::metric);
  return report;
}

}  // namespace retarget
