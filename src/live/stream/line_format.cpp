// Decodes the line protocol (docs/live.md): JSON, one object per line.

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/stream/file_axes.h"
#include "live/stream/human_bones.h"
#include "live/stream/message_cutter.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr double kMaxNumber = 1e7;

// Reads a world pose: position x y z, rotation w x y z.
Result<Pose> pose_from(const PacketJson& json, const std::string& joint) {
  constexpr std::size_t kNumbers = 7;
  constexpr double kMinNorm = 1e-3;
  const auto is_number = [](const PacketJson& value) {
    return value.is_number() && std::abs(value.get<double>()) < kMaxNumber;
  };
  if (!json.is_array() || json.size() != kNumbers || !std::ranges::all_of(json, is_number)) {
    return bad_packet(fmt::format(
        "joint \"{}\": expected seven numbers, position x y z and rotation w x y z", joint));
  }
  const auto number = [&](std::size_t i) { return json[i].get<double>(); };
  const Eigen::Quaterniond rotation(number(3), number(4), number(5), number(6));
  if (rotation.norm() < kMinNorm) {
    return bad_packet(fmt::format("joint \"{}\": the rotation is zero", joint));
  }
  return Pose{rotation.normalized(), {number(0), number(1), number(2)}};
}

Result<std::optional<Eigen::Vector3d>> up_from(const PacketJson& header) {
  const PacketJson up = header.value("up", PacketJson());
  if (up.is_null()) return std::optional<Eigen::Vector3d>();
  for (int axis = 0; axis < 3; ++axis) {
    if (up == std::string(1, "xyz"[axis])) {
      return std::optional<Eigen::Vector3d>(Eigen::Vector3d::Unit(axis));
    }
  }
  return bad_packet("\"up\" must be \"x\", \"y\" or \"z\"");
}

Result<std::optional<double>> length_from(const PacketJson& header, const char* name) {
  constexpr double kMin = 1e-6, kMax = 1e3;
  const PacketJson value = header.value(name, PacketJson());
  if (value.is_null()) return std::optional<double>();
  if (value.is_number() && value.get<double>() >= kMin && value.get<double>() <= kMax) {
    return std::optional<double>(value.get<double>());
  }
  return bad_packet(fmt::format("\"{}\" must be a number of metres", name));
}

// Nothing: the sender does not know.
struct StatedUnits {
  std::optional<Eigen::Vector3d> up;
  std::optional<double> metres_per_unit;
};

Result<StatedUnits> stated_units(const PacketJson& header) {
  StatedUnits stated;
  RETARGET_TRY_ASSIGN(stated.up, up_from(header));
  RETARGET_TRY_ASSIGN(stated.metres_per_unit, length_from(header, "unit"));
  // Lengths are in metres and z is up unless the sender states otherwise.
  if (!header.contains("up")) stated.up = Eigen::Vector3d::UnitZ();
  if (!header.contains("unit")) stated.metres_per_unit = 1.0;
  return stated;
}

// Reads a skeleton from the first line: joints, parents before children, each with its world pose
// in a T-pose or in any pose that shows the bone lengths.
class HeaderReader {
 public:
  Result<void> read(const PacketJson& header);
  /// Omits a pose that only shows the bone lengths; the body is then recognised from its first
  /// frame.
  [[nodiscard]] Result<void> give(const PacketJson& header, StreamSink& sink);

  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }

 private:
  Result<void> read_joint(const PacketJson& json);

  std::vector<Joint> joints_;
  std::vector<Pose> world_from_joint_;
  bool has_poses_ = true;
};

Result<void> HeaderReader::read_joint(const PacketJson& json) {
  if (!json.is_object() || !json.contains("name") || !json["name"].is_string()) {
    return bad_packet("a joint of the skeleton must be an object with a \"name\"");
  }
  Joint joint;
  joint.name = json["name"].get<std::string>();
  if (joint.name.empty() ||
      std::ranges::any_of(joints_, [&](const Joint& other) { return other.name == joint.name; })) {
    return bad_packet(fmt::format("joint \"{}\" is duplicated or has no name", joint.name));
  }
  const PacketJson parent = json.value("parent", PacketJson());
  if (parent.is_string()) {
    const auto found = std::ranges::find(joints_, parent.get<std::string>(), &Joint::name);
    if (found == joints_.end()) {
      return bad_packet(fmt::format("joint \"{}\": its parent must come before it", joint.name));
    }
    joint.parent = static_cast<int>(found - joints_.begin());
  } else if (!parent.is_null() || !joints_.empty()) {
    return bad_packet(fmt::format("joint \"{}\": expected the name of its parent", joint.name));
  }
  Pose pose;
  if (json.contains("rest")) {
    RETARGET_TRY_ASSIGN(pose, pose_from(json["rest"], joint.name));
  } else {
    has_poses_ = false;
  }
  joint.offset = parent_from_joint(world_from_joint_, joint.parent, pose).translation;
  joint.channels = all_channels();
  joints_.push_back(std::move(joint));
  world_from_joint_.push_back(pose);
  return {};
}

Result<void> HeaderReader::read(const PacketJson& header) {
  if (!header.is_object() || !header.contains("joints") || !header["joints"].is_array() ||
      header["joints"].empty() || header["joints"].size() > kMaxStreamJoints) {
    return bad_packet(
        fmt::format("a skeleton must have \"joints\", a list of 1 to {}", kMaxStreamJoints));
  }
  for (const PacketJson& joint : header["joints"]) RETARGET_TRY(read_joint(joint));
  return {};
}

Result<void> HeaderReader::give(const PacketJson& header, StreamSink& sink) {
  ClipOrigin origin;
  origin.name = "stream";
  RETARGET_TRY_ASSIGN(const StatedUnits stated, stated_units(header));
  origin.up = stated.up;
  origin.metres_per_unit = stated.metres_per_unit;
  RETARGET_TRY_ASSIGN(origin.body_height, length_from(header, "height"));
  const PacketJson pose = header.value("pose", PacketJson("t-pose"));
  if (pose != "t-pose" && pose != "any") {
    return bad_packet("\"pose\" must be \"t-pose\" or \"any\"");
  }
  const bool is_rest = has_poses_ && pose == "t-pose";
  Clip clip(std::make_shared<const Skeleton>(joints_), FrameRate{}, is_rest ? 1 : 0);
  for (std::size_t i = 0; is_rest && i < joints_.size(); ++i) {
    const Pose local =
        parent_from_joint(world_from_joint_, joints_[i].parent, world_from_joint_[i]);
    clip.rotations(0)[i] = local.rotation.normalized();
    clip.translations(0)[i] = local.translation;
  }
  clip.set_origin(std::move(origin));
  sink.take_skeleton(std::move(clip), is_rest);
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
  void know_up(const Eigen::Vector3d& up) override { known_up_ = up; }
  std::string_view time_remedy() const override { return "add \"time\" to every frame"; }

 private:
  Result<void> use_known(const PacketJson& header, const std::vector<Joint>& joints);
  Result<void> take_frame(const PacketJson& json, StreamSink& sink);
  void set_joints(const std::vector<Joint>& joints);

  std::shared_ptr<const Skeleton> known_;  // From the user's file; null: none.
  std::optional<Eigen::Vector3d> known_up_;
  bool uses_known_ = false;  // The frames are of that skeleton.
  FileAxes known_axes_;      // Of that file, if the stream describes the same skeleton.
  std::vector<int> parents_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::vector<int> slots_;  // Translation slots; -1: none.
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
  uses_known_ = true;
}

Result<void> LineDecoder::take(std::string_view bytes, StreamSink& sink) {
  RETARGET_TRY_ASSIGN(const PacketJson json, parse_json_line(bytes));
  if (json.contains("skeleton")) {
    HeaderReader header;
    RETARGET_TRY(header.read(json["skeleton"]));
    // The user's file has more information about the same skeleton.
    if (known_ && same_tree(known_->joints(), header.joints())) {
      return use_known(json["skeleton"], header.joints());
    }
    RETARGET_TRY(header.give(json["skeleton"], sink));
    set_joints(header.joints());
    uses_known_ = false;
    return {};
  }
  return take_frame(json, sink);
}

Result<void> LineDecoder::use_known(const PacketJson& header, const std::vector<Joint>& joints) {
  RETARGET_TRY_ASSIGN(const StatedUnits stated, stated_units(header));
  std::vector<Eigen::Vector3d> of_stream, of_file;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].parent < 0) continue;
    of_stream.push_back(joints[i].offset);
    of_file.push_back(known_->joint(static_cast<int>(i)).offset);
  }
  set_joints(known_->joints());
  uses_known_ = true;
  known_axes_ = FileAxes({of_stream, stated.up}, stated.metres_per_unit, {of_file, known_up_});
  return {};
}

Result<void> LineDecoder::take_frame(const PacketJson& json, StreamSink& sink) {
  if (index_.empty()) {
    return bad_packet(
        "received a frame before the skeleton; the first line must describe the skeleton");
  }
  if (!json.contains("joints") || !json["joints"].is_object()) {
    return bad_packet("a frame must have \"joints\", an object of poses by name");
  }
  frame_.time = std::numeric_limits<double>::quiet_NaN();
  if (json.contains("time")) {
    const PacketJson& time = json["time"];
    constexpr double kMaxTime = 1e12;
    if (!time.is_number()) return bad_packet("\"time\" must be a number of seconds");
    if (std::abs(time.get<double>()) > kMaxTime) {
      return bad_packet(fmt::format("\"time\" must be in seconds, found {:g}", time.get<double>()));
    }
    frame_.time = time.get<double>();
  }
  std::ranges::fill(seen_, 0);
  for (const auto& [name, value] : json["joints"].items()) {
    const auto found = index_.find(name);
    if (found == index_.end()) continue;
    RETARGET_TRY_ASSIGN(world_from_joint_[found->second], pose_from(value, name));
    seen_[found->second] = 1;
  }
  for (const auto& [name, i] : index_) {
    if (seen_[i] == 0) return bad_packet(fmt::format("joint \"{}\" is missing", name));
  }
  const FileAxes axes = uses_known_ ? known_axes_ : FileAxes();
  for (std::size_t i = 0; i < parents_.size(); ++i) {
    const Pose local = parent_from_joint(world_from_joint_, parents_[i], world_from_joint_[i]);
    const Pose in_file = parents_[i] < 0 ? axes.root(local) : axes.child(local);
    frame_.rotations[i] = in_file.rotation.normalized();
    if (slots_[i] >= 0) {
      frame_.translations[static_cast<std::size_t>(slots_[i])] = in_file.translation;
    }
  }
  sink.take_frame(frame_);
  return {};
}

// Encodes a clip in the line protocol (docs/live.md): JSON, one object per line.

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

StreamFormat line_format() {
  return {
      .name = "lines",
      .description = "JSON, one object per line: time, named joints with position and quaternion",
      .decoder = make_decoder<LineDecoder>,
      .encoder = make_encoder<LineEncoder>,
      .is_metric = true};
}

}  // namespace retarget
