// Decodes motions of SMPL, SMPL+H and SMPL-X as JSON, one object per line (docs/live.md): rotation
// vectors named as in the models' software and AMASS, for a body that is sent once.

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/message_cutter.h"
#include "live/stream/stream_formats.h"
#include "retarget/smpl.h"
#include "retarget/so3.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::size_t kBodyNumbers = 3 * (kSmplJointCount - 1);
constexpr std::size_t kHandNumbers = 3 * kSmplHandJointCount / 2;
constexpr double kMaxAngle = 100.0;  // Rad; larger values are probably degrees.
constexpr double kMaxPlace = 1e4;    // Metres.
constexpr double kMaxBeta = 100.0;

// Appends the numbers of a list or of nested lists, such as one per joint.
bool append_numbers(const PacketJson& json, double limit, int depth, std::vector<double>& numbers) {
  constexpr int kDeepest = 2;
  if (json.is_number()) {
    numbers.push_back(json.get<double>());
    return std::abs(numbers.back()) <= limit;
  }
  if (!json.is_array() || depth == kDeepest) return false;
  return std::ranges::all_of(json, [&](const PacketJson& each) {
    return append_numbers(each, limit, depth + 1, numbers);
  });
}

Result<std::vector<double>> numbers_of(const PacketJson& json, const char* what, double limit,
                                       std::size_t at_least, std::size_t at_most) {
  std::vector<double> numbers;
  if (!append_numbers(json, limit, 0, numbers) || numbers.size() < at_least ||
      numbers.size() > at_most) {
    return bad_packet(fmt::format(
        "{}: expected {} numbers within {}", what,
        at_least == at_most ? std::to_string(at_least) : fmt::format("{} to {}", at_least, at_most),
        limit));
  }
  return numbers;
}

Eigen::Vector3d vector_at(const std::vector<double>& numbers, std::size_t begin) {
  return {numbers[begin], numbers[begin + 1], numbers[begin + 2]};
}

// A body as described by lines.
struct ReceivedBody {
  std::optional<SmplRestBody> offsets;  // Body with its own bone offsets.
  std::optional<double> height;
  std::vector<double> betas;
  bool y_is_up = false;
};

Result<void> read_body(const PacketJson& line, ReceivedBody& body) {
  constexpr std::size_t kMaxBetas = 400;
  constexpr std::size_t kOffsetNumbers = 3 * kSmplJointCount, kMostJoints = 60;
  if (const PacketJson* up = find_member(line, {"up"})) {
    if (*up != "y" && *up != "z") return bad_packet("\"up\" must be \"y\" or \"z\"");
    body.y_is_up = *up == "y";
  }
  if (const PacketJson* height = find_member(line, {"height"})) {
    if (!height->is_number() || !is_human_height(height->get<double>())) {
      return bad_packet("\"height\" must be a human height in metres");
    }
    body.height = height->get<double>();
  }
  if (const PacketJson* betas = find_member(line, {"betas"})) {
    RETARGET_TRY_ASSIGN(body.betas, numbers_of(*betas, "\"betas\"", kMaxBeta, 0, kMaxBetas));
  }
  if (const PacketJson* offsets = find_member(line, {"rest_offsets"})) {
    RETARGET_TRY_ASSIGN(const auto numbers, numbers_of(*offsets, "\"rest_offsets\"", kMaxPlace,
                                                       kOffsetNumbers, 3 * kMostJoints));
    std::vector<Eigen::Vector3d> places;
    for (std::size_t i = 0; i < kOffsetNumbers; i += 3) places.push_back(vector_at(numbers, i));
    body.offsets = smpl_rest_body_of_offsets(places);
    if (!body.offsets) {
      return bad_packet("\"rest_offsets\" are not the joints of a body in T-pose, in metres");
    }
  }
  return {};
}

Result<SmplRestBody> received_rest_body(const ReceivedBody& told) {
  if (told.offsets) {
    SmplRestBody body = *told.offsets;
    body.height = told.height.value_or(body.height);
    return body;
  }
  const double height = told.height.value_or(smpl_height_of_betas(told.betas));
  if (!is_human_height(height))
    return bad_packet("the first of the \"betas\" is not that of a human");
  return generic_smpl_rest_body(height);
}

class SmplxDecoder final : public Decoder {
 public:
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) override;
  void restart() override { has_skeleton_ = false; }

 private:
  Result<void> send_skeleton(const ReceivedBody& told, StreamSink& sink);
  Result<void> read_rotations(const PacketJson& line);
  Result<void> take_frame(const PacketJson& line, StreamSink& sink);

  bool is_known_ = false;      // The skeleton comes from the user's file.
  bool has_skeleton_ = false;  // The body has been received.
  bool y_is_up_ = false;
  Eigen::Vector3d pelvis_ = Eigen::Vector3d::Zero();  // In the body's axes.
  std::vector<int> order_;                            // Order of the skeleton's joints.
  std::vector<Eigen::Vector3d> rotations_, hand_rotations_;
  StreamFrame frame_;
};

// Accepts the skeleton of a motion of the same body: its bones come from the file or from a model.
void SmplxDecoder::know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) {
  for (const bool fingers : {false, true}) {
    const auto names = smpl_skeleton(generic_smpl_rest_body(1.7), fingers)->names();
    if (names != skeleton->names() || skeleton->translated_count() != 1) continue;
    is_known_ = true;
    order_ = smpl_skeleton_order(fingers);
    pelvis_ = skeleton->joint(0).offset;
  }
}

Result<void> SmplxDecoder::take(std::string_view bytes, StreamSink& sink) {
  RETARGET_TRY_ASSIGN(const PacketJson line, parse_json_line(bytes));
  const bool is_frame = find_member(line, {"global_orient", "root_orient", "body_pose", "pose_body",
                                           "poses", "transl", "trans"}) != nullptr;
  const bool is_body =
      find_member(line, {"betas", "gender", "height", "rest_offsets", "up"}) != nullptr;
  if (!is_frame && !is_body) {
    return bad_packet("expected a frame with \"body_pose\" or a body with \"betas\"");
  }
  // A body is accepted once or from a separate line, because shape estimates change with every
  // frame.
  if (!has_skeleton_ || !is_frame) {
    ReceivedBody told;
    RETARGET_TRY(read_body(line, told));
    if (is_frame) RETARGET_TRY(read_rotations(line));
    if (is_known_) {
      y_is_up_ = told.y_is_up;
      has_skeleton_ = true;
    } else {
      RETARGET_TRY(send_skeleton(told, sink));
    }
  }
  return is_frame ? take_frame(line, sink) : Result<void>{};
}

Result<void> SmplxDecoder::send_skeleton(const ReceivedBody& told, StreamSink& sink) {
  RETARGET_TRY_ASSIGN(const SmplRestBody body, received_rest_body(told));
  Clip clip(smpl_skeleton(body), FrameRate{}, 1);
  order_ = smpl_skeleton_order();
  pelvis_ = body.joints[0];
  y_is_up_ = told.y_is_up;
  has_skeleton_ = true;
  // The body stands upright with its soles near the floor.
  const std::vector<Eigen::Vector3d> zero(kSmplJointCount, Eigen::Vector3d::Zero());
  Eigen::Vector3d& pelvis = clip.translations(0)[0];
  pelvis = pelvis_ - Eigen::Vector3d(0.0, body.tips[kLeftToes].y(), 0.0);
  pose_smpl_skeleton(order_, zero, {}, true, clip.rotations(0), pelvis);
  ClipOrigin origin;
  origin.name = "stream";
  origin.metres_per_unit = 1.0;
  origin.up = Eigen::Vector3d::UnitZ();
  origin.body_height = body.height;
  clip.set_origin(std::move(origin));
  sink.take_skeleton(std::move(clip), false);
  return {};
}

// Validates hand rotations but ignores them, because streams have no hand joints.
Result<void> SmplxDecoder::read_rotations(const PacketJson& line) {
  constexpr std::size_t kNumbers = 3 * kSmplJointCount, kMaxNumbers = 165;
  constexpr std::size_t kSmplBodyNumbers = 69;  // SMPL's own body includes two hand joints.
  std::vector<double> numbers;
  if (const PacketJson* poses = find_member(line, {"poses"})) {
    RETARGET_TRY_ASSIGN(numbers, numbers_of(*poses, "\"poses\"", kMaxAngle, kNumbers, kMaxNumbers));
  } else {
    const PacketJson* root = find_member(line, {"root_orient", "global_orient"});
    const PacketJson* body = find_member(line, {"pose_body", "body_pose"});
    if (root == nullptr || body == nullptr) {
      return bad_packet("a frame must have \"global_orient\" and \"body_pose\"");
    }
    RETARGET_TRY_ASSIGN(numbers, numbers_of(*root, "\"global_orient\"", kMaxAngle, 3, 3));
    RETARGET_TRY_ASSIGN(const auto joints, numbers_of(*body, "\"body_pose\"", kMaxAngle,
                                                      kBodyNumbers, kSmplBodyNumbers));
    numbers.insert(numbers.end(), joints.begin(), joints.end());
  }
  for (const char* hand : {"left_hand_pose", "right_hand_pose"}) {
    if (const PacketJson* json = find_member(line, {hand})) {
      RETARGET_TRY(numbers_of(*json, hand, kMaxAngle, 1, kHandNumbers));
    }
  }
  rotations_.clear();
  for (std::size_t i = 0; i < kNumbers; i += 3) rotations_.push_back(vector_at(numbers, i));
  return {};
}

Result<void> SmplxDecoder::take_frame(const PacketJson& line, StreamSink& sink) {
  RETARGET_TRY(read_rotations(line));
  const PacketJson* transl = find_member(line, {"transl", "trans"});
  if (transl == nullptr) return bad_packet("a frame must have \"transl\"");
  RETARGET_TRY_ASSIGN(const auto place, numbers_of(*transl, "\"transl\"", kMaxPlace, 3, 3));
  frame_.time = std::numeric_limits<double>::quiet_NaN();
  if (const PacketJson* time = find_member(line, {"time"})) {
    constexpr double kMaxTime = 1e12;
    if (!time->is_number() || std::abs(time->get<double>()) > kMaxTime) {
      return bad_packet("\"time\" must be a number of seconds");
    }
    frame_.time = time->get<double>();
  }
  hand_rotations_.assign(kSmplHandJointCount, Eigen::Vector3d::Zero());
  frame_.rotations.resize(order_.size());
  frame_.translations.assign(1, vector_at(place, 0) + pelvis_);
  pose_smpl_skeleton(order_, rotations_, hand_rotations_, y_is_up_, frame_.rotations,
                     frame_.translations[0]);
  sink.take_frame(frame_);
  return {};
}

// Encodes motions of SMPL as lines of JSON: motions read from SMPL files unchanged, other clips as
// the canonical human, whose bones correspond to SMPL's first 22 joints.

using Json = nlohmann::ordered_json;

// Indexed like kSmplJointNames.
constexpr auto kBones = std::to_array<Bone>(
    {Bone::kHips,      Bone::kLeftUpLeg,    Bone::kRightUpLeg,    Bone::kSpine,
     Bone::kLeftLeg,   Bone::kRightLeg,     Bone::kSpine1,        Bone::kLeftFoot,
     Bone::kRightFoot, Bone::kSpine2,       Bone::kLeftToe,       Bone::kRightToe,
     Bone::kNeck,      Bone::kLeftShoulder, Bone::kRightShoulder, Bone::kHead,
     Bone::kLeftArm,   Bone::kRightArm,     Bone::kLeftForeArm,   Bone::kRightForeArm,
     Bone::kLeftHand,  Bone::kRightHand});
static_assert(kBones.size() == kSmplJointCount);

// Joints indexed like kSmplJointNames if the skeleton has all of them with SMPL's parents;
// otherwise empty.
std::vector<int> smpl_joints_of(const Skeleton& skeleton) {
  std::vector<int> joints;
  for (int i = 0; i < kSmplJointCount; ++i) {
    const auto found = skeleton.find(kSmplJointNames[static_cast<std::size_t>(i)]);
    const int parent = kSmplParents[static_cast<std::size_t>(i)];
    if (!found || skeleton.joint(*found).parent !=
                      (parent < 0 ? -1 : joints[static_cast<std::size_t>(parent)])) {
      return {};
    }
    joints.push_back(*found);
  }
  return joints;
}

std::vector<Eigen::Vector3d> offsets_of(const Skeleton& skeleton, const std::vector<int>& joints) {
  std::vector<Eigen::Vector3d> offsets;
  offsets.reserve(joints.size());
  for (const int joint : joints) offsets.push_back(skeleton.joint(joint).offset);
  return offsets;
}

// Whether the rotations are SMPL's: the zero pose is its T-pose, in metres, and the body is upright
// in a Z-up world, as in AMASS.
bool is_smpl_motion(const Clip& clip) {
  const Skeleton& skeleton = clip.skeleton();
  const std::vector<int> joints = smpl_joints_of(skeleton);
  if (joints.empty() || skeleton.translated_count() != 1 || clip.frame_count() == 0 ||
      clip.origin().metres_per_unit.value_or(1.0) != 1.0 ||
      !smpl_rest_body_of_offsets(offsets_of(skeleton, joints))) {
    return false;
  }
  double upright = 0.0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    upright += (clip.rotations(frame)[0] * Eigen::Vector3d::UnitY()).z() / clip.frame_count();
  }
  constexpr double kUpright = 0.5;
  return upright > kUpright;
}

Json list_of(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

class SmplxEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  [[nodiscard]] Pose world_from_joint(int joint) const;

  std::vector<int> joints_;  // Of an SMPL motion; empty: canonical human.
  BonePoses bones_;
};

// Pose in SMPL's axes, which are those of its body in the T-pose. A missing joint moves with its
// parent.
Pose SmplxEncoder::world_from_joint(int joint) const {
  while (joint > 0 && !bones_.has(kBones[static_cast<std::size_t>(joint)])) {
    joint = kSmplParents[static_cast<std::size_t>(joint)];
  }
  const Bone bone = kBones[static_cast<std::size_t>(joint)];
  return bones_.has(bone) ? with_z_ahead(bones_.world_from_bone(bone)) : Pose{};
}

std::string SmplxEncoder::begin(const Clip& clip) {
  std::vector<Eigen::Vector3d> offsets;
  joints_.clear();
  if (is_smpl_motion(clip)) {
    joints_ = smpl_joints_of(clip.skeleton());
    offsets = offsets_of(clip.skeleton(), joints_);
  } else {
    // Before the first frame, the bones are in the T-pose.
    bones_ = BonePoses(clip);
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      const int parent = kSmplParents[static_cast<std::size_t>(joint)];
      offsets.push_back(parent < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                   : Eigen::Vector3d(world_from_joint(parent).inverse() *
                                                     world_from_joint(joint).translation));
    }
  }
  Json header = {{"up", "z"}};
  if (clip.origin().body_height) header["height"] = *clip.origin().body_height;
  header["rest_offsets"] = Json::array();
  for (const Eigen::Vector3d& offset : offsets) header["rest_offsets"].push_back(list_of(offset));
  return header.dump() + "\n";
}

Result<std::string> SmplxEncoder::frame(const Clip& clip, int frame) {
  if (joints_.empty()) bones_.set_frame(clip, frame);
  Eigen::Vector3d transl = Eigen::Vector3d::Zero();
  Json root, body = Json::array();
  for (int joint = 0; joint < kSmplJointCount; ++joint) {
    Eigen::Quaterniond rotation;
    if (!joints_.empty()) {
      rotation =
          clip.rotations(frame)[static_cast<std::size_t>(joints_[static_cast<std::size_t>(joint)])];
      if (joint == 0) transl = clip.translations(frame)[0];
    } else {
      const int parent = kSmplParents[static_cast<std::size_t>(joint)];
      const Pose world = world_from_joint(joint);
      rotation = parent < 0 ? world.rotation
                            : world_from_joint(parent).rotation.conjugate() * world.rotation;
      if (joint == 0) transl = world.translation;
    }
    const Json vector = list_of(log_so3(rotation));
    if (joint == 0) {
      root = vector;
    } else {
      body.insert(body.end(), vector.begin(), vector.end());
    }
  }
  const Json line = {{"time", clip.rate().time_of(frame)},
                     {"transl", list_of(transl)},
                     {"global_orient", root},
                     {"body_pose", std::move(body)}};
  return line.dump() + "\n";
}

}  // namespace

StreamFormat smplx_format() {
  return {.name = "smplx",
          .description = "rotation vectors of SMPL-X, SMPL+H or SMPL, JSON, one object per line",
          .decoder = make_decoder<SmplxDecoder>,
          .encoder = make_encoder<SmplxEncoder>,
          .plays_human = [](const Clip& clip) { return !is_smpl_motion(clip); }};
}

}  // namespace retarget
