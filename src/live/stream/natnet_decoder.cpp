// Decodes skeletons of OptiTrack's NatNet, versions 3.0 to 4.x. The decoder requests the version
// and the bone descriptions from the server, because frames contain only IDs and poses. The server
// does not state whether poses are in the world or relative to parents; this is inferred from the
// bone positions.

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "live/stream/message_cutter.h"
#include "live/stream/natnet_protocol.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/bvh.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Sorts bones so that parents precede children. Errors: the bones do not form a tree.
Result<std::vector<const NatNetBone*>> ordered_bones(const NatNetSkeleton& skeleton) {
  constexpr std::size_t kMaxBones = 500;
  constexpr double kMaxOffset = 1e3;  // metres
  if (skeleton.bones.empty() || skeleton.bones.size() > kMaxBones) {
    return bad_packet(fmt::format("expected a skeleton of 1 to {} bones", kMaxBones));
  }
  std::vector<const NatNetBone*> ordered;
  std::set<int> placed;
  std::vector<char> taken(skeleton.bones.size(), 0);
  // Each pass places all bones whose parents are already placed.
  constexpr int kMostPasses = 32;
  bool found = true;
  for (int pass = 0; found && pass < kMostPasses; ++pass) {
    found = false;
    for (std::size_t i = 0; i < skeleton.bones.size(); ++i) {
      const NatNetBone& bone = skeleton.bones[i];
      const bool is_root = bone.parent <= 0;
      if (taken[i] != 0 || (!is_root && !placed.contains(bone.parent))) continue;
      if ((is_root && !ordered.empty()) || !placed.insert(bone.id).second) {
        return bad_packet("two bones of a skeleton have the same ID, or no parent");
      }
      if (!(bone.offset.norm() < kMaxOffset))
        return bad_packet("a bone offset is not a number or too large");
      ordered.push_back(&bone);
      taken[i] = 1;
      found = true;
    }
  }
  if (ordered.size() < skeleton.bones.size()) {
    return bad_packet("the skeleton has bones without a valid parent");
  }
  return ordered;
}

// Removes the skeleton's name from the front of a bone's name: `Anna_Hip`, `Anna:Hip`.
std::string plain_bone_name(const std::string& bone, const std::string& skeleton) {
  const bool has_prefix = bone.size() > skeleton.size() + 1 && bone.starts_with(skeleton) &&
                          (bone[skeleton.size()] == '_' || bone[skeleton.size()] == ':');
  return has_prefix ? bone.substr(skeleton.size() + 1) : bone;
}

// Mean distance of the bones from their expected positions, metres.
struct PlaceErrors {
  double world = 0.0;  // Poses interpreted in the world.
  double local = 0.0;  // Poses interpreted relative to parents.
};

// @param metres  unit of the joints' offsets in metres
PlaceErrors place_errors(std::span<const StreamJoint> joints, double metres,
                         std::span<const Pose> poses) {
  PlaceErrors errors;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].parent < 0) continue;
    const Pose& parent = poses[static_cast<std::size_t>(joints[i].parent)];
    const Eigen::Vector3d offset = metres * joints[i].offset;
    errors.local += (poses[i].translation - offset).norm();
    errors.world += (parent.inverse() * poses[i].translation - offset).norm();
  }
  const double count = std::max<double>(1.0, static_cast<double>(joints.size()) - 1.0);
  errors.local /= count;
  errors.world /= count;
  return errors;
}

constexpr int kCommandPort = 1510;

class NatNetDecoder final : public Decoder {
 public:
  explicit NatNetDecoder(const StreamAddress& from);
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) override {
    skeleton_.know(skeleton);
  }
  void restart() override;
  [[nodiscard]] std::string_view request() const override;
  [[nodiscard]] std::string lack() const override;

 private:
  Result<void> take_message(std::string_view bytes, StreamSink& sink);
  Result<void> take_models(std::string_view payload, StreamSink& sink);
  Result<void> take_frame(std::string_view payload, StreamSink& sink);
  Result<void> learn_by_order(StreamSink& sink);
  [[nodiscard]] bool waits_for_server();
  [[nodiscard]] Failure unknown_version() const;
  [[nodiscard]] std::string undescribed() const;
  Result<void> place_bones();
  void decide_coordinates();

  bool datagrams_;
  std::string server_;  // Address of Motive's command port; empty: none is given.
  std::optional<int> actor_;
  std::optional<NatNetVersion> chosen_version_;
  std::optional<bool> chosen_local_;
  MessageCutter cutter_{kNatNetHeaderSize, natnet_message_size};

  std::optional<NatNetVersion> version_;
  bool server_answered_ = false;
  bool wants_models_ = true;
  int frames_waited_ = 0;
  StreamSkeleton skeleton_;
  std::vector<int> ids_;         // Bone IDs, by joint.
  std::optional<int> streamed_;  // ID of the skeleton.
  std::optional<bool> is_local_;
  NatNetFrame frame_;
  std::vector<Pose> poses_;
};

std::string command_address(const StreamAddress& from) {
  const std::string server = from.extra("server"), command = from.extra("command");
  if (server.empty()) return {};
  return server + ":" + (command.empty() ? std::to_string(kCommandPort) : command);
}

NatNetDecoder::NatNetDecoder(const StreamAddress& from)
    : datagrams_(from.transport == Transport::kUdp),
      server_(command_address(from)),
      actor_(parse_number<int>(from.extra("actor"))),
      chosen_version_(natnet_version(from.extra("version"))),
      version_(chosen_version_) {
  const std::string coordinates = from.extra("coordinates");
  if (!coordinates.empty()) chosen_local_ = coordinates == "local";
}

void NatNetDecoder::restart() {
  cutter_.clear();
  version_ = chosen_version_;
  server_answered_ = false;
  wants_models_ = true;
  frames_waited_ = 0;
  ids_.clear();
  skeleton_.forget();
}

// Connects until the server has answered; afterwards requests models or keeps the connection alive.
std::string_view NatNetDecoder::request() const {
  static constexpr std::string_view kConnect("\0\0\x05\0Ping\0", 9);
  static constexpr std::string_view kModelsRequest("\x04\0\0\0", 4);
  static constexpr std::string_view kKeepAlive("\x0A\0\0\0", 4);
  if (!server_answered_) return kConnect;
  return wants_models_ ? kModelsRequest : kKeepAlive;
}

std::string NatNetDecoder::lack() const {
  if (server_.empty() || server_answered_) return {};
  return fmt::format("Motive's command port {} does not answer", server_);
}

Result<void> NatNetDecoder::take(std::string_view bytes, StreamSink& sink) {
  if (datagrams_) return take_message(bytes, sink);
  return cutter_.take(bytes, [&](std::string_view message) { return take_message(message, sink); });
}

Result<void> NatNetDecoder::take_message(std::string_view bytes, StreamSink& sink) {
  const auto type = natnet_message_type(bytes);
  if (!type) return bad_packet("not a NatNet message");
  const std::string_view payload = bytes.substr(kNatNetHeaderSize);
  if (bytes.size() < natnet_message_size(bytes).value_or(0)) {
    return bad_packet("truncated NatNet message");
  }
  switch (*type) {
    case NatNetMessage::kServerInfo: {
      RETARGET_TRY_ASSIGN(version_, read_natnet_server(payload));
      server_answered_ = true;
      return {};
    }
    case NatNetMessage::kModels:
      return take_models(payload, sink);
    case NatNetMessage::kFrame:
      return take_frame(payload, sink);
    default:
      return {};
  }
}

Failure NatNetDecoder::unknown_version() const {
  if (const std::string why = lack(); !why.empty()) {
    return bad_packet("unknown NatNet version: " + why + "; ?version=4.1 sets it");
  }
  return bad_packet(
      "unknown NatNet version: query it with ?server=ADDRESS of Motive's computer, or set it with "
      "?version=4.1");
}

Result<void> NatNetDecoder::take_models(std::string_view payload, StreamSink& sink) {
  if (!version_) return unknown_version();
  RETARGET_TRY_ASSIGN(const auto skeletons, read_natnet_skeletons(payload, *version_));
  const auto wanted = std::ranges::find_if(
      skeletons, [&](const NatNetSkeleton& skeleton) { return !actor_ || skeleton.id == *actor_; });
  if (wanted == skeletons.end()) {
    const std::string which = actor_ ? fmt::format(" {}", *actor_) : std::string();
    return bad_packet("Motive streams no skeleton" + which +
                      ": enable Skeletons in its streaming settings");
  }
  RETARGET_TRY_ASSIGN(const auto bones, ordered_bones(*wanted));
  wants_models_ = false;
  std::vector<std::string> names;
  names.reserve(bones.size());
  for (const NatNetBone* bone : bones) names.push_back(plain_bone_name(bone->name, wanted->name));
  names = plain_joint_names(std::move(names));
  ids_.clear();
  std::vector<StreamJoint> joints;
  for (const NatNetBone* bone : bones) {
    const auto parent = std::ranges::find(ids_, bone->parent);
    joints.push_back({names[ids_.size()],
                      parent == ids_.end() ? -1 : static_cast<int>(parent - ids_.begin()),
                      bone->offset});
    ids_.push_back(bone->id);
  }
  streamed_ = wanted->id;
  is_local_ = chosen_local_;
  // The zero pose of Motive's skeletons is a T-pose, but that of other senders may differ.
  skeleton_.set_joints(std::move(joints), Eigen::Vector3d::UnitY(), false, sink);
  return {};
}

Result<void> NatNetDecoder::take_frame(std::string_view payload, StreamSink& sink) {
  const bool described = !ids_.empty();
  if ((!version_ || !described) && waits_for_server()) return {};
  if (!version_) return unknown_version();
  RETARGET_TRY(read_natnet_frame(payload, *version_, described ? streamed_ : actor_, frame_));
  if (frame_.models_changed || !frame_.skeleton) wants_models_ = true;
  if (!frame_.skeleton) return bad_packet("the frame lacks the skeleton");
  const bool tracked = std::ranges::any_of(frame_.bones, &NatNetBonePose::is_tracked);
  if (!tracked) return {};
  if (!described) RETARGET_TRY(learn_by_order(sink));
  RETARGET_TRY(place_bones());
  decide_coordinates();
  for (std::size_t i = 0; *is_local_ && i < poses_.size(); ++i) {
    const int parent = skeleton_.joints()[i].parent;
    if (parent >= 0) poses_[i] = poses_[static_cast<std::size_t>(parent)] * poses_[i];
  }
  skeleton_.give(frame_.time, poses_, sink);
  return {};
}

// While requests are pending, frames that cannot be interpreted yet are not an error.
bool NatNetDecoder::waits_for_server() {
  constexpr int kFrames = 250;
  return !server_.empty() && frames_waited_++ < kFrames;
}

// Copies the poses of a frame in the order of the joints.
Result<void> NatNetDecoder::place_bones() {
  poses_.resize(ids_.size());
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    // Bones usually arrive in joint order.
    const auto here = i < frame_.bones.size() && frame_.bones[i].id == ids_[i]
                          ? frame_.bones.begin() + static_cast<std::ptrdiff_t>(i)
                          : std::ranges::find(frame_.bones, ids_[i], &NatNetBonePose::id);
    if (here == frame_.bones.end()) {
      wants_models_ = true;
      return bad_packet(fmt::format("the frame lacks the bone {}", skeleton_.joints()[i].name));
    }
    poses_[i] = here->pose;
  }
  return {};
}

void NatNetDecoder::decide_coordinates() {
  if (is_local_) return;
  const PlaceErrors errors = place_errors(skeleton_.joints(), 1.0, poses_);
  is_local_ = errors.local < errors.world;
}

std::string NatNetDecoder::undescribed() const {
  if (server_.empty()) {
    return "the bones are not described (query them with ?server=ADDRESS of Motive's computer)";
  }
  const std::string why = lack();
  return "the bones are not described: " +
         (why.empty() ? fmt::format("Motive's command port {} sent no skeletons", server_) : why);
}

// Handles bones without a description if the user named a file: they are its joints if their number
// and their positions match.
Result<void> NatNetDecoder::learn_by_order(StreamSink& sink) {
  if (skeleton_.known() == nullptr) return bad_packet(undescribed());
  const Skeleton& known = *skeleton_.known();
  if (frame_.bones.size() != static_cast<std::size_t>(known.joint_count())) {
    return bad_packet(fmt::format("{}: received {}, but the skeleton file has {}", undescribed(),
                                  frame_.bones.size(), count_text(known.joint_count(), "joint")));
  }
  std::vector<int> ids;
  std::vector<StreamJoint> joints;
  std::vector<Pose> poses;
  double length = 0.0;
  for (int i = 0; i < known.joint_count(); ++i) {
    const NatNetBonePose& bone = frame_.bones[static_cast<std::size_t>(i)];
    ids.push_back(bone.id);
    poses.push_back(bone.pose);
    joints.push_back({known.joint(i).name, known.joint(i).parent, known.joint(i).offset});
    if (i > 0) length += known.joint(i).offset.norm() / known.joint_count();
  }
  double best = std::numeric_limits<double>::infinity(), metres = 1.0;
  for (const double units : kUnitsPerMetre) {
    const PlaceErrors errors = place_errors(joints, 1.0 / units, poses);
    const double error = std::min(errors.local, errors.world) * units;
    if (error < best) {
      best = error;
      metres = 1.0 / units;
    }
  }
  constexpr double kMaxError = 0.15;  // Fraction of the bone length.
  if (!(best < kMaxError * length)) {
    return bad_packet(undescribed() + ", and their positions do not match the skeleton file");
  }
  for (StreamJoint& joint : joints) joint.offset *= metres;
  ids_ = std::move(ids);
  streamed_ = frame_.skeleton;
  is_local_ = chosen_local_;
  skeleton_.set_joints(std::move(joints), Eigen::Vector3d::UnitY(), false, sink);
  return {};
}

}  // namespace

StreamFormat natnet_format() {
  static constexpr std::array kExtras = {
      kActorNumber,
      StreamExtra{"version", "a NatNet version of at least 3.0, such as version=4.1",
                  [](const std::string& value) { return natnet_version(value).has_value(); }},
      StreamExtra{"coordinates", "local or global",
                  [](const std::string& value) { return value == "local" || value == "global"; }}};
  return {.name = "natnet",
          .description =
              "OptiTrack Motive, NatNet 3.0 to 4.x; ?server=ADDRESS for the skeleton, "
              "?multicast=239.255.42.99, ?version=4.1, ?actor=N",
          .port = 1511,
          .is_text = false,
          .decoder = [](const StreamAddress& from) -> std::unique_ptr<Decoder> {
            return std::make_unique<NatNetDecoder>(from);
          },
          .encoder = make_natnet_encoder,
          .is_metric = true,
          .request_port = kCommandPort,
          .extras = kExtras};
}

}  // namespace retarget
