// Plants feet after a transfer.

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "edit/plant_feet.h"
#include "edit/rest_frames.h"
#include "edit/transfer.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {
namespace {

using Track = std::vector<Eigen::Vector3d>;

// Positions of a foot part in the target, and in the source scaled to the target's size.
struct PartTrack {
  Track is, as_source;
};

// One foot in both bodies.
class TransferredFoot {
 public:
  // @param toe  nothing if one of the bodies has no toe.
  TransferredFoot(PartTrack ankle, std::optional<PartTrack> toe)
      : ankle_(std::move(ankle)), toe_(std::move(toe)) {}

  // Returns the displacement of the foot in each frame of a stance.
  [[nodiscard]] Track shifts(const FootStand& stand) const {
    Track shifts(static_cast<std::size_t>(stand.end - stand.begin));
    const auto down = frames_down(stand);
    const PartTrack& part = down.first < down.second && toe_ ? *toe_ : ankle_;
    const auto [first, last] =
        down.first < down.second && toe_ ? down : std::pair(stand.begin, stand.end);
    // Ground offset that keeps the foot closest to its current position.
    Eigen::Vector3d beside = Eigen::Vector3d::Zero();
    for (int i = first; i < last; ++i) beside += (part.is[i] - part.as_source[i]) / (last - first);
    beside.z() = 0.0;
    for (int i = first; i < last; ++i) {
      shifts[i - stand.begin] = part.as_source[i] + beside - part.is[i];
    }
    // While on the heel, follow the ankle before and after.
    for (int i = first - 1; i >= stand.begin; --i) {
      shifts[i - stand.begin] = shifts[first - stand.begin] + ankle_way(i) - ankle_way(first);
    }
    for (int i = last; i < stand.end; ++i) {
      shifts[i - stand.begin] = shifts[last - 1 - stand.begin] + ankle_way(i) - ankle_way(last - 1);
    }
    return shifts;
  }

 private:
  [[nodiscard]] Eigen::Vector3d ankle_way(int frame) const {
    return ankle_.as_source[frame] - ankle_.is[frame];
  }

  // Range of frames from the first to the last with the toes down.
  static std::pair<int, int> frames_down(const FootStand& stand) {
    int first = stand.end, last = stand.begin;
    for (int i = stand.begin; i < stand.end; ++i) {
      if (stand.stances[i - stand.begin] == FootStance::kOnHeel) continue;
      first = std::min(first, i);
      last = i + 1;
    }
    return {first, last};
  }

  PartTrack ankle_;
  std::optional<PartTrack> toe_;
};

}  // namespace

Result<PlantSummary> plant_transferred_feet(Clip& moved, const TransferTarget& target,
                                            const Clip& clip, const Calibration& calibration) {
  const HumanClip source = to_human(clip, calibration), human = to_human(moved, target.calibration);
  const double scale = target.calibration.size / calibration.size;
  const auto part_of = [&](Bone bone) -> std::optional<PartTrack> {
    if (!source.has(bone) || !human.has(bone)) return std::nullopt;
    // The joints have different heights within the two feet.
    const auto rise = rise_over_soles(clip.skeleton(), calibration, bone),
               target_rise = rise_over_soles(moved.skeleton(), target.calibration, bone);
    const double higher = rise && target_rise ? *target_rise - scale * *rise : 0.0;
    PartTrack part;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      part.is.push_back(human.frame(frame)[bone].translation);
      part.as_source.push_back(scale * source.frame(frame)[bone].translation +
                               Eigen::Vector3d(0.0, 0.0, higher));
    }
    return part;
  };
  std::vector<PlantedFoot> plants;
  const auto stands = find_foot_stands(source);
  const auto legs = find_legs(moved.skeleton(), target.calibration);
  for (int foot = 0; foot < 2; ++foot) {
    const Bone toe = side_bone(kSides[foot], LimbBone::kToe);
    const auto ankle = part_of(side_bone(kSides[foot], LimbBone::kFoot));
    if (!legs[foot] || !ankle) continue;
    const TransferredFoot both(*ankle, part_of(toe));
    const auto poses = ankle_poses(moved, target.calibration, *legs[foot]);
    for (const FootStand& stand : stands[foot]) {
      PlantedFoot plant = plant_of(stand, foot, stand.begin, poses, human);
      const Track shifts = both.shifts(stand);
      for (std::size_t i = 0; i < shifts.size(); ++i) {
        plant.world_from_foot[i].translation += shifts[i];
      }
      plants.push_back(std::move(plant));
    }
  }
  return plant_feet(moved, target.calibration, plants);
}

}  // namespace retarget
