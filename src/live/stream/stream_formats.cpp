#include "live/stream/stream_formats.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>

#include "live/stream/natnet_protocol.h"
#include "retarget/serve.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Parameters after `?` of a transport, regardless of the format.
std::vector<std::string> transport_extras(const StreamAddress& from, const StreamFormat& format) {
  if (from.transport == Transport::kTcp) return {"from"};
  if (from.transport != Transport::kUdp) return {};
  std::vector<std::string> names = {"from", "multicast"};
  if (format.request_port > 0) names.insert(names.end(), {"server", "command"});
  return names;
}

Result<void> check_packets(const StreamAddress& address, const StreamFormat& format) {
  const bool is_socket =
      address.transport == Transport::kUdp || address.transport == Transport::kTcp;
  if (!format.needs_packets || is_socket) return {};
  return usage_failure(
      fmt::format("{} needs packets: {} would join them", format.name, address.text()),
      fmt::format("use udp:{}?format={}, or another format for pipes", format.port, format.name));
}

Result<void> check_values(const StreamAddress& from, const StreamFormat& format) {
  for (const StreamExtra& extra : format.extras) {
    const std::string value = from.extra(std::string(extra.name));
    if (value.empty() || extra.is_valid(value)) continue;
    return usage_failure(
        fmt::format("expected {}={}, found \"{}\"", extra.name, extra.expected, value));
  }
  return {};
}

}  // namespace

// Text formats: splits the bytes at line ends into datagrams of limited size.
std::size_t Encoder::packet_size(std::string_view bytes) const {
  constexpr std::size_t kMaxDatagramSize = 65000;  // bytes
  if (bytes.size() <= kMaxDatagramSize) return bytes.size();
  const std::size_t end = bytes.rfind('\n', kMaxDatagramSize);
  return end == std::string_view::npos ? bytes.size() : end + 1;
}

namespace {

// For formats with fixed bones.
bool always(const Clip&) {
  return true;
}

bool is_anything(const std::string&) {
  return true;
}
bool is_count(const std::string& value) {
  const auto number = parse_number<int>(value);
  return number && *number >= 0;
}
bool is_frame_rate(const std::string& value) {
  const auto number = parse_number<double>(value);
  return number && *number > 0.0 && *number < 1e4;
}
bool is_natnet_version(const std::string& value) {
  return natnet_version(value).has_value();
}
bool is_coordinates(const std::string& value) {
  return value == "local" || value == "global";
}

constexpr auto kBvhExtras =
    std::to_array<StreamExtra>({{"fps", "a number from 0 to 10000", is_frame_rate}});
constexpr auto kRokokoExtras = std::to_array<StreamExtra>({{"actor", "NAME", is_anything}});
constexpr auto kMvnExtras =
    std::to_array<StreamExtra>({{"actor", "a whole number of at least 0", is_count}});
constexpr auto kNatNetExtras = std::to_array<StreamExtra>(
    {{"actor", "a whole number of at least 0", is_count},
     {"version", "a NatNet version of at least 3.0, such as version=4.1", is_natnet_version},
     {"coordinates", "local or global", is_coordinates}});

// A skeleton's rows may arrive line by line in a datagram.
constexpr std::size_t kBvhLines = 4096;

constexpr auto kFormats = std::to_array<StreamFormat>({
    {"lines", "JSON, one object per line: time, named joints with position and quaternion", 0, true,
     make_line_decoder, make_line_encoder, nullptr, true},
    {"bvh",
     "motion rows of a BVH file as text, one per line; ?fps=N, because they have no timestamps",
     1118, true, make_bvh_row_decoder, make_bvh_row_encoder, nullptr, false, 0, kBvhExtras,
     kBvhLines},
    {"vmc",
     "VMC over OSC: bones of a VRM avatar, from Virtual Motion Capture, Waidayo, ...",
     39539,
     false,
     make_vmc_decoder,
     make_vmc_encoder,
     always,
     false,
     0,
     {},
     64,
     true},
    {"rokoko", "Rokoko Studio's custom streaming, JSON v3; ?actor=NAME selects an actor", 14043,
     false, make_rokoko_decoder, make_rokoko_encoder, always, false, 0, kRokokoExtras},
    {"smplx", "rotation vectors of SMPL-X, SMPL+H or SMPL, JSON, one object per line", 0, true,
     make_smplx_decoder, make_smplx_encoder, smplx_plays_human},
    {"xrobot",
     "body tracking of PICO and Quest headsets by XRoboToolkit: 24 poses, JSON, one object per "
     "line",
     0, true, make_xrobot_decoder, make_xrobot_encoder, always},
    {"mvn", "Xsens MVN's network streamer, poses as quaternions; ?actor=N selects an actor", 9763,
     false, make_mvn_decoder, make_mvn_encoder, plays_human_as_mvn, false, 0, kMvnExtras},
    {"natnet",
     "OptiTrack Motive, NatNet 3.0 to 4.x; ?server=ADDRESS for the skeleton, "
     "?multicast=239.255.42.99, ?version=4.1, ?actor=N",
     1511, false, make_natnet_decoder, make_natnet_encoder, nullptr, true, 1510, kNatNetExtras},
});

}  // namespace

std::vector<InputFormat> input_formats() {
  std::vector<InputFormat> formats;
  for (const StreamFormat& format : stream_formats()) {
    formats.push_back({format.name, format.description, format.port});
  }
  return formats;
}

std::span<const StreamFormat> stream_formats() {
  return kFormats;
}

Result<const StreamFormat*> find_stream_format(const std::string& name) {
  if (name.empty()) return &kFormats.front();
  const auto* const found = std::ranges::find(kFormats, name, &StreamFormat::name);
  if (found != kFormats.end()) return found;
  std::vector<std::string> names;
  for (const StreamFormat& format : kFormats) names.emplace_back(format.name);
  return usage_failure("unknown stream format \"" + name + "\"", did_you_mean(name, names));
}

std::string_view likely_format(std::string_view packet) {
  constexpr std::size_t kHead = 4096;
  const std::string_view head = packet.substr(0, kHead);
  const auto has = [&](std::string_view text) { return head.find(text) != std::string_view::npos; };
  if (head.starts_with("MXTP")) return "mvn";
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  if (head.substr(begin).starts_with("HIERARCHY")) return "bvh";
  if (head[begin] != '{') return {};
  if (has("\"skeleton\"")) return "lines";
  if (has("\"scene\"") || has("\"actors\"")) return "rokoko";
  if (has("\"timeStampNs\"") || has("\"functionName\"")) return "xrobot";
  if (has("\"body_pose\"") || has("\"pose_body\"") || has("\"poses\"") ||
      has("\"global_orient\"") || has("\"root_orient\"") || has("\"rest_offsets\"") ||
      has("\"betas\"")) {
    return "smplx";
  }
  return {};
}

Result<void> check_input(const StreamAddress& from, const StreamFormat& format) {
  if (from.transport != Transport::kStdin && from.transport != Transport::kUdp &&
      from.transport != Transport::kTcp) {
    return usage_failure("an input must be udp:PORT, tcp:PORT or stdin, found " + from.text());
  }
  RETARGET_TRY(check_packets(from, format));
  if (format.request_port == 0 && !from.extra("server").empty()) {
    return usage_failure("senders of this format have no server: remove ?server=");
  }
  std::vector<std::string> known = transport_extras(from, format);
  for (const StreamExtra& extra : format.extras) known.emplace_back(extra.name);
  RETARGET_TRY(check_extras(from, known));
  return check_values(from, format);
}

Result<void> check_player_target(const StreamAddress& to, const StreamFormat& format) {
  RETARGET_TRY(check_packets(to, format));
  std::vector<std::string> known;
  if (to.transport == Transport::kUdp) known.emplace_back("interface");
  if (to.transport == Transport::kUdp && format.request_port > 0) known.emplace_back("command");
  return check_extras(to, known);
}

void PacketBatch::clear() {
  count_ = dropped_ = 0;
  has_skeleton_ = false;
}

void PacketBatch::drop_frames() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (items_[i].skeleton) std::swap(items_[kept++], items_[i]);
  }
  count_ = kept;
  dropped_ = 0;
}

PacketBatch::Item& PacketBatch::add() {
  if (count_ == items_.size()) items_.emplace_back();
  return items_[count_++];
}

void PacketBatch::take_skeleton(Clip clip, bool has_rest) {
  // Drop earlier items if the batch is full; the new skeleton matters more.
  if (count_ >= most_frames_) count_ = 0;
  Item& item = add();
  item.skeleton = std::move(clip);
  item.has_rest = has_rest;
  has_skeleton_ = true;
}

void PacketBatch::take_frame(const StreamFrame& frame) {
  if (count_ >= most_frames_) {
    ++dropped_;
    return;
  }
  Item& item = add();
  item.skeleton.reset();
  item.frame.time = frame.time;
  item.frame.declared = frame.declared;
  item.frame.rotations.assign(frame.rotations.begin(), frame.rotations.end());
  item.frame.translations.assign(frame.translations.begin(), frame.translations.end());
}

void SkeletonPackets::see(std::string_view bytes, const PacketBatch& batch, bool malformed) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  if (!batch.has_skeleton() && (malformed || !batch.empty())) {
    forget_waiting();
    return;
  }
  waiting_.emplace_back(bytes);
  waiting_bytes_ += bytes.size();
  if (batch.has_skeleton()) {
    received_ = std::exchange(waiting_, {});
    waiting_bytes_ = 0;
  } else if (waiting_bytes_ > kMostBytes) {
    forget_waiting();
  }
}

void SkeletonPackets::replay(const std::vector<std::string>& packets, Decoder& decoder) {
  PacketBatch nothing(0);
  for (const std::string& packet : packets) {
    // The packet was accepted before.
    static_cast<void>(decoder.take(packet, nothing));
  }
}

void SkeletonPackets::forget_waiting() {
  waiting_.clear();
  waiting_bytes_ = 0;
}

}  // namespace retarget
