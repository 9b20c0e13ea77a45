// The line protocol (docs/live.md): JSON, one object a line.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/json.h"
#include "base/number_text.h"
#include "base/suggest.h"
#include "base/try.h"
#include "motion/forward_kinematics.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "stream/formats.h"
#include "stream/local_pose.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxLine = std::size_t{1} << 20;  // bytes
constexpr int kMaxJoints = 500;
constexpr double kMaxNumber = 1e7;
constexpr const char* kName = "the line";

Failure bad_line(std::string message) {
  return input_failure({}, std::move(message));
}

// x y z, w x y z: where a joint is in the world and how it is turned
Result<Pose> pose_from(const Json& json, const std::string& joint) {
  constexpr std::size_t kNumbers = 7;
  constexpr double kMinNorm = 1e-3;
  const auto is_number = [](const Json& value) {
    return value.is_number() && std::abs(value.get<double>()) < kMaxNumber;
  };
  if (!json.is_array() || json.size() != kNumbers || !std::ranges::all_of(json, is_number)) {
    return bad_line(fmt::format(
        "joint \"{}\": expected seven numbers, position x y z and rotation w x y z", joint));
  }
  const auto number = [&](std::size_t i) { return json[i].get<double>(); };
  const Eigen::Quaterniond rotation(number(3), number(4), number(5), number(6));
  if (rotation.norm() < kMinNorm) {
    return bad_line(fmt::format("joint \"{}\": a rotation of zeros", joint));
  }
  return Pose{rotation.normalized(), {number(0), number(1), number(2)}};
}

std::vector<Channel> all_channels() {
  using enum Channel;
  return {kXPosition, kYPosition, kZPosition, kZRotation, kYRotation, kXRotation};
}

Result<std::optional<Eigen::Vector3d>> up_from(const Json& header) {
  const Json up = header.value("up", Json());
  if (up.is_null()) return std::optional<Eigen::Vector3d>();
  for (int axis = 0; axis < 3; ++axis) {
    if (up == std::string(1, "xyz"[axis])) {
      return std::optional<Eigen::Vector3d>(Eigen::Vector3d::Unit(axis));
    }
  }
  return bad_line("\"up\" is expected to be \"x\", \"y\" or \"z\"");
}

Result<std::optional<double>> length_from(const Json& header, const char* name) {
  constexpr double kMin = 1e-6, kMax = 1e3;
  const Json value = header.value(name, Json());
  if (value.is_null()) return std::optional<double>();
  if (value.is_number() && value.get<double>() >= kMin && value.get<double>() <= kMax) {
    return std::optional<double>(value.get<double>());
  }
  return bad_line(fmt::format("\"{}\" is expected to be a number of metres", name));
}

// A skeleton as a first line tells it: joints, parents before their children, each with its pose in
// the world when the body stands in a T-pose, or in any pose that shows the bones' lengths.
class HeaderReader {
 public:
  Result<void> read(const Json& header);
  [[nodiscard]] Result<void> give(const Json& header, StreamSink& sink);

  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }

 private:
  Result<void> read_joint(const Json& json);

  std::vector<Joint> joints_;
  std::vector<Pose> world_from_joint_;
  bool has_poses_ = true;
};

Result<void> HeaderReader::read_joint(const Json& json) {
  if (!json.is_object() || !json.contains("name") || !json["name"].is_string()) {
    return bad_line("a joint of the skeleton is expected to be an object with a \"name\"");
  }
  Joint joint;
  joint.name = json["name"].get<std::string>();
  if (joint.name.empty() ||
      std::ranges::any_of(joints_, [&](const Joint& other) { return other.name == joint.name; })) {
    return bad_line(fmt::format("joint \"{}\" is there twice, or has no name", joint.name));
  }
  const Json parent = json.value("parent", Json());
  if (parent.is_string()) {
    const auto found = std::ranges::find(joints_, parent.get<std::string>(), &Joint::name);
    if (found == joints_.end()) {
      return bad_line(fmt::format("joint \"{}\": its parent must come before it", joint.name));
    }
    joint.parent = static_cast<int>(found - joints_.begin());
  } else if (!parent.is_null() || !joints_.empty()) {
    return bad_line(fmt::format("joint \"{}\": expected the name of its parent", joint.name));
  }
  Pose pose;
  if (json.contains("rest")) {
    TRY_ASSIGN(pose, pose_from(json["rest"], joint.name));
  } else {
    has_poses_ = false;
  }
  joint.offset = parent_from_joint(world_from_joint_, joint.parent, pose).translation;
  joint.channels = all_channels();
  joints_.push_back(std::move(joint));
  world_from_joint_.push_back(pose);
  return {};
}

Result<void> HeaderReader::read(const Json& header) {
  if (!header.is_object() || !header.contains("joints") || !header["joints"].is_array() ||
      header["joints"].empty() || header["joints"].size() > kMaxJoints) {
    return bad_line(
        fmt::format("a skeleton is expected to have \"joints\", a list of 1 to {}", kMaxJoints));
  }
  for (const Json& joint : header["joints"]) TRY(read_joint(joint));
  return {};
}

Result<void> HeaderReader::give(const Json& header, StreamSink& sink) {
  ClipOrigin origin;
  origin.name = "stream";
  TRY_ASSIGN(origin.up, up_from(header));
  TRY_ASSIGN(origin.metres_per_unit, length_from(header, "unit"));
  TRY_ASSIGN(origin.body_height, length_from(header, "height"));
  // lengths are metres and z is up unless the sender says otherwise, or that it does not know
  if (!header.contains("up")) origin.up = Eigen::Vector3d::UnitZ();
  if (!header.contains("unit")) origin.metres_per_unit = 1.0;
  const Json pose = header.value("pose", Json("t-pose"));
  if (pose != "t-pose" && pose != "any") {
    return bad_line("\"pose\" is expected to be \"t-pose\" or \"any\"");
  }
  Clip clip(std::make_shared<const Skeleton>(joints_), FrameRate{}, has_poses_ ? 1 : 0);
  for (std::size_t i = 0; has_poses_ && i < joints_.size(); ++i) {
    const Pose local =
        parent_from_joint(world_from_joint_, joints_[i].parent, world_from_joint_[i]);
    clip.rotations(0)[i] = local.rotation.normalized();
    clip.translations(0)[i] = local.translation;
  }
  clip.set_origin(std::move(origin));
  sink.take_skeleton(std::move(clip), has_poses_ && pose == "t-pose");
  return {};
}

bool same_tree(const std::vector<Joint>& a, const std::vector<Joint>& b) {
  return std::ranges::equal(a, b, [](const Joint& one, const Joint& other) {
    return one.name == other.name && one.parent == other.parent;
  });
}

class LineDecoder final : public Decoder {
 public:
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) override;

 private:
  Result<void> take_frame(const Json& json, StreamSink& sink);
  void set_joints(const std::vector<Joint>& joints);

  std::shared_ptr<const Skeleton> known_;  // of the user's file; null: none
  std::vector<int> parents_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::vector<int> slots_;  // of translations; -1: the joint has none
  std::vector<Pose> world_from_joint_;
  std::vector<char> seen_;
  StreamFrame frame_;
};

void LineDecoder::set_joints(const std::vector<Joint>& joints) {
  parents_.clear();
  index_.clear();
  slots_.clear();
  int slot = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    parents_.push_back(joints[i].parent);
    index_.emplace(joints[i].name, i);
    slots_.push_back(joints[i].has_position_channels() ? slot++ : -1);
  }
  world_from_joint_.assign(joints.size(), Pose{});
  seen_.assign(joints.size(), 0);
  frame_.rotations.assign(joints.size(), Eigen::Quaterniond::Identity());
  frame_.translations.assign(static_cast<std::size_t>(slot), Eigen::Vector3d::Zero());
}

void LineDecoder::know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) {
  known_ = skeleton;
  set_joints(skeleton->joints());
}

Result<void> LineDecoder::take(std::string_view bytes, StreamSink& sink) {
  if (bytes.size() > kMaxLine) return bad_line("a line of more than a megabyte");
  TRY_ASSIGN(const Json json, parse_json(bytes, kName));
  if (!json.is_object()) return bad_line("a line is expected to be a JSON object");
  if (json.contains("skeleton")) {
    HeaderReader header;
    TRY(header.read(json["skeleton"]));
    // the user's file knows more of the same skeleton
    if (known_ && same_tree(known_->joints(), header.joints())) return {};
    TRY(header.give(json["skeleton"], sink));
    set_joints(header.joints());
    return {};
  }
  return take_frame(json, sink);
}

Result<void> LineDecoder::take_frame(const Json& json, StreamSink& sink) {
  if (index_.empty()) {
    return bad_line("a frame came before the skeleton: the first line describes it");
  }
  if (!json.contains("joints") || !json["joints"].is_object()) {
    return bad_line("a frame is expected to have \"joints\", an object of poses by name");
  }
  frame_.time = std::numeric_limits<double>::quiet_NaN();
  if (json.contains("time")) {
    const Json& time = json["time"];
    constexpr double kMaxTime = 1e12;
    if (!time.is_number() || std::abs(time.get<double>()) > kMaxTime) {
      return bad_line("\"time\" is expected to be a number of seconds");
    }
    frame_.time = time.get<double>();
  }
  std::ranges::fill(seen_, 0);
  for (const auto& [name, value] : json["joints"].items()) {
    const auto found = index_.find(name);
    if (found == index_.end()) continue;
    TRY_ASSIGN(world_from_joint_[found->second], pose_from(value, name));
    seen_[found->second] = 1;
  }
  for (const auto& [name, i] : index_) {
    if (seen_[i] == 0) return bad_line(fmt::format("joint \"{}\" is missing", name));
  }
  for (std::size_t i = 0; i < parents_.size(); ++i) {
    const Pose local = parent_from_joint(world_from_joint_, parents_[i], world_from_joint_[i]);
    frame_.rotations[i] = local.rotation.normalized();
    if (slots_[i] >= 0) {
      frame_.translations[static_cast<std::size_t>(slots_[i])] = local.translation;
    }
  }
  sink.take_frame(frame_);
  return {};
}

class LineEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  static Json pose_of(const Pose& pose) {
    const Eigen::Vector3d& p = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    return Json::array({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
  }
  std::vector<Pose> world_from_joint_;
};

// The zero pose shows the bones' lengths; what a file does not say of unit and axes is not known.
std::string LineEncoder::begin(const Clip& clip) {
  const Skeleton& skeleton = clip.skeleton();
  world_from_joint_.resize(static_cast<std::size_t>(skeleton.joint_count()));
  const Clip rest(clip.shared_skeleton(), FrameRate{}, 1);
  forward_kinematics(rest, 0, world_from_joint_);
  Json joints = Json::array();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Joint& joint = skeleton.joint(i);
    Json row = {{"name", joint.name}};
    row["parent"] = joint.parent < 0 ? Json() : Json(skeleton.joint(joint.parent).name);
    row["rest"] = pose_of(world_from_joint_[static_cast<std::size_t>(i)]);
    joints.push_back(std::move(row));
  }
  const ClipOrigin& origin = clip.origin();
  Json header = {{"pose", "any"}, {"unit", Json()}, {"up", Json()}};
  if (origin.metres_per_unit) header["unit"] = *origin.metres_per_unit;
  if (origin.body_height) header["height"] = *origin.body_height;
  for (int axis = 0; origin.up && axis < 3; ++axis) {
    if ((*origin.up)[axis] > 0.5) header["up"] = std::string(1, "xyz"[axis]);
  }
  header["joints"] = std::move(joints);
  return Json{{"skeleton", std::move(header)}}.dump() + "\n";
}

Result<std::string> LineEncoder::frame(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
  Json joints = Json::object();
  for (int i = 0; i < clip.skeleton().joint_count(); ++i) {
    joints[clip.skeleton().joint(i).name] = pose_of(world_from_joint_[static_cast<std::size_t>(i)]);
  }
  return Json{{"time", clip.rate().time_of(frame)}, {"joints", std::move(joints)}}.dump() + "\n";
}

}  // namespace

std::unique_ptr<Decoder> make_line_decoder(const StreamAddress&) {
  return std::make_unique<LineDecoder>();
}

std::unique_ptr<Encoder> make_line_encoder() {
  return std::make_unique<LineEncoder>();
}

}  // namespace retarget
