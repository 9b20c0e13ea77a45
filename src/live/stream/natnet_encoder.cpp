// Encodes a clip as the skeleton of a NatNet server, version 4.1: each joint is a bone, metres, Y
// up, world poses. Answers the requests of receivers.

#include <string>
#include <vector>

#include "live/stream/clip_axes.h"
#include "live/stream/natnet_protocol.h"
#include "live/stream/stream_formats.h"
#include "retarget/clip.h"

namespace retarget {
namespace {

constexpr NatNetVersion kPlayedVersion = {4, 1};

class NatNetEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;
  std::string answer(std::string_view request) override;
  [[nodiscard]] std::size_t packet_size(std::string_view bytes) const override;

 private:
  ClipAxes axes_;
  std::string server_, models_;  // Messages that describe the server and the models.
  std::vector<Pose> world_from_joint_;
  NatNetFrame frame_;
};

std::string NatNetEncoder::begin(const Clip& clip) {
  axes_ = ClipAxes(clip, Eigen::Vector3d::UnitY());
  NatNetSkeleton skeleton{"player", 1, {}};
  frame_ = {};
  frame_.skeleton = skeleton.id;
  for (const Joint& joint : clip.skeleton().joints()) {
    const int id = static_cast<int>(skeleton.bones.size()) + 1;
    skeleton.bones.push_back({joint.name, id, joint.parent + 1, axes_.metric(joint.offset)});
    frame_.bones.push_back({id, {}, true});
  }
  world_from_joint_.resize(frame_.bones.size());
  constexpr int kDataPort = 1511;
  server_ =
      natnet_message(NatNetMessage::kServerInfo, natnet_server_payload(kPlayedVersion, kDataPort));
  models_ =
      natnet_message(NatNetMessage::kModels, natnet_skeleton_payload(skeleton, kPlayedVersion));
  return server_ + models_;
}

Result<std::string> NatNetEncoder::frame(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
  frame_.number = static_cast<std::uint32_t>(frame);
  frame_.time = clip.rate().time_of(frame);
  for (std::size_t i = 0; i < world_from_joint_.size(); ++i) {
    frame_.bones[i].pose = axes_.metric(world_from_joint_[i]);
  }
  const std::string payload = natnet_frame_payload(frame_, kPlayedVersion);
  constexpr std::size_t kMaxPayload = 65000;  // Bytes in a datagram.
  if (payload.size() > kMaxPayload) {
    return input_failure(clip.name(), "the skeleton has too many joints for a NatNet datagram");
  }
  return natnet_message(NatNetMessage::kFrame, payload);
}

std::string NatNetEncoder::answer(std::string_view request) {
  const auto type = natnet_message_type(request);
  if (!type) return {};
  switch (*type) {
    case NatNetMessage::kConnect:
      return server_;
    case NatNetMessage::kModelsRequest:
      return models_;
    case NatNetMessage::kCommand:
      // The only command that clients need to interpret the stream.
      if (request.substr(kNatNetHeaderSize).starts_with("Bitstream")) {
        return natnet_message(NatNetMessage::kResponse, "Bitstream,4.1");
      }
      return natnet_message(NatNetMessage::kUnrecognised, {});
    default:
      return {};
  }
}

std::size_t NatNetEncoder::packet_size(std::string_view bytes) const {
  return natnet_message_size(bytes).value_or(bytes.size());
}

}  // namespace

std::unique_ptr<Encoder> make_natnet_encoder() {
  return std::make_unique<NatNetEncoder>();
}

}  // namespace retarget
