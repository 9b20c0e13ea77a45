#include "human/gait/move_contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Metres, for a body with legs of kUsualSourceLeg.
constexpr double kShortestWay = 0.6;
constexpr double kBehindAnkle = 0.05;    // The heel; feet without known soles.
constexpr double kBeforeToeBase = 0.07;  // The tips of the toes.
constexpr double kFreeAtStart = 0.15;    // Between the feet in the first frame and the edge.
// A foot stays this far from a riser and an edge, metres.
constexpr double kClear = 0.03;

// The sole of a foot during a stance: the middles of its ends.
struct Stance {
  FrameRange frames;
  Vector3d heel = Vector3d::Zero(), toe = Vector3d::Zero();
};

Stance stance_of(const SourceFeet& feet, int foot, const FrameRange& frames, double scale) {
  Stance stance{frames};
  for (int frame = frames.begin; frame < frames.end; ++frame) {
    stance.heel += feet.at(frame, foot).end(kHeelEnd);
    stance.toe += feet.at(frame, foot).end(kToeEnd);
  }
  const double count = frames.end - frames.begin;
  stance.heel /= count;
  stance.toe /= count;
  const Vector2d ahead = (stance.toe - stance.heel).head<2>();
  if (ahead.norm() > 0.0 && !feet.soles[static_cast<std::size_t>(foot)]) {
    stance.heel.head<2>() -= kBehindAnkle * scale * ahead.normalized();
    stance.toe.head<2>() += kBeforeToeBase * scale * ahead.normalized();
  }
  return stance;
}

// The part of the line along a terrain that a foot covers, in metres behind the edge.
struct Span {
  double low = 0.0, high = 0.0;
};

Span span_of(const Terrain& terrain, const Stance& stance) {
  const double heel = terrain.distance(stance.heel.head<2>());
  const double toe = terrain.distance(stance.toe.head<2>());
  return {std::min(heel, toe), std::max(heel, toe)};
}

// Displacement of a foot along the terrain that puts it on one step.
double shift_to_step(const Terrain& terrain, const Span& foot, int step) {
  const double begin = (step - 1) * terrain.tread + kClear, end = step * terrain.tread - kClear;
  const bool has_riser = step<terrain.count, has_edge = step> 0;
  // A tread that is shorter than the foot: the foot ends at the next riser.
  if (has_riser && foot.high > end) return end - foot.high;
  if (has_riser && has_edge && foot.high - foot.low > end - begin) return end - foot.high;
  if (has_edge && foot.low < begin) return begin - foot.low;
  return 0.0;
}

// The same for the edge of a slope.
double shift_from_edge(const Span& foot) {
  if (foot.low >= kClear || foot.high <= -kClear) return 0.0;
  return foot.low + foot.high > 0.0 ? kClear - foot.low : -kClear - foot.high;
}

ContactMove move_to_terrain(const Terrain& terrain, const SourceFeet& feet, int foot,
                            const Stance& stance) {
  const Span span = span_of(terrain, stance);
  const double middle = 0.5 * (span.low + span.high);
  ContactMove move{stance.frames.begin, stance.frames.end, Quaterniond::Identity(), {}};
  double along = 0.0, height = 0.0;
  if (terrain.is_slope()) {
    along = shift_from_edge(span);
    height = terrain.height_at(middle + along);
    const Vector3d across(terrain.along.y(), -terrain.along.x(), 0.0);
    if (middle + along > 0.0) move.turn = exp_so3(terrain.slope * across);
  } else {
    const int step = terrain.step_at(middle);
    along = shift_to_step(terrain, span, step);
    height = terrain.rise * step;
  }
  const Vector3d offset(along * terrain.along.x(), along * terrain.along.y(), height);
  Vector3d pivot = 0.5 * (stance.heel + stance.toe);
  pivot.z() = 0.0;
  for (int frame = stance.frames.begin; frame < stance.frames.end; ++frame) {
    const Vector3d from_pivot = feet.at(frame, foot).ankle - pivot;
    move.offsets.push_back(offset + move.turn * from_pivot - from_pivot);
  }
  return move;
}

// Sets direction and edge of the terrain. @return whether the human walks far enough.
bool place_terrain(const std::vector<Vector2d>& hips, const std::vector<Stance>& stances,
                   double scale, Terrain& terrain) {
  const auto farthest = std::ranges::max_element(
      hips, {}, [&](const Vector2d& place) { return (place - hips.front()).norm(); });
  const Vector2d way = *farthest - hips.front();
  if (!(way.norm() >= kShortestWay * scale)) return false;
  terrain.along = way.normalized();
  terrain.edge = hips.front();
  int first = stances.front().frames.begin;
  for (const Stance& stance : stances) first = std::min(first, stance.frames.begin);
  double edge = 0.0, last = 0.0;
  for (const Stance& stance : stances) {
    const Span span = span_of(terrain, stance);
    if (stance.frames.begin == first) edge = std::max(edge, span.high);
    last = std::max(last, 0.5 * (span.low + span.high));
  }
  edge += kFreeAtStart * scale;
  terrain.edge += edge * terrain.along;
  if (!terrain.is_slope() && terrain.count == 0) {
    terrain.count = std::max(1, static_cast<int>(std::floor((last - edge) / terrain.tread)) + 1);
  }
  return last > edge;
}

// Displacement of a point on a body of a scene, or on the floor.
class PlaceMover {
 public:
  PlaceMover(const SceneWorld& before, const SceneClip& after, const Vector3d& static_scale,
             double object_scale)
      : before_(before), after_(after), static_scale_(static_scale), object_scale_(object_scale) {}

  // @param in_body  position in the frame of the body before the change.
  [[nodiscard]] Vector3d on_body(int frame, std::size_t body, const Vector3d& in_body) const {
    const Vector3d place = before_.clip.pose(frame, body) * in_body;
    if (!before_.moves(body)) return on_static(place);
    return after_.pose(frame, body) * (object_scale_ * in_body) - place;
  }
  // @param place  position on the ground in the world before the change.
  // @param scale  leg length / kUsualSourceLeg.
  [[nodiscard]] Vector3d on_ground(int frame, const Vector3d& place, double scale) const {
    const int under = body_under(before_, frame, place, scale);
    if (under < 0) return on_static(place);
    const auto body = static_cast<std::size_t>(under);
    return on_body(frame, body, before_.clip.pose(frame, body).inverse() * place);
  }

 private:
  [[nodiscard]] Vector3d on_static(const Vector3d& place) const {
    return (static_scale_ - Vector3d::Ones()).cwiseProduct(place);
  }

  const SceneWorld& before_;
  const SceneClip& after_;
  Vector3d static_scale_;
  double object_scale_;
};

bool stays_in_place(const ContactMove& move) {
  return std::ranges::all_of(move.offsets,
                             [](const Vector3d& offset) { return offset.isZero(0.0); });
}

// Adds a move; where it overlaps the last one, the earlier contact wins.
void add_move(ContactMove move, std::vector<ContactMove>& moves) {
  if (!moves.empty() && move.begin < moves.back().end) {
    const int late = moves.back().end - move.begin;
    if (move.begin + late >= move.end) return;
    move.offsets.erase(move.offsets.begin(), move.offsets.begin() + late);
    move.begin += late;
  }
  moves.push_back(std::move(move));
}

void add_phase(const PlaceMover& mover, const SurfacePhase& phase,
               std::vector<ContactMove>& moves) {
  ContactMove move{phase.begin, phase.end, Quaterniond::Identity(), {}};
  for (int frame = phase.begin; frame < phase.end; ++frame) {
    const Vector3d& place = phase.places[static_cast<std::size_t>(frame - phase.begin)];
    move.offsets.push_back(mover.on_body(frame, phase.body, place));
  }
  add_move(std::move(move), moves);
}

}  // namespace

ContactMoves put_on_terrain(const std::vector<Vector2d>& hips, const SourceFeet& feet,
                            const ContactPlan& contacts, Terrain& terrain) {
  ContactMoves moves;
  std::array<std::vector<Stance>, 2> stances;
  std::vector<Stance> all;
  for (int foot = 0; foot < feet.foot_count; ++foot) {
    for (const FrameRange& frames :
         foot_stances(contacts, foot, feet.frame_count(), feet.frame_time)) {
      stances[static_cast<std::size_t>(foot)].push_back(
          stance_of(feet, foot, frames, contacts.scale));
      all.push_back(stances[static_cast<std::size_t>(foot)].back());
    }
  }
  if (all.empty() || !place_terrain(hips, all, contacts.scale, terrain)) return moves;
  for (int foot = 0; foot < feet.foot_count; ++foot) {
    for (const Stance& stance : stances[static_cast<std::size_t>(foot)]) {
      moves.feet[static_cast<std::size_t>(foot)].push_back(
          move_to_terrain(terrain, feet, foot, stance));
    }
  }
  return moves;
}

ContactMoves moves_with_scene(const SceneWorld& before, const SceneClip& after,
                              const Vector3d& static_scale, double object_scale,
                              const SourceFeet& feet, const ContactPlan& contacts,
                              const std::vector<SurfacePhase>& phases) {
  const PlaceMover mover(before, after, static_scale, object_scale);
  ContactMoves moves;
  for (int foot = 0; foot < feet.foot_count; ++foot) {
    for (const FrameRange& frames :
         foot_stances(contacts, foot, feet.frame_count(), feet.frame_time)) {
      const Stance stance = stance_of(feet, foot, frames, contacts.scale);
      Vector3d place = 0.5 * (stance.heel + stance.toe);
      const int middle = (frames.begin + frames.end - 1) / 2;
      place.z() = before.ground_below(middle, place + Vector3d(0.0, 0.0, 0.12 * contacts.scale));
      ContactMove move{frames.begin, frames.end, Quaterniond::Identity(), {}};
      move.offsets.assign(static_cast<std::size_t>(frames.end - frames.begin),
                          mover.on_ground(middle, place, contacts.scale));
      moves.feet[static_cast<std::size_t>(foot)].push_back(std::move(move));
    }
  }
  std::vector<SurfacePhase> sorted = phases;
  std::ranges::stable_sort(sorted, {}, &SurfacePhase::begin);
  for (const SurfacePhase& phase : sorted) {
    switch (kSupportBones[phase.part]) {
      case Bone::kLeftHand:
        add_phase(mover, phase, moves.hands[0]);
        break;
      case Bone::kRightHand:
        add_phase(mover, phase, moves.hands[1]);
        break;
      case Bone::kLeftForeArm:
      case Bone::kRightForeArm:
        break;
      default:
        add_phase(mover, phase, moves.trunk);
        break;
    }
  }
  // Limbs without a displacement are kept with the others, because the body may move.
  const auto still = [](const std::vector<ContactMove>& of_limb) {
    return std::ranges::all_of(of_limb, stays_in_place);
  };
  const bool stays = std::ranges::all_of(moves.feet, still) &&
                     std::ranges::all_of(moves.hands, still) && still(moves.trunk);
  return stays ? ContactMoves{} : moves;
}

}  // namespace retarget
