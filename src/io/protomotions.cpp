// ProtoMotions' `.motion`: a file of PyTorch with one dictionary of tensors.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/npz_writer.h"
#include "base/option_name.h"
#include "base/suggest.h"
#include "base/torch_file.h"
#include "base/torch_writer.h"
#include "base/try.h"
#include "io/motion_writers.h"
#include "io/protomotions_bodies.h"
#include "io/raw_motion.h"
#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::string_view kEnumModule = "protomotions.simulator.base_simulator.simulator_state";
constexpr std::array<std::string_view, 2> kSides = {"left", "right"};

// arrays with one row for each body
struct BodyRows {
  std::vector<double> position, rotation_xyzw, linear, angular;

  void add(const Vector3d& at, const Quaterniond& turn, const Vector3d& velocity,
           const Vector3d& rate) {
    position.insert(position.end(), {at.x(), at.y(), at.z()});
    rotation_xyzw.insert(rotation_xyzw.end(), {turn.x(), turn.y(), turn.z(), turn.w()});
    linear.insert(linear.end(), {velocity.x(), velocity.y(), velocity.z()});
    angular.insert(angular.end(), {rate.x(), rate.y(), rate.z()});
  }
};

Vector3d vector_at(const std::vector<double>& values, std::size_t index) {
  const double* v = values.data() + 3 * index;
  return {v[0], v[1], v[2]};
}

BodyRows body_rows(const TrackingMotion& motion, const std::vector<ProtoBody>& bodies) {
  std::vector<std::size_t> carriers;
  for (const ProtoBody& body : bodies) {
    const auto found = std::ranges::find(motion.body_names, body.carrier);
    carriers.push_back(static_cast<std::size_t>(found - motion.body_names.begin()));
  }
  BodyRows rows;
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const std::size_t at = frame * motion.body_names.size() + carriers[b];
      const double* q = motion.body_quat.data() + 4 * at;
      const Quaterniond turn(q[0], q[1], q[2], q[3]);
      const Vector3d arm = turn * bodies[b].place, rate = vector_at(motion.body_ang_vel, at);
      rows.add(vector_at(motion.body_pos, at) + arm, turn,
               vector_at(motion.body_lin_vel, at) + rate.cross(arm), rate);
    }
  }
  return rows;
}

// the speed to the next frame, as ProtoMotions' own files have it; the last one's is repeated
std::vector<double> forward_speeds(const TrackingMotion& motion) {
  const std::size_t joints = motion.joint_names.size();
  std::vector<double> speeds;
  speeds.reserve(motion.joint_pos.size());
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    const std::size_t begin = std::min(frame, motion.frames - 2) * joints;
    for (std::size_t j = begin; j < begin + joints; ++j) {
      speeds.push_back((motion.joint_pos[j + joints] - motion.joint_pos[j]) * motion.rate.fps());
    }
  }
  return speeds;
}

// nothing where the feet or their contacts are not known
std::optional<std::vector<std::uint8_t>> body_contacts(const RobotClip& clip,
                                                       const std::vector<ProtoBody>& bodies,
                                                       const std::optional<FootContacts>& known) {
  if (!known) return std::nullopt;
  std::vector<std::uint8_t> contacts(bodies.size() * static_cast<std::size_t>(known->frame_count()),
                                     0);
  for (int side = 0; side < 2; ++side) {
    const auto foot = proto_foot(clip.robot(), bodies, kSides[static_cast<std::size_t>(side)]);
    if (!foot) return std::nullopt;
    for (int frame = 0; frame < known->frame_count(); ++frame) {
      if (known->foot_planted(frame, side)) {
        contacts[static_cast<std::size_t>(frame) * bodies.size() + *foot] = 1;
      }
    }
  }
  return contacts;
}

// the tensors of a file by their names
class ProtoReader {
 public:
  ProtoReader(const TorchFile& torch, const std::string& file) : torch_(torch), file_(file) {}

  // nothing where there is no such tensor
  Result<std::optional<NpyArray>> find(std::string_view key, std::size_t dimensions) const {
    const PickleDocument& document = torch_.document();
    const PickleNode* node = document.find(document.root(), key);
    if (node == nullptr || node->kind != PickleNode::Kind::kTensor) {
      return std::optional<NpyArray>();
    }
    TRY_ASSIGN(NpyArray array, torch_.read(*node, key));
    if (!array.is_number() || array.shape.size() != dimensions) {
      return input_failure(file_, "the tensor \"" + std::string(key) + "\" has the shape " +
                                      shape_text(array.shape) + ", expected " +
                                      std::to_string(dimensions) + " dimensions of numbers");
    }
    return std::optional<NpyArray>(std::move(array));
  }

  Result<NpyArray> need(std::string_view key, std::size_t dimensions) const {
    TRY_ASSIGN(auto array, find(key, dimensions));
    if (array) return std::move(*array);
    const PickleDocument& document = torch_.document();
    return input_failure(
        file_, "the file is no motion of a robot: it has no tensor \"" + std::string(key) + "\"",
        "it has " + list_names(document.keys(document.root()), 12));
  }

  Result<void> read_rate(RawMotion& raw) const {
    const PickleDocument& document = torch_.document();
    const PickleNode* fps = document.find(document.root(), "fps");
    if (fps == nullptr) return {};
    std::optional<double> value = document.number(*fps);
    if (fps->kind == PickleNode::Kind::kTensor) {
      TRY_ASSIGN(const auto array, torch_.read(*fps, "fps"));
      if (array.is_number() && array.element_count() == 1) value = array.numbers().front();
    }
    if (!value || !(*value >= kMinFileRate && *value <= kMaxFileRate)) {
      return input_failure(file_, "the file's fps is not a valid rate",
                           "give it with " OPTION("source-fps"));
    }
    raw.rate = frame_rate_from_fps(*value);
    return {};
  }

 private:
  const TorchFile& torch_;
  const std::string& file_;
};

Result<void> read_contacts(const ProtoReader& reader, const Robot& robot, std::size_t body_count,
                           RawMotion& raw) {
  TRY_ASSIGN(const auto array, reader.find("rigid_body_contacts", 2));
  const std::vector<ProtoBody> bodies = proto_bodies(robot);
  if (!array || array->shape[0] != raw.frames || array->shape[1] != body_count ||
      body_count != bodies.size()) {
    return {};
  }
  const auto left = proto_foot(robot, bodies, "left"), right = proto_foot(robot, bodies, "right");
  if (!left || !right) return {};
  const std::vector<double> values = array->numbers();
  FootContacts contacts;
  for (std::size_t frame = 0; frame < raw.frames; ++frame) {
    for (const std::size_t foot : {*left, *right}) {
      const std::uint8_t planted = values[frame * body_count + foot] > 0.5 ? 1 : 0;
      contacts.planted.insert(contacts.planted.end(), 2, planted);
    }
  }
  raw.contacts = std::move(contacts);
  return {};
}

}  // namespace

MotionFiles write_protomotions(const RobotClip& clip, MotionFormat format,
                               const WriteMotionOptions& options) {
  TrackingOptions tracking;
  tracking.rate = clip.rate();
  tracking.until_last = true;
  TRY_ASSIGN(const auto motion, tracking_with_contacts(clip, format, options, tracking));
  const std::vector<ProtoBody> bodies = proto_bodies(clip.robot());
  const BodyRows rows = body_rows(motion, bodies);
  const std::size_t frames = motion.frames, joints = motion.joint_names.size();
  TorchWriter torch;
  torch.enum_member("state_conversion", kEnumModule, "StateConversion", "common");
  if (clip.rate().seconds == 1) {
    torch.integer("fps", clip.rate().frames);
  } else {
    torch.number("fps", clip.rate().fps());
  }
  torch.tensor("dof_pos", float32_array(motion.joint_pos, {frames, joints}));
  torch.tensor("dof_vel", float32_array(forward_speeds(motion), {frames, joints}));
  torch.tensor("rigid_body_pos", float32_array(rows.position, {frames, bodies.size(), 3}));
  torch.tensor("rigid_body_rot", float32_array(rows.rotation_xyzw, {frames, bodies.size(), 4}));
  torch.tensor("rigid_body_vel", float32_array(rows.linear, {frames, bodies.size(), 3}));
  torch.tensor("rigid_body_ang_vel", float32_array(rows.angular, {frames, bodies.size(), 3}));
  if (const auto contacts = body_contacts(clip, bodies, motion.contacts)) {
    torch.tensor("rigid_body_contacts", bool_array(*contacts, {frames, bodies.size()}));
  }
  return one_file(torch.finish("motion"));
}

Result<RawMotion> read_protomotions(std::string_view bytes,
                                    const std::shared_ptr<const Robot>& robot,
                                    const std::string& file, const ReadMotionOptions& options) {
  TorchReadOptions torch_options;
  torch_options.max_number_bytes = options.max_bytes;
  TRY_ASSIGN(const auto torch, TorchFile::open(bytes, file, torch_options));
  if (torch.document().root().kind != PickleNode::Kind::kDict) {
    return input_failure(file, "the file of PyTorch does not hold a motion of a robot",
                         "ProtoMotions' dictionary (dof_pos, rigid_body_pos, rigid_body_rot) is "
                         "supported");
  }
  const ProtoReader reader(torch, file);
  TRY_ASSIGN(const auto joints, reader.need("dof_pos", 2));
  TRY_ASSIGN(const auto positions, reader.need("rigid_body_pos", 3));
  TRY_ASSIGN(const auto rotations, reader.need("rigid_body_rot", 3));
  const std::size_t frames = joints.shape[0], bodies = positions.shape[1];
  const bool fits = positions.shape[0] == frames && rotations.shape[0] == frames && bodies > 0 &&
                    rotations.shape[1] == bodies && positions.shape[2] == 3 &&
                    rotations.shape[2] == 4;
  if (!fits) return input_failure(file, "its tensors disagree about frames or bodies");
  if (frames == 0) return input_failure(file, "the file holds no frames");
  RawMotion raw;
  raw.format = MotionFormat::kProtoMotions;
  raw.order = raw.usual = QuaternionOrder::kXyzw;
  raw.metres_per_unit = 1.0;
  raw.degrees = false;
  raw.frames = frames;
  raw.joint_count = joints.shape[1];
  raw.joints = joints.numbers();
  const std::vector<double> places = positions.numbers(), turns = rotations.numbers();
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto place = places.begin() + static_cast<std::ptrdiff_t>(3 * frame * bodies);
    const auto turn = turns.begin() + static_cast<std::ptrdiff_t>(4 * frame * bodies);
    raw.position.insert(raw.position.end(), place, place + 3);
    raw.rotation.insert(raw.rotation.end(), turn, turn + 4);
  }
  // the joints of a layout, which are in the model's order
  const TrackingLayout layout = tracking_layout(*robot, MotionFormat::kProtoMotions);
  if (layout.joints.size() == raw.joint_count) raw.joint_indices = layout.joints;
  TRY(reader.read_rate(raw));
  TRY(read_contacts(reader, *robot, bodies, raw));
  return raw;
}

}  // namespace retarget
