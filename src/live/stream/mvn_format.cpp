// Decodes poses and the T-pose of Xsens MVN's network streamer (document MV0305P; types 02 and 13).
// In the T-pose all segments have the world's axes. Therefore their offsets from their parents in
// any frame equal those in the T-pose.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/message_cutter.h"
#include "live/stream/mvn_protocol.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/bytes.h"
#include "retarget/clip.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using MvnReader = ByteReader<std::endian::big>;

constexpr double kFarthest = 1e4;  // metres

Eigen::Vector3d read_mvn_vector(MvnReader& reader) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = static_cast<double>(reader.number<float>());
  return vector;
}

// Callers negate the result, so that NaN fails.
bool is_mvn_place(const Eigen::Vector3d& place) {
  return (place.array().abs() < kFarthest).all();
}

class MvnDecoder final : public Decoder {
 public:
  MvnDecoder(std::optional<int> actor, bool datagrams) : chosen_(actor), datagrams_(datagrams) {}
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) override {
    skeleton_.know(skeleton);
  }
  void know_up(const Eigen::Vector3d& up) override { skeleton_.know_up(up); }
  void restart() override;

 private:
  Result<void> take_message(std::string_view bytes, StreamSink& sink);
  Result<void> take_scale(std::string_view payload, StreamSink& sink);
  Result<void> take_poses(const MvnHeader& header, std::string_view payload, StreamSink& sink);
  Result<void> read_poses(std::string_view payload);
  Result<void> end_frame(std::uint32_t milliseconds, StreamSink& sink);
  [[nodiscard]] bool waits_for_scale(std::uint32_t milliseconds);
  Result<void> learn_from_frame(StreamSink& sink);
  Result<void> set_skeleton(const MvnOffsets& offsets, double tolerance, StreamSink& sink);

  std::optional<int> chosen_;
  bool datagrams_;
  std::optional<int> actor_;  // Performer that is followed.
  MessageCutter cutter_{kMvnHeaderSize, mvn_message_size};
  StreamSkeleton skeleton_;

  // State of the incoming frame, whose messages may arrive in any order.
  std::uint32_t sample_ = 0;
  std::bitset<128> parts_;
  std::optional<int> last_part_;
  std::optional<std::uint32_t> ended_;  // Last complete sample.
  std::bitset<kMvnSegmentCount> seen_;
  std::array<Pose, kMvnSegmentCount> world_from_segment_;

  std::bitset<kMvnSegmentCount> placed_;
  std::array<Eigen::Vector3d, kMvnSegmentCount> t_pose_;
  std::optional<std::uint32_t> first_milliseconds_;
  int frames_waited_ = 0;
};

void MvnDecoder::restart() {
  MvnDecoder fresh(chosen_, datagrams_);
  fresh.skeleton_ = std::move(skeleton_);
  fresh.skeleton_.forget();
  *this = std::move(fresh);
}

Result<void> MvnDecoder::take(std::string_view bytes, StreamSink& sink) {
  if (datagrams_) return take_message(bytes, sink);
  return cutter_.take(bytes, [&](std::string_view message) { return take_message(message, sink); });
}

Result<void> MvnDecoder::take_message(std::string_view bytes, StreamSink& sink) {
  const auto header = read_mvn_header(bytes);
  if (!header) return bad_packet("not a message of MVN's network streamer");
  const std::string_view payload = bytes.substr(kMvnHeaderSize);
  if (payload.size() < header->payload_size) return bad_packet("truncated message");
  switch (static_cast<MvnType>(header->type)) {
    case MvnType::kEuler:
    case MvnType::kUnity:
      return bad_packet(
          fmt::format("unsupported pose type {:02}: enable Position + Orientation (Quaternion) in "
                      "MVN's network streamer",
                      header->type));
    case MvnType::kQuaternion:
    case MvnType::kScale:
      break;
    default:
      return {};
  }
  if (!actor_) actor_ = chosen_.value_or(header->actor);
  if (header->actor != *actor_) return {};
  return header->type == static_cast<int>(MvnType::kScale)
             ? take_scale(payload, sink)
             : take_poses(*header, payload.substr(0, header->payload_size), sink);
}

// Reads the segments; ignores their points, which follow in the same message type.
Result<void> MvnDecoder::take_scale(std::string_view payload, StreamSink& sink) {
  MvnReader reader(payload);
  constexpr std::uint32_t kMostSegments = 256, kLongestName = 64;
  const auto count = reader.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    const auto length = reader.number<std::uint32_t>();
    const std::string_view name = reader.bytes(length);
    const Eigen::Vector3d place = read_mvn_vector(reader);
    if (!reader.ok() || !is_mvn_place(place) || i == kMostSegments || length > kLongestName)
      return bad_packet("truncated or invalid scale data");
    if (const auto segment = mvn_segment(name)) {
      t_pose_[*segment] = place;
      placed_.set(*segment);
    }
  }
  if (!reader.ok()) return bad_packet("truncated scale data");
  if (!placed_.all()) return {};
  placed_.reset();
  MvnOffsets offsets = t_pose_;
  for (std::size_t i = 1; i < kMvnSegmentCount; ++i) {
    offsets[i] -= t_pose_[static_cast<std::size_t>(kMvnSegments[i].parent)];
  }
  // Offsets from a frame are equivalent within the compliance of MVN's joints.
  constexpr double kSameBody = 0.01;  // metres
  return set_skeleton(offsets, kSameBody, sink);
}

Result<void> MvnDecoder::set_skeleton(const MvnOffsets& offsets, double tolerance,
                                      StreamSink& sink) {
  if (const std::string fault = mvn_body_fault(offsets); !fault.empty()) {
    return bad_packet("the body dimensions are not those of a person: " + fault);
  }
  const auto& told = skeleton_.joints();
  bool same = !told.empty();
  for (std::size_t i = 1; same && i < kMvnSegmentCount; ++i) {
    same = (told[i].offset - offsets[i]).norm() < tolerance;
  }
  if (same) return {};
  std::vector<StreamJoint> joints;
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    joints.push_back({std::string(kMvnSegments[i].name), kMvnSegments[i].parent, offsets[i]});
  }
  skeleton_.set_joints(std::move(joints), Eigen::Vector3d::UnitZ(), true, sink);
  return {};
}

Result<void> MvnDecoder::take_poses(const MvnHeader& header, std::string_view payload,
                                    StreamSink& sink) {
  // Ignore a repeated part.
  const bool is_whole = header.part == 0 && header.is_last;
  if (!is_whole && ended_ == header.sample) return {};
  const bool lost = parts_.any() && header.sample != sample_;
  if (lost) {
    parts_.reset();
    last_part_.reset();
  }
  if (parts_.none()) {
    sample_ = header.sample;
    seen_.reset();
  }
  if (auto taken = read_poses(payload); !taken) {
    parts_.reset();
    last_part_.reset();
    return taken;
  }
  parts_.set(static_cast<std::size_t>(header.part));
  if (header.is_last) last_part_ = header.part;
  if (last_part_ && parts_.count() == static_cast<std::size_t>(*last_part_) + 1) {
    parts_.reset();
    last_part_.reset();
    ended_ = header.sample;
    RETARGET_TRY(end_frame(header.milliseconds, sink));
  }
  if (lost) return bad_packet("a part of a frame is missing");
  return {};
}

Result<void> MvnDecoder::read_poses(std::string_view payload) {
  constexpr double kMinNorm = 0.1;
  MvnReader reader(payload);
  while (reader.left() > 0) {
    const auto id = reader.number<std::uint32_t>();
    const Eigen::Vector3d place = read_mvn_vector(reader);
    std::array<double, 4> q{};
    for (double& value : q) value = static_cast<double>(reader.number<float>());
    if (!reader.ok()) return bad_packet("truncated pose");
    // Props and fingers follow the body's segments.
    if (id == 0 || id > kMvnSegmentCount) continue;
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    const double norm = rotation.norm();
    if (!is_mvn_place(place) || !(norm > kMinNorm) || !(norm < 1.0 / kMinNorm)) {
      return bad_packet(fmt::format("segment {}: invalid pose", kMvnSegments[id - 1].name));
    }
    world_from_segment_[id - 1] = {rotation.normalized(), place};
    seen_.set(id - 1);
  }
  return {};
}

Result<void> MvnDecoder::end_frame(std::uint32_t milliseconds, StreamSink& sink) {
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    if (!seen_[i]) {
      return bad_packet(fmt::format("the frame lacks the segment {}", kMvnSegments[i].name));
    }
  }
  if (skeleton_.joints().empty()) {
    if (waits_for_scale(milliseconds)) return {};
    RETARGET_TRY(learn_from_frame(sink));
  }
  skeleton_.give(1e-3 * milliseconds, world_from_segment_, sink);
  return {};
}

// Whether to wait for scale data, which are sent at intervals if at all. A skeleton from the user's
// file replaces them.
bool MvnDecoder::waits_for_scale(std::uint32_t milliseconds) {
  constexpr std::uint32_t kWait = 2000;
  constexpr int kFrames = 480;  // For a clock that does not advance.
  if (skeleton_.known() != nullptr) return false;
  if (!first_milliseconds_) first_milliseconds_ = milliseconds;
  return milliseconds - *first_milliseconds_ < kWait && ++frames_waited_ < kFrames;
}

Result<void> MvnDecoder::learn_from_frame(StreamSink& sink) {
  MvnOffsets offsets;
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    offsets[i] =
        parent_from_joint(world_from_segment_, kMvnSegments[i].parent, world_from_segment_[i])
            .translation;
  }
  return set_skeleton(offsets, 0.0, sink);
}

// Encodes a clip as MVN's network streamer does: its segments if the clip has them, otherwise those
// of the human found in it.

using SegmentPoses = std::array<Pose, kMvnSegmentCount>;

// Joints of the segments; nothing if one is missing.
std::optional<std::array<int, kMvnSegmentCount>> segment_joints(const Skeleton& skeleton) {
  std::array<int, kMvnSegmentCount> joints;
  joints.fill(-1);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (const auto segment = mvn_segment(skeleton.joint(joint).name)) joints[*segment] = joint;
  }
  if (std::ranges::find(joints, -1) != joints.end()) return std::nullopt;
  return joints;
}

// Whether a clip lacks MVN's segments, the unit or the up axis.
bool plays_human_as_mvn(const Clip& clip) {
  return !clip.origin().metres_per_unit || !clip.origin().up || !segment_joints(clip.skeleton());
}

class MvnEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;
  [[nodiscard]] std::size_t packet_size(std::string_view bytes) const override;

 private:
  void pose_of_joints(const Clip& clip, int frame);
  [[nodiscard]] std::string scale(const Clip& clip, int frame) const;

  std::optional<std::array<int, kMvnSegmentCount>> joints_;  // Nothing: bones are played.
  ClipAxes axes_;
  std::vector<Pose> world_from_joint_;
  BonePoses bones_;
  SegmentPoses world_from_segment_;
  std::array<Eigen::Vector3d, kMvnSegmentCount> t_pose_;
};

std::uint32_t milliseconds_of(const Clip& clip, int frame) {
  return static_cast<std::uint32_t>(std::lround(1e3 * clip.rate().time_of(frame)));
}

std::string MvnEncoder::begin(const Clip& clip) {
  joints_ = plays_human_as_mvn(clip) ? std::nullopt : segment_joints(clip.skeleton());
  if (joints_) {
    axes_ = ClipAxes(clip, Eigen::Vector3d::UnitZ());
    world_from_joint_.resize(static_cast<std::size_t>(clip.skeleton().joint_count()));
    pose_of_joints(Clip(clip.shared_skeleton(), clip.rate(), 1), 0);
  } else {
    bones_ = BonePoses(clip);
    std::ranges::copy(bones_.poses_of(kMvnSegments), world_from_segment_.begin());
  }
  std::ranges::transform(world_from_segment_, t_pose_.begin(), &Pose::translation);
  return scale(clip, 0);
}

void MvnEncoder::pose_of_joints(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    world_from_segment_[i] =
        axes_.metric(world_from_joint_[static_cast<std::size_t>((*joints_)[i])]);
  }
}

std::string MvnEncoder::scale(const Clip& clip, int frame) const {
  return mvn_scale_message(static_cast<std::uint32_t>(frame), milliseconds_of(clip, frame),
                           t_pose_);
}

Result<std::string> MvnEncoder::frame(const Clip& clip, int frame) {
  if (joints_) {
    pose_of_joints(clip, frame);
  } else {
    bones_.set_frame(clip, frame);
    std::ranges::copy(bones_.poses_of(kMvnSegments), world_from_segment_.begin());
  }
  // Repeat the scale once per second for receivers that join later.
  const int second = std::max(1, static_cast<int>(std::lround(clip.rate().fps())));
  std::string bytes = frame > 0 && frame % second == 0 ? scale(clip, frame) : std::string();
  return bytes += mvn_pose_message(static_cast<std::uint32_t>(frame), milliseconds_of(clip, frame),
                                   world_from_segment_);
}

std::size_t MvnEncoder::packet_size(std::string_view bytes) const {
  return mvn_message_size(bytes).value_or(bytes.size());
}

}  // namespace

StreamFormat mvn_format() {
  static constexpr std::array kExtras = {kActorNumber};
  return {.name = "mvn",
          .description =
              "Xsens MVN's network streamer, poses as quaternions; ?actor=N selects an actor",
          .port = 9763,
          .is_text = false,
          .decoder = [](const StreamAddress& from) -> std::unique_ptr<Decoder> {
            return std::make_unique<MvnDecoder>(parse_number<int>(from.extra("actor")),
                                                from.transport == Transport::kUdp);
          },
          .encoder = make_encoder<MvnEncoder>,
          .plays_human = plays_human_as_mvn,
          .extras = kExtras};
}

}  // namespace retarget
