#include "retarget/scene_from_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "base/math/convex_hull.h"
#include "human/gait/contact_plan.h"
#include "human/gait/frame_runs.h"
#include "human/gait/seats.h"
#include "human/gait/source_feet.h"
#include "human/gait/standing_heights.h"
#include "retarget/human.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// The part of a human that rests on a surface.
enum class RestKind : unsigned char { kStep, kSeat, kHand };

// A human rests on a surface.
struct RaisedRest {
  RestKind kind = RestKind::kStep;
  FrameRange frames;
  double height = 0.0;                   // Of the surface; world, metres.
  std::vector<Eigen::Vector2d> outline;  // Points that the surface supports; world, metres.
};

// Feet, contacts and poses of a human.
struct RestingHuman {
  const HumanClip* human = nullptr;
  SourceFeet feet;
  ContactPlan contacts;
};

// Points of the feet in all stances, with the heights on which they stand.
struct Footing {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  double height = 0.0;
};

using Eigen::Vector2d;
using Eigen::Vector3d;

// Lengths in metres and speeds in m/s for a body with legs of kUsualSourceLeg.
constexpr double kLowestSurface = 0.06;  // The least height of a surface.
constexpr double kAlone = 0.1;           // Seconds in which a foot carries the body.
constexpr double kHalfFoot = 0.05;       // Half the width of a foot.
constexpr double kHeelLength = 0.05, kToeLength = 0.07;  // Beyond ankle and start of the toes.
constexpr double kShortestRest = 0.5;                    // Seconds.
constexpr double kHalfSeat = 0.15;                       // Half the width of a seat.
constexpr double kLowestHand = 0.2;
constexpr double kHandStays = 0.02;     // Maximum movement of a resting hand.
constexpr double kShoulderMoves = 0.1;  // Minimum movement of its shoulder.
constexpr double kHandDepth = 0.03;     // From the wrist to the skin.
constexpr double kHalfHand = 0.08;

// The corners of a sole in the middle of a stance.
void add_sole(int foot, const FrameRange& frames, double scale, const SourceFeet& feet,
              std::vector<Vector2d>& outline) {
  const SourceFoot& middle = feet.at((frames.begin + frames.end - 1) / 2, foot);
  const Vector2d heel = middle.end(kHeelEnd).head<2>(), toe = middle.toe.head<2>();
  if (!((toe - heel).norm() > 0.0)) return;
  const Vector2d ahead = (toe - heel).normalized(), aside(-ahead.y(), ahead.x());
  for (const double side : {-kHalfFoot * scale, kHalfFoot * scale}) {
    outline.push_back(heel - kHeelLength * scale * ahead + side * aside);
    outline.push_back(toe + kToeLength * scale * ahead + side * aside);
  }
}

class RestFinder {
 public:
  explicit RestFinder(const RestingHuman& of)
      : human_(*of.human),
        feet_(of.feet),
        contacts_(of.contacts),
        scale_(of.contacts.scale),
        floor_(floor_height(of.contacts)) {}

  std::vector<RaisedRest> run() {
    for (int foot = 0; foot < feet_.foot_count; ++foot) add_steps(foot);
    add_seats();
    for (const Side side : kSides) add_hands(side);
    std::ranges::stable_sort(rests_, {}, [](const RaisedRest& rest) { return rest.frames.begin; });
    return std::move(rests_);
  }

 private:
  [[nodiscard]] double frame_time() const { return human_.rate.frame_time(); }

  [[nodiscard]] Vector3d place(Bone bone, int frame) const {
    return human_.frame(frame)[bone].translation;
  }

  // Whether no other foot stands lower than a surface for long enough during a stance on it.
  [[nodiscard]] bool carries(int foot, const ContactPhase& stance) const {
    if (feet_.foot_count < 2) return true;
    double longest = 0.0;
    const auto no_other_is_lower = [&](int frame) {
      return std::ranges::none_of(
          contacts_.phases[static_cast<std::size_t>(1 - foot)], [&](const ContactPhase& other) {
            return frame >= other.begin && frame < other.end &&
                   other.support < stance.support - 0.5 * kLowestSurface * scale_;
          });
    };
    for_each_run_where(stance.begin, stance.end, no_other_is_lower, [&](int begin, int end) {
      longest = std::max(longest, (end - begin) * frame_time());
    });
    return longest >= kAlone;
  }

  void add_steps(int foot) {
    for (const ContactPhase& stance : contacts_.soles[static_cast<std::size_t>(foot)]) {
      if (stance.support < kLowestSurface * scale_ || !carries(foot, stance)) continue;
      RaisedRest rest{RestKind::kStep, {stance.begin, stance.end}, floor_ + stance.support, {}};
      add_sole(foot, rest.frames, scale_, feet_, rest.outline);
      rests_.push_back(std::move(rest));
    }
  }

  void add_seats() {
    for (const SeatRest& seat : find_seats(human_, poses_of(human_), contacts_)) {
      RaisedRest rest{RestKind::kSeat, seat.frames, seat.height, {}};
      add_square(seat.middle, kHalfSeat * scale_, rest.outline);
      rests_.push_back(std::move(rest));
    }
  }

  // Grows a run of frames in which the hand stays near its place in the first one.
  [[nodiscard]] int end_of_stay(Bone hand, int begin) const {
    const Vector3d first = place(hand, begin);
    int end = begin;
    while (end < human_.frame_count && (place(hand, end) - first).norm() <= kHandStays * scale_) {
      ++end;
    }
    return end;
  }

  void add_hands(Side side) {
    const Bone hand = side_bone(side, LimbBone::kHand), arm = side_bone(side, LimbBone::kArm);
    if (!human_.has(hand) || !human_.has(arm)) return;
    for (int begin = 0; begin < human_.frame_count;) {
      const int end = end_of_stay(hand, begin);
      const Vector3d at = place(hand, begin);
      Eigen::AlignedBox3d shoulder;
      for (int frame = begin; frame < end; ++frame) shoulder.extend(place(arm, frame));
      const bool is_held = (end - begin) * frame_time() >= kShortestRest &&
                           shoulder.diagonal().norm() >= kShoulderMoves * scale_ &&
                           at.z() < shoulder.min().z();
      const double height = at.z() - kHandDepth * scale_;
      if (is_held && height - floor_ >= kLowestHand * scale_) {
        RaisedRest rest{RestKind::kHand, {begin, end}, height, {}};
        add_square(at.head<2>(), kHalfHand * scale_, rest.outline);
        rests_.push_back(std::move(rest));
      }
      begin = is_held ? end : begin + 1;
    }
  }

  static void add_square(const Vector2d& middle, double half, std::vector<Vector2d>& outline) {
    for (const double x : {-half, half}) {
      for (const double y : {-half, half}) outline.push_back(middle + Vector2d(x, y));
    }
  }

  const HumanClip& human_;
  const SourceFeet& feet_;
  const ContactPlan& contacts_;
  const double scale_, floor_;
  std::vector<RaisedRest> rests_;
};

// Finds stances, seats and hand rests above the floor (scene_from_motion.h), in the order of time.
std::vector<RaisedRest> find_raised_rests(const RestingHuman& of) {
  return RestFinder(of).run();
}

std::vector<Footing> find_footings(const RestingHuman& of) {
  std::vector<Footing> footings;
  std::vector<Vector2d> outline;
  for (int foot = 0; foot < of.feet.foot_count; ++foot) {
    for (const ContactPhase& stance : of.contacts.phases[static_cast<std::size_t>(foot)]) {
      outline.clear();
      add_sole(foot, {stance.begin, stance.end}, of.contacts.scale, of.feet, outline);
      for (const Vector2d& point : outline) {
        footings.push_back({point, floor_height(of.contacts) + stance.support});
      }
    }
  }
  return footings;
}

using Points = std::vector<Vector2d>;

// Metres.
constexpr double kSameHeight = 0.04, kNearRests = 0.6, kMargin = 0.06, kLower = 0.05, kBoard = 0.05;

// A rectangle on the ground.
struct Rectangle {
  Vector2d along = Vector2d::UnitX();                        // Unit vector of its first side.
  Vector2d low = Vector2d::Zero(), high = Vector2d::Zero();  // In the axes of the sides.

  [[nodiscard]] Vector2d in_axes(const Vector2d& point) const {
    return {along.dot(point), along.x() * point.y() - along.y() * point.x()};
  }
  [[nodiscard]] double area() const { return (high - low).prod(); }
  [[nodiscard]] Vector2d middle() const {
    const Vector2d in_axes = 0.5 * (low + high);
    return in_axes.x() * along + in_axes.y() * Vector2d(-along.y(), along.x());
  }
};

// The smallest rectangle; one of its sides contains a side of the hull.
Rectangle smallest_rectangle(Points points) {
  reduce_to_hull(points);
  std::optional<Rectangle> best;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d side = points[(i + 1) % points.size()] - points[i];
    if (!(side.norm() > 0.0)) continue;
    Rectangle rectangle{side.normalized(), Vector2d::Constant(std::numeric_limits<double>::max()),
                        Vector2d::Constant(std::numeric_limits<double>::lowest())};
    for (const Vector2d& point : points) {
      rectangle.low = rectangle.low.cwiseMin(rectangle.in_axes(point));
      rectangle.high = rectangle.high.cwiseMax(rectangle.in_axes(point));
    }
    if (!best || rectangle.area() < best->area()) best = rectangle;
  }
  return best.value_or(Rectangle());
}

// Rests on one surface.
struct Plateau {
  std::vector<const RaisedRest*> rests;
  Points points;
  double height = 0.0;  // Mean over the frames of the rests.

  void add(const RaisedRest& rest) {
    rests.push_back(&rest);
    points.insert(points.end(), rest.outline.begin(), rest.outline.end());
    double sum = 0.0, frames = 0.0;
    for (const RaisedRest* each : rests) {
      const double count = each->frames.end - each->frames.begin;
      sum += count * each->height;
      frames += count;
    }
    height = sum / frames;
  }
};

double distance_between(const Points& a, const Points& b) {
  double nearest = std::numeric_limits<double>::max();
  for (const Vector2d& p : a) {
    for (const Vector2d& q : b) nearest = std::min(nearest, (p - q).norm());
  }
  return nearest;
}

// Whether the human stands inside a rectangle, lower than its height.
bool covers_lower_ground(const Rectangle& rectangle, double height,
                         const std::vector<Footing>& footings) {
  return std::ranges::any_of(footings, [&](const Footing& footing) {
    const Vector2d at = rectangle.in_axes(footing.point);
    return footing.height < height - kLower && (at.array() > rectangle.low.array()).all() &&
           (at.array() < rectangle.high.array()).all();
  });
}

// Adds a margin to each side, less where the human stands lower beside it.
void add_margins(double height, const std::vector<Footing>& footings, Rectangle& rectangle) {
  Vector2d below = Vector2d::Constant(kMargin), above = below;
  for (const Footing& footing : footings) {
    if (footing.height >= height - kLower) continue;
    const Vector2d at = rectangle.in_axes(footing.point);
    const Vector2d under = rectangle.low - at, over = at - rectangle.high;
    const Vector2d outside = under.cwiseMax(over);
    if (outside.maxCoeff() >= kMargin) continue;
    const int axis = outside.x() > outside.y() ? 0 : 1;
    if (outside[axis] <= 0.0) continue;
    double& margin = under[axis] > over[axis] ? below[axis] : above[axis];
    margin = std::min(margin, outside[axis]);
  }
  rectangle.low -= below;
  rectangle.high += above;
}

std::vector<Plateau> find_plateaus(const std::vector<RaisedRest>& rests,
                                   const std::vector<Footing>& footings) {
  std::vector<Plateau> plateaus;
  for (const RaisedRest& rest : rests) {
    const auto takes = [&](const Plateau& plateau) {
      if (std::abs(plateau.height - rest.height) > kSameHeight ||
          plateau.rests.front()->kind != rest.kind ||
          distance_between(plateau.points, rest.outline) > kNearRests) {
        return false;
      }
      Points together = plateau.points;
      together.insert(together.end(), rest.outline.begin(), rest.outline.end());
      return !covers_lower_ground(smallest_rectangle(together), rest.height, footings);
    };
    const auto found = std::ranges::find_if(plateaus, takes);
    (found == plateaus.end() ? plateaus.emplace_back() : *found).add(rest);
  }
  return plateaus;
}

std::string name_of(RestKind kind, int number) {
  constexpr std::array kNames = {"step", "seat", "rest"};
  return fmt::format("{}_{}", kNames[static_cast<std::size_t>(kind)], number);
}

// A box from the floor up; under a hand a board, because the body may be under a rail.
SceneBody box_of(const Rectangle& rectangle, RestKind kind, double height, std::string name) {
  const double thickness = kind == RestKind::kHand ? std::min(kBoard, height) : height;
  SceneBody body;
  body.name = std::move(name);
  const Vector2d middle = rectangle.middle();
  body.world_from_body.translation = {middle.x(), middle.y(), height - 0.5 * thickness};
  const double heading = portable::atan2(rectangle.along.y(), rectangle.along.x());
  body.world_from_body.rotation = exp_so3(Vector3d(0.0, 0.0, heading));
  SceneShape& box = body.shapes.emplace_back();
  box.type = SceneShape::Type::kBox;
  const Vector2d half = 0.5 * (rectangle.high - rectangle.low);
  box.half_size = {half.x(), half.y(), 0.5 * thickness};
  return body;
}

}  // namespace

Result<SceneFromMotion> scene_from_motion(const Clip& clip, const Calibration& calibration,
                                          const ContactOptions& options) {
  const HumanClip human = to_human(clip, calibration);
  RestingHuman of{&human, SourceFeet(human, human.frame_count), {}};
  if (of.feet.foot_count == 0) return input_failure(clip.name(), "the human has no feet");
  of.contacts = find_contacts(of.feet, options);
  const std::vector<RaisedRest> rests = find_raised_rests(of);
  const std::vector<Footing> footings = find_footings(of);
  SceneFromMotion found;
  found.scene.name = clip.name();
  std::array<int, 3> counts{};
  for (const Plateau& plateau : find_plateaus(rests, footings)) {
    Rectangle rectangle = smallest_rectangle(plateau.points);
    add_margins(plateau.height, footings, rectangle);
    const RestKind kind = plateau.rests.front()->kind;
    const std::string name = name_of(kind, ++counts[static_cast<std::size_t>(kind)]);
    found.scene.bodies.push_back(box_of(rectangle, kind, plateau.height, name));
    FoundSurface surface{name, plateau.height, rectangle.high - rectangle.low,
                         static_cast<int>(plateau.rests.size())};
    int begin = clip.frame_count(), end = 0;
    for (const RaisedRest* rest : plateau.rests) {
      begin = std::min(begin, rest->frames.begin);
      end = std::max(end, rest->frames.end);
    }
    surface.first = begin * clip.rate().frame_time();
    surface.last = end * clip.rate().frame_time();
    found.surfaces.push_back(std::move(surface));
  }
  return found;
}

std::string surfaces_text(const SceneFromMotion& found) {
  std::string text = fmt::format("{:<10}{:>10}{:>16}{:>8}{:>12}{:>12}\n", "surface", "height m",
                                 "size m", "rests", "from s", "to s");
  for (const FoundSurface& surface : found.surfaces) {
    const std::string size = fmt::format("{:.2f} x {:.2f}", surface.size.x(), surface.size.y());
    text += fmt::format("{:<10}{:>10.3f}{:>16}{:>8}{:>12.2f}{:>12.2f}\n", surface.body,
                        surface.height, size, surface.rests, surface.first, surface.last);
  }
  return text;
}

}  // namespace retarget
