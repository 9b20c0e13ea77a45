#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "live/stream/stream_address.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// Maximum number of joints of a stream's skeleton.
inline constexpr int kMaxStreamJoints = 500;

/// A frame of a stream, for the skeleton received last; its contents match a frame of a Clip.
struct StreamFrame {
  double time = std::numeric_limits<double>::quiet_NaN();  ///< Sender's time, s; NaN: none.
  /// Time at the frame rate that the stream declares, for streams that do not arrive in real time,
  /// s; NaN: none.
  double declared = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Quaterniond> rotations;  ///< All joints, parent_from_joint, unit length.
  std::vector<Eigen::Vector3d> translations;  ///< Indexed by Skeleton::translation_slot.
};

/// Receives the output of a decoder.
class StreamSink {
 public:
  virtual ~StreamSink() = default;
  /// Sets the skeleton of the following frames. The clip's frames, if any, are poses for
  /// calibration; its origin may give unit, up axis and height.
  /// @param has_rest  whether its first frame is the rest pose.
  virtual void take_skeleton(Clip clip, bool has_rest) = 0;
  virtual void take_frame(const StreamFrame& frame) = 0;
};

/// Decodes the bytes of one protocol into skeletons and frames. The input is untrusted: invalid
/// input is an error and does not affect the decoding of the following bytes.
class Decoder {
 public:
  virtual ~Decoder() = default;
  /// Decodes a datagram, a line (is_text), or the next bytes of a connection.
  [[nodiscard]] virtual Result<void> take(std::string_view bytes, StreamSink& sink) = 0;
  /// Sets a skeleton from the user's file before the first bytes, for senders that do not send one.
  virtual void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) {
    static_cast<void>(skeleton);
  }
  /// Sets the up axis of that file's world, once it is recognised, for streams that state their
  /// own.
  virtual void know_up(const Eigen::Vector3d& up) { static_cast<void>(up); }
  /// Resets the state for a new sender.
  virtual void restart() {}
  /// How the sender can give times to frames without timestamps.
  [[nodiscard]] virtual std::string_view time_remedy() const { return "send their times"; }
  /// The request to send to the sender now, for protocols with requests; called repeatedly. Empty:
  /// no request.
  [[nodiscard]] virtual std::string_view request() const { return {}; }
  /// The reason why no packet gives a frame yet, such as a missing part of the stream;
  /// human-readable. Empty: unknown.
  [[nodiscard]] virtual std::string lack() const { return {}; }
};

/// Encodes a clip as bytes of a protocol.
class Encoder {
 public:
  virtual ~Encoder() = default;
  /// Bytes that a receiver needs first; empty: none.
  [[nodiscard]] virtual std::string begin(const Clip& clip) = 0;
  [[nodiscard]] virtual Result<std::string> frame(const Clip& clip, int frame) = 0;
  /// Size of the first datagram in bytes returned by this encoder.
  [[nodiscard]] virtual std::size_t packet_size(std::string_view bytes) const;
  /// Reply to a receiver's request (Decoder::request), called after begin; empty: no reply.
  [[nodiscard]] virtual std::string answer(std::string_view request) {
    static_cast<void>(request);
    return {};
  }
};

/// A parameter after `?` in an address that a format supports.
struct StreamExtra {
  std::string_view name;
  std::string_view expected;  ///< Expected value, human-readable: `NUMBER`.
  bool (*is_valid)(const std::string& value) = nullptr;
};

/// A number of an actor from 0; an extra of several formats.
[[nodiscard]] bool is_actor_number(const std::string& value);
inline constexpr StreamExtra kActorNumber = {"actor", "a whole number of at least 0",
                                             is_actor_number};

/// A protocol for human motion. To add one, add a file in this folder that returns its row, and
/// name it below and in stream_formats().
struct StreamFormat {
  std::string_view name;         ///< `bvh`, `lines`
  std::string_view description;  ///< Human-readable, one line.
  int port = 0;                  ///< Default port of its senders; 0: none.
  bool is_text = true;           ///< Text lines: the bytes of a connection are split at line ends.
  std::unique_ptr<Decoder> (*decoder)(const StreamAddress& from) = nullptr;
  std::unique_ptr<Encoder> (*encoder)() = nullptr;
  /// Whether the encoder needs the canonical human of a clip (clip_of_human_bones) instead of the
  /// clip. Null: never.
  bool (*plays_human)(const Clip& clip) = nullptr;
  bool is_metric = false;  ///< The encoder needs a clip's unit and up axis (clip_with_units).
  int request_port = 0;    ///< Port of its senders for requests; 0: none.
  std::span<const StreamExtra> extras = {};  ///< Parameters after `?` that its decoder reads.
  /// Maximum number of text lines read from a datagram; further lines are dropped.
  std::size_t datagram_lines = 64;
  /// Its packets do not state where they end, so that a pipe or a file would join them.
  bool needs_packets = false;
};

/// All formats, the default first.
[[nodiscard]] std::span<const StreamFormat> stream_formats();

/// The format with a name; the default for an empty name. The kUsage error suggests the nearest
/// name.
[[nodiscard]] Result<const StreamFormat*> find_stream_format(const std::string& name);

/// Name of the format that a packet appears to have, judged by its beginning; empty: unknown.
[[nodiscard]] std::string_view likely_format(std::string_view packet);

[[nodiscard]] StreamFormat line_format();
[[nodiscard]] StreamFormat bvh_row_format();
[[nodiscard]] StreamFormat vmc_format();
[[nodiscard]] StreamFormat rokoko_format();
[[nodiscard]] StreamFormat smplx_format();
[[nodiscard]] StreamFormat xrobot_format();
[[nodiscard]] StreamFormat mvn_format();
[[nodiscard]] StreamFormat natnet_format();

/// Functions of these rows. Most decoders do not depend on the address.
template <typename Made>
[[nodiscard]] std::unique_ptr<Decoder> make_decoder(const StreamAddress& /*from*/) {
  return std::make_unique<Made>();
}
template <typename Made>
[[nodiscard]] std::unique_ptr<Encoder> make_encoder() {
  return std::make_unique<Made>();
}

/// The error of a packet that is not valid.
[[nodiscard]] inline Failure bad_packet(std::string message) {
  return input_failure({}, std::move(message));
}

/// Checks that a stream in a format can come from an address. Errors (kUsage): unsupported kind of
/// address; parameters after `?` that neither the transport nor the format supports, or with
/// invalid values.
[[nodiscard]] Result<void> check_input(const StreamAddress& from, const StreamFormat& format);

/// Checks that a motion can be played to an address. Errors: as above.
[[nodiscard]] Result<void> check_player_target(const StreamAddress& to, const StreamFormat& format);

/// Buffers the decoded contents of a packet, so that robot frames can leave during decoding.
class PacketBatch final : public StreamSink {
 public:
  /// @param most_frames  maximum number of frames kept per packet; the others are only counted.
  explicit PacketBatch(std::size_t most_frames) : most_frames_(most_frames) {}

  struct Item {
    std::optional<Clip> skeleton;  ///< A skeleton; if empty, the item is a frame.
    bool has_rest = false;
    StreamFrame frame;
  };

  void clear();
  /// Keeps only the skeletons.
  void drop_frames();
  void take_skeleton(Clip clip, bool has_rest) override;
  void take_frame(const StreamFrame& frame) override;

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] Item& operator[](std::size_t i) { return items_[i]; }
  /// Number of frames beyond the maximum.
  [[nodiscard]] std::size_t dropped() const { return dropped_; }
  [[nodiscard]] bool has_skeleton() const { return has_skeleton_; }
  /// Whether it contains no items.
  [[nodiscard]] bool empty() const { return count_ == 0; }

 private:
  Item& add();

  std::vector<Item> items_;  // The first count_ are valid; the others are kept for reuse.
  std::size_t most_frames_;
  std::size_t count_ = 0, dropped_ = 0;
  bool has_skeleton_ = false;
};

/// Keeps the packets that contained the skeleton in use. They restore a decoder that has accepted
/// another skeleton which was then rejected.
class SkeletonPackets {
 public:
  /// Inspects a packet and its decoded contents.
  void see(std::string_view bytes, const PacketBatch& batch, bool malformed);
  /// Marks the last received skeleton as the one in use.
  void accept() { kept_ = received_; }
  /// Replays the packets of the skeleton in use to a decoder.
  void restore(Decoder& decoder) const { replay(kept_, decoder); }
  /// Replays the packets of the last received skeleton.
  void restore_latest(Decoder& decoder) const { replay(received_, decoder); }
  /// Discards packets that completed no skeleton.
  void forget_waiting();

 private:
  static void replay(const std::vector<std::string>& packets, Decoder& decoder);

  std::vector<std::string> received_, kept_;
  std::vector<std::string> waiting_;  // Packets without a result yet.
  std::size_t waiting_bytes_ = 0;
};

}  // namespace retarget
