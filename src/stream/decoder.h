#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "stream/stream_address.h"

namespace retarget {

/// A frame of a stream: what a Clip has of a frame, for the skeleton that was told last.
struct StreamFrame {
  double time = std::numeric_limits<double>::quiet_NaN();  ///< Of the sender, s; NaN: it has none.
  std::vector<Eigen::Quaterniond> rotations;  ///< Of all joints, parent_from_joint, unit length.
  std::vector<Eigen::Vector3d> translations;  ///< By Skeleton::translation_slot.
};

/// Takes what a decoder finds.
class StreamSink {
 public:
  virtual ~StreamSink() = default;
  /// From now on frames are of this clip's skeleton. Its frames, where it has any, are poses of the
  /// body for calibration; its origin may tell unit, up axis and height.
  /// @param has_rest  its first frame is the rest pose.
  virtual void take_skeleton(Clip clip, bool has_rest) = 0;
  virtual void take_frame(const StreamFrame& frame) = 0;
};

/// Bytes of one protocol to skeletons and frames. Never trusts them: what cannot be understood is an
/// error, and the next bytes are read as if it had not come.
class Decoder {
 public:
  virtual ~Decoder() = default;
  /// Takes a datagram, a line (is_text), or the next bytes of a connection.
  [[nodiscard]] virtual Result<void> take(std::string_view bytes, StreamSink& sink) = 0;
  /// The skeleton of a file that the user names, before the first bytes: for senders that tell none.
  virtual void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) {
    static_cast<void>(skeleton);
  }
  /// The sender has gone and another one begins.
  virtual void restart() {}
  /// What the sender must be asked now, for protocols whose senders answer; asked again and again. Empty:
  /// nothing.
  [[nodiscard]] virtual std::string_view request() const { return {}; }
};

/// A clip to the bytes of a protocol.
class Encoder {
 public:
  virtual ~Encoder() = default;
  /// What a receiver must know first; empty: nothing.
  [[nodiscard]] virtual std::string begin(const Clip& clip) = 0;
  [[nodiscard]] virtual Result<std::string> frame(const Clip& clip, int frame) = 0;
  /// Of bytes that it gave, how many are the first datagram.
  [[nodiscard]] virtual std::size_t packet_size(std::string_view bytes) const;
  /// To what a receiver asks (Decoder::request), after begin; empty: nothing.
  [[nodiscard]] virtual std::string answer(std::string_view request) {
    static_cast<void>(request);
    return {};
  }
};

/// A protocol by which humans come: a file of this folder, and a row in stream_formats.cpp.
struct StreamFormat {
  std::string_view name;         ///< `bvh`, `lines`
  std::string_view description;  ///< For people, a line.
  int port = 0;                  ///< Where its senders send by default; 0: anywhere.
  bool is_text = true;           ///< Lines: a connection's bytes are cut at line ends.
  std::unique_ptr<Decoder> (*decoder)(const StreamAddress& from) = nullptr;
  std::unique_ptr<Encoder> (*encoder)() = nullptr;  ///< Null: nothing plays it.
  /// Whether the encoder takes the canonical human of a clip (clip_of_human_bones) in place of the clip.
  /// Null: never.
  bool (*plays_human)(const Clip& clip) = nullptr;
  bool is_metric = false;  ///< The encoder must know a clip's unit and up axis (clip_with_units).
  int request_port = 0;    ///< Where its senders are asked; 0: nowhere.
};

/// All of them, the default first.
[[nodiscard]] std::span<const StreamFormat> stream_formats();

/// The format of a name, the default for an empty one; kUsage error with the nearest name.
[[nodiscard]] Result<const StreamFormat*> find_stream_format(const std::string& name);

}  // namespace retarget
