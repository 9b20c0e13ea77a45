#include "retarget/edit/rethread.h"

#include <algorithm>
#include <utility>

#include "retarget/base/number_text.h"
#include "retarget/edit/change_speed.h"
#include "retarget/human/foot_contacts.h"

namespace retarget {
namespace {

// shorter than this a path gives no speed, metres
constexpr double kShortestWay = 0.01;

// the motion on its new path, played so that it goes as fast as on its own
Result<Clip> at_own_speed(Clip clip, double own_length, double length) {
  if (own_length < kShortestWay || length < kShortestWay) {
    return usage_failure("a path of " + number_text(std::min(own_length, length), 3) +
                             " m has no speed that could be kept",
                         "keep the time instead");
  }
  return change_speed(std::move(clip), own_length / length);
}

// where feet stand: each contact as a whole, as its middle frame is moved
std::vector<PlantedFoot> moved_plants(const Clip& clip, const HumanMapping& mapping,
                                      const HumanClip& human, const std::vector<GroundPose>& moves,
                                      double same_stand) {
  std::vector<PlantedFoot> plants;
  const FootContacts contacts = find_foot_contacts(human);
  const auto legs = find_legs(clip.skeleton(), mapping);
  for (int foot = 0; foot < 2; ++foot) {
    if (!legs[foot]) continue;
    const auto ankles = ankle_poses(clip, mapping, *legs[foot]);
    for (const ContactPhase& phase :
         without_short_breaks(contacts.phases[foot], same_stand, clip.rate())) {
      const Pose move = moves[static_cast<std::size_t>((phase.begin + phase.end) / 2)].in_space();
      PlantedFoot plant{foot, phase.begin, {}};
      for (int frame = phase.begin; frame < phase.end; ++frame) {
        plant.world_from_foot.push_back(move * ankles[frame]);
      }
      plants.push_back(std::move(plant));
    }
  }
  return plants;
}

}  // namespace

Result<Rethreaded> rethread(const Clip& clip, const HumanMapping& mapping, const GroundPath& path,
                            const RethreadOptions& options, const std::string& file) {
  const auto mover = BodyMover::of(clip.skeleton(), mapping, file);
  if (!mover) return failure(mover.error());
  const HumanClip human = to_human(clip, mapping);
  auto own = fit_path(human, options.fit, file);
  if (!own) return failure(own.error());

  // turns while standing: of the own path as the body turns, of the new one as the own path does
  std::vector<double> body_turns, own_turns;
  for (const StillPhase& phase : own->still) body_turns.push_back(phase.turn);
  const auto own_frames = path_frames(own->path, own->along, own->still, body_turns);
  const auto last = static_cast<int>(own_frames.size()) - 1;
  for (const StillPhase& phase : own->still) {
    own_turns.push_back(own_frames[std::min(phase.end, last)].heading -
                        own_frames[std::max(phase.begin - 1, 0)].heading);
  }
  const double stretch =
      options.keep == PathKeep::kStride ? 1.0 : path.length() / own->path.length();
  std::vector<double> along;
  for (const double place : own->along) along.push_back(stretch * place);

  Rethreaded result{clip, std::move(*own), {}, {}};
  result.frames = path_frames(path, along, result.source.still, own_turns);
  std::vector<GroundPose> moves;
  for (std::size_t frame = 0; frame < own_frames.size(); ++frame) {
    moves.push_back(result.frames[frame] * own_frames[frame].inverse());
    mover->move(result.clip, static_cast<int>(frame), moves.back());
  }
  const auto plants = moved_plants(clip, mapping, human, moves, options.same_stand);
  const auto feet = plant_feet(result.clip, mapping, plants, options.plant, file);
  if (!feet) return failure(feet.error());
  result.feet = *feet;
  if (options.keep == PathKeep::kSpeed) {
    auto played = at_own_speed(std::move(result.clip), result.source.path.length(), path.length());
    if (!played) return failure(played.error());
    result.clip = std::move(*played);
  }
  return result;
}

}  // namespace retarget
