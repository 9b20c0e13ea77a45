// Compares the positions of bodies in a file with forward kinematics.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "formats/robot_motion/raw_motion.h"
#include "formats/robot_motion/trainer_arrays.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kFramesPlaced = 40;
// Metres. Models of other tools may differ from the robot's by a few centimetres.
constexpr double kPlaceTolerance = 0.1;
// Fewer bodies do not distinguish the orders.
constexpr std::size_t kFewestBodies = 3;

// Another reading of a file, which its bodies may confirm.
struct OtherReading {
  bool other_order = false;
  double angle = 1.0, length = 1.0;
};

class PlaceComparison {
 public:
  PlaceComparison(const RobotClip& clip, const RawMotion& raw, QuaternionOrder order)
      : clip_(clip), raw_(raw), order_(order) {}

  // The distance in the frame that fits best: the world's, the root's, or the world's axes at the
  // root.
  [[nodiscard]] double distance(const OtherReading& reading) const {
    // The user's unit may be that of the root alone.
    return std::min(distance(reading, *raw_.metres_per_unit * reading.length),
                    distance(reading, reading.length));
  }

 private:
  [[nodiscard]] double distance(const OtherReading& reading, double length) const {
    std::vector<double> positions = raw_.places.positions;
    for (double& value : positions) value *= length;
    if (!raw_.places.of_root) return distance(reading, positions, false, false);
    return std::min({distance(reading, positions, true, true),
                     distance(reading, positions, true, false),
                     distance(reading, positions, false, false)});
  }

  [[nodiscard]] double distance(const OtherReading& reading, std::span<const double> positions,
                                bool at_origin, bool unturned) const {
    const Robot& robot = clip_.robot();
    const auto pose = [&](std::size_t frame, std::span<double> qpos) {
      std::ranges::copy(clip_.qpos(static_cast<int>(frame)), qpos.begin());
      for (std::size_t i = 0; i < 3; ++i) qpos[i] *= at_origin ? 0.0 : reading.length;
      if (unturned) {
        for (std::size_t i = 3; i < 7; ++i) qpos[i] = i == 3 ? 1.0 : 0.0;
      } else if (reading.other_order) {
        // The configuration has w x y z; the other order shifts them by one.
        const bool was_xyzw = order_ == QuaternionOrder::kXyzw;
        std::rotate(qpos.begin() + 3, qpos.begin() + (was_xyzw ? 4 : 6), qpos.begin() + 7);
      }
      for (const int joint : raw_.joint_indices) {
        const RobotJoint& each = robot.joints()[static_cast<std::size_t>(joint)];
        const bool hinge = each.type == RobotJoint::Type::kHinge;
        qpos[each.qpos_address] *= hinge ? reading.angle : reading.length;
      }
      return true;
    };
    return largest_body_distance(robot, raw_.places.bodies, positions, raw_.frames, pose);
  }

  const RobotClip& clip_;
  const RawMotion& raw_;
  QuaternionOrder order_;
};

// Array of numbers or texts of this name; nothing without one.
std::optional<NpyArray> plain_array(const ArraySource& file, std::string_view name) {
  if (!file.has(name)) return std::nullopt;
  const auto type = file.type_of(name);
  if (!type || type->find('O') != std::string::npos) return std::nullopt;
  auto array = file.read(name);
  if (!array) return std::nullopt;
  return std::move(*array);
}

}  // namespace

double largest_body_distance(const Robot& robot, std::span<const PlacedBody> bodies,
                             std::span<const double> positions, std::size_t frames,
                             const FramePose& pose) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  double largest = 0.0;
  const std::size_t step = std::max<std::size_t>(1, frames / kFramesPlaced);
  const std::size_t width = positions.size() / frames;
  for (std::size_t frame = 0; frame < frames; frame += step) {
    std::vector<double> qpos = robot.zero_configuration();
    if (!pose(frame, qpos)) continue;
    forward_kinematics(robot, qpos, world_from_body);
    for (const PlacedBody& body : bodies) {
      const double* place = positions.data() + frame * width + 3 * body.column;
      const Eigen::Vector3d found(place[0], place[1], place[2]);
      const Eigen::Vector3d expected =
          world_from_body[static_cast<std::size_t>(body.point.body)] * body.point.place;
      const double distance = (found - expected).norm();
      if (!std::isfinite(distance)) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, distance);
    }
  }
  return largest;
}

Result<void> check_body_places(const RobotClip& clip, const RawMotion& raw, QuaternionOrder order,
                               const std::string& file) {
  if (raw.places.bodies.empty()) return {};
  const PlaceComparison comparison(clip, raw, order);
  const double distance = comparison.distance({});
  if (distance <= kPlaceTolerance) return {};
  const std::array<std::pair<OtherReading, std::string>, 4> readings = {
      {{{.other_order = true},
        std::string("the root quaternion is ") +
            (order == QuaternionOrder::kXyzw ? "w x y z" : "x y z w")},
       {{.angle = kRadiansPerDegree}, "the joints are in degrees"},
       {{.length = 0.01}, "lengths are in centimetres"},
       {{.length = 0.001}, "lengths are in millimetres"}}};
  std::string cause = "; the root or the joints may be in another order";
  for (const auto& [reading, words] : readings) {
    if (comparison.distance(reading) <= kPlaceTolerance) cause = "; they fit if " + words;
  }
  return input_failure(
      file,
      "its bodies are up to " + number_text(distance, 3) +
          " m away from the forward kinematics of the robot " + clip.robot().name() + cause,
      "is it for another robot? " OPTION("from") " " + std::string(format_name(raw.format)) +
          " reads it without this comparison");
}

void take_named_bodies(const ArraySource& file, const Robot& robot, std::string_view positions,
                       std::string_view names, RawMotion& raw) {
  const auto places = plain_array(file, positions), list = plain_array(file, names);
  if (!places || !list || !places->is_number() || !list->is_text()) return;
  const std::vector<std::string> texts = list->texts();
  if (places->shape != std::vector<std::size_t>{raw.frames, texts.size(), 3}) return;
  std::vector<PlacedBody> found;
  for (std::size_t column = 0; column < texts.size(); ++column) {
    const auto body = robot.find_body(texts[column]);
    if (body && *body > 0) found.push_back({column, {*body, Eigen::Vector3d::Zero()}});
  }
  if (found.size() < kFewestBodies) return;
  raw.places.bodies = std::move(found);
  raw.places.positions = places->numbers();
}

}  // namespace retarget
