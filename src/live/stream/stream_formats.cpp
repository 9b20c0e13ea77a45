#include "live/stream/stream_formats.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <utility>

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

bool is_actor_number(const std::string& value) {
  const auto number = parse_number<int>(value);
  return number && *number >= 0;
}

std::vector<InputFormat> input_formats() {
  std::vector<InputFormat> formats;
  for (const StreamFormat& format : stream_formats()) {
    formats.push_back({format.name, format.description, format.port});
  }
  return formats;
}

std::span<const StreamFormat> stream_formats() {
  static const std::array kFormats = {line_format(),   bvh_row_format(), vmc_format(),
                                      rokoko_format(), smplx_format(),   xrobot_format(),
                                      mvn_format(),    natnet_format()};
  return kFormats;
}

Result<const StreamFormat*> find_stream_format(const std::string& name) {
  const std::span<const StreamFormat> formats = stream_formats();
  if (name.empty()) return &formats.front();
  const auto found = std::ranges::find(formats, name, &StreamFormat::name);
  if (found != formats.end()) return &*found;
  std::vector<std::string> names;
  for (const StreamFormat& format : formats) names.emplace_back(format.name);
  return usage_failure("unknown stream format \"" + name + "\"" + did_you_mean(name, names),
                       "stream formats are " + list_names(names));
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
