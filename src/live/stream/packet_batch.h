#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "live/stream/stream_formats.h"

namespace retarget {

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
  void accept() { kept_ = told_; }
  /// Replays the packets of the skeleton in use to a decoder.
  void restore(Decoder& decoder) const;
  /// Discards packets that completed no skeleton.
  void forget_waiting();

 private:
  std::vector<std::string> told_, kept_;
  std::vector<std::string> waiting_;  // Packets without a result yet.
  std::size_t waiting_bytes_ = 0;
};

}  // namespace retarget
