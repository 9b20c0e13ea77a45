#include "io/protomotions_bodies.h"

#include <algorithm>

#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// what ProtoMotions' model of the G1 (g1_bm_box_feet.xml) has besides Unitree's: in front of which
// body, to what it is fixed and where
struct OwnBody {
  std::string_view before, name, carrier;
  double x, z;
};
constexpr OwnBody kOwnBodiesOfG1[] = {
    {"left_hip_pitch_link", "head", "pelvis", 0.0, 0.4},
    {"right_shoulder_pitch_link", "left_rubber_hand", "left_wrist_yaw_link", 0.12, 0.0},
    {"", "right_rubber_hand", "right_wrist_yaw_link", 0.12, 0.0}};

void add_own_bodies(std::string_view before, std::vector<ProtoBody>& bodies) {
  for (const OwnBody& own : kOwnBodiesOfG1) {
    if (own.before != before) continue;
    bodies.push_back(
        {std::string(own.name), std::string(own.carrier), Eigen::Vector3d(own.x, 0.0, own.z)});
  }
}

}  // namespace

std::vector<ProtoBody> proto_bodies(const Robot& robot) {
  const TrackingLayout layout = tracking_layout(robot, MotionFormat::kProtoMotions);
  constexpr std::size_t kJointsOfG1 = 29;
  const bool is_g1 = robot.name() == "unitree_g1" && layout.joints.size() == kJointsOfG1;
  std::vector<ProtoBody> bodies;
  for (const int body : layout.bodies) {
    const std::string& name = robot.bodies()[body].name;
    if (is_g1) add_own_bodies(name, bodies);
    bodies.push_back({name, name});
  }
  if (is_g1) add_own_bodies("", bodies);
  return bodies;
}

std::optional<std::size_t> proto_foot(const Robot& robot, const std::vector<ProtoBody>& bodies,
                                      std::string_view side) {
  for (const Sole& sole : robot.profile().soles) {
    if (sole.side != side) continue;
    // the body itself, or the one that it is fixed to
    for (int body = sole.body; body > 0; body = robot.bodies()[body].parent) {
      const auto found = std::ranges::find(bodies, robot.bodies()[body].name, &ProtoBody::name);
      if (found != bodies.end()) return static_cast<std::size_t>(found - bodies.begin());
    }
  }
  return std::nullopt;
}

}  // namespace retarget
