#include <algorithm>
#include <utility>

#include "base/try.h"
#include "motion/resample.h"
#include "retarget/scene.h"
#include "retarget/text.h"
#include "scene/body_mass.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Products of frame numbers and the terms of three rates exceed 64 bits.
__extension__ using Wide = __int128;

std::string quoted(const std::string& name) {
  return "\"" + name + "\"";
}

std::string list_bodies(const Scene& scene, bool moving) {
  std::vector<std::string> names;
  for (const SceneBody& body : scene.bodies) {
    if (body.moves || !moving) names.push_back(quoted(body.name));
  }
  return list_names(names, 10);
}

// The body that a track moves.
Result<std::size_t> body_of(const ObjectTrack& track, const Scene& scene) {
  if (!track.body.empty()) {
    const int found = scene.find(track.body);
    if (found >= 0) return static_cast<std::size_t>(found);
    std::vector<std::string> names;
    for (const SceneBody& body : scene.bodies) names.push_back(body.name);
    return input_failure(scene.name, "the scene has no body " + quoted(track.body) +
                                         did_you_mean(track.body, names) + ": its bodies are " +
                                         list_bodies(scene, false));
  }
  const auto moving = std::ranges::count_if(scene.bodies, &SceneBody::moves);
  if (moving > 1 || (moving == 0 && scene.bodies.size() > 1)) {
    return input_failure(
        scene.name,
        "a track does not name the body that it moves: " + list_bodies(scene, moving > 1),
        "name the body: BODY=FILE");
  }
  const auto found = std::ranges::find_if(scene.bodies, &SceneBody::moves);
  return moving == 0 ? 0 : static_cast<std::size_t>(found - scene.bodies.begin());
}

// Position of a result's frames in a track.
class TrackPlace {
 public:
  // @param rate  frame rate of the track
  TrackPlace(const FrameRate& rate, const ClipTimes& times) {
    const FrameRate& source = times.source_rate;
    // Rates that differ only by rounding mean the same frames.
    const FrameRate to = same_rate(times.rate, source) ? source : times.rate;
    const FrameRate track = same_rate(rate, source) ? source : rate;
    begin_ = Wide{times.source_begin} * source.seconds * to.frames * track.frames;
    step_ = Wide{to.seconds} * source.frames * track.frames;
    unit_ = Wide{source.frames} * to.frames * track.seconds;
  }

  // The result's frame lies between a frame of the track and the next one.
  [[nodiscard]] std::int64_t frame(int of_result) const {
    return static_cast<std::int64_t>(place(of_result) / unit_);
  }
  [[nodiscard]] double fraction(int of_result) const {
    return static_cast<double>(place(of_result) % unit_) / static_cast<double>(unit_);
  }

 private:
  [[nodiscard]] Wide place(int of_result) const { return begin_ + step_ * of_result; }

  Wide begin_, step_, unit_;
};

// The last sample may lie this part of a frame after the last frame, because of rounded rates.
constexpr double kBeyond = 0.5;

Result<void> place_track(const ObjectTrack& track, std::size_t body, const ClipTimes& times,
                         SceneClip& clip) {
  const std::string name = clip.scene->bodies[body].name;
  const auto count = static_cast<std::int64_t>(track.world_from_body.size());
  const TrackPlace place(track.rate.value_or(times.source_rate), times);
  const int last = times.frame_count - 1;
  if (count == 0 || place.frame(last) > count - 1 ||
      (place.frame(last) == count - 1 && place.fraction(last) > kBeyond)) {
    return input_failure(
        "",
        "the track of " + quoted(name) + " has " + count_text(count, "frame") +
            ", but the clip needs " + std::to_string(place.frame(last) + 1),
        track.rate ? "" : "a track without a rate has one pose per frame of the clip");
  }
  // Positions between frames are those of the centre of mass, so that they do not depend on the
  // origin of the body's frame.
  const Vector3d com = body_mass(clip.scene->bodies[body]).com;
  std::vector<Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  for (const Pose& pose : track.world_from_body) {
    positions.push_back(pose * com);
    rotations.push_back(pose.rotation);
  }
  const TrackSampler<Vector3d> position(std::move(positions), Interpolation::kCubic);
  const TrackSampler<Eigen::Quaterniond> rotation(std::move(rotations), Interpolation::kLinear);
  for (int i = 0; i < times.frame_count; ++i) {
    const auto frame = static_cast<int>(place.frame(i));
    const double fraction = place.fraction(i);
    const Eigen::Quaterniond turned = rotation.sample(frame, fraction);
    clip.world_from_body[static_cast<std::size_t>(i) * clip.scene->bodies.size() + body] = {
        turned, position.sample(frame, fraction) - turned * com};
  }
  return {};
}

// Adds the contacts that a track states, in the nearest frames.
void place_contacts(const ObjectTrack& track, std::size_t body, const ClipTimes& times,
                    SceneClip& clip) {
  const TrackPlace place(track.rate.value_or(times.source_rate), times);
  for (const StatedContact& stated : track.contacts) {
    StatedContact& placed = clip.contacts.emplace_back();
    placed.part = stated.part;
    placed.body = body;
    const auto last = static_cast<std::int64_t>(stated.touches.size()) - 1;
    for (int i = 0; i < times.frame_count && last >= 0; ++i) {
      const std::int64_t frame = place.frame(i) + (place.fraction(i) < 0.5 ? 0 : 1);
      placed.touches.push_back(stated.touches[static_cast<std::size_t>(std::min(frame, last))]);
    }
  }
}

Result<void> check_tracked(const SceneBody& body, const Scene& scene, bool is_second) {
  if (is_second) return input_failure(scene.name, "two tracks move the body " + quoted(body.name));
  const bool has_plane = std::ranges::any_of(
      body.shapes, [](const SceneShape& shape) { return shape.type == SceneShape::Type::kPlane; });
  if (!has_plane) return {};
  return input_failure(
      scene.name, "a track moves the body " + quoted(body.name) + ", which is an infinite plane");
}

}  // namespace

Result<SceneClip> place_scene(const std::shared_ptr<const Scene>& scene,
                              std::span<const ObjectTrack> tracks, const ClipTimes& times) {
  if (times.frame_count < 1 || times.source_begin < 0) {
    return input_failure("", "the clip has no frames");
  }
  std::vector<std::size_t> tracked;
  auto moving = std::make_shared<Scene>(*scene);
  for (const ObjectTrack& track : tracks) {
    TRY_ASSIGN(const std::size_t body, body_of(track, *scene));
    TRY(check_tracked(scene->bodies[body], *scene,
                      std::ranges::find(tracked, body) != tracked.end()));
    tracked.push_back(body);
    moving->bodies[body].moves = true;
  }
  SceneClip clip;
  clip.scene = std::move(moving);
  clip.rate = times.rate;
  clip.frame_count = times.frame_count;
  for (int frame = 0; frame < times.frame_count; ++frame) {
    for (const SceneBody& body : scene->bodies) {
      clip.world_from_body.push_back(body.world_from_body);
    }
  }
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    TRY(place_track(tracks[i], tracked[i], times, clip));
    place_contacts(tracks[i], tracked[i], times, clip);
  }
  return clip;
}

}  // namespace retarget
