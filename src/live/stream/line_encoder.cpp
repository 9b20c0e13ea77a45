// Encodes a clip in the line protocol (docs/live.md): JSON, one object per line.

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "live/stream/stream_formats.h"
#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

using OrderedJson = nlohmann::ordered_json;

class LineEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  static OrderedJson pose_of(const Pose& pose) {
    const Eigen::Vector3d& p = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    return OrderedJson::array({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
  }
  std::vector<Pose> world_from_joint_;
};

// The header has the zero pose to show the bone lengths; unit and axes that the file does not
// define are sent as unknown.
std::string LineEncoder::begin(const Clip& clip) {
  const Skeleton& skeleton = clip.skeleton();
  world_from_joint_.resize(static_cast<std::size_t>(skeleton.joint_count()));
  const Clip rest(clip.shared_skeleton(), FrameRate{}, 1);
  forward_kinematics(rest, 0, world_from_joint_);
  OrderedJson joints = OrderedJson::array();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Joint& joint = skeleton.joint(i);
    OrderedJson row = {{"name", joint.name}};
    row["parent"] =
        joint.parent < 0 ? OrderedJson() : OrderedJson(skeleton.joint(joint.parent).name);
    row["rest"] = pose_of(world_from_joint_[static_cast<std::size_t>(i)]);
    joints.push_back(std::move(row));
  }
  const ClipOrigin& origin = clip.origin();
  OrderedJson header = {{"pose", "any"}, {"unit", OrderedJson()}, {"up", OrderedJson()}};
  if (origin.metres_per_unit) header["unit"] = *origin.metres_per_unit;
  if (origin.body_height) header["height"] = *origin.body_height;
  for (int axis = 0; origin.up && axis < 3; ++axis) {
    if ((*origin.up)[axis] > 0.5) header["up"] = std::string(1, "xyz"[axis]);
  }
  header["joints"] = std::move(joints);
  return OrderedJson{{"skeleton", std::move(header)}}.dump() + "\n";
}

Result<std::string> LineEncoder::frame(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
  OrderedJson joints = OrderedJson::object();
  for (int i = 0; i < clip.skeleton().joint_count(); ++i) {
    joints[clip.skeleton().joint(i).name] = pose_of(world_from_joint_[static_cast<std::size_t>(i)]);
  }
  return OrderedJson{{"time", clip.rate().time_of(frame)}, {"joints", std::move(joints)}}.dump() +
         "\n";
}

}  // namespace

std::unique_ptr<Encoder> make_line_encoder() {
  return std::make_unique<LineEncoder>();
}

}  // namespace retarget
