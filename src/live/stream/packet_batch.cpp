#include "live/stream/packet_batch.h"

#include <utility>

namespace retarget {

void PacketBatch::clear() {
  count_ = dropped_ = 0;
  has_skeleton_ = false;
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
    told_ = std::exchange(waiting_, {});
    waiting_bytes_ = 0;
  } else if (waiting_bytes_ > kMostBytes) {
    forget_waiting();
  }
}

void SkeletonPackets::restore(Decoder& decoder) const {
  PacketBatch nothing(0);
  for (const std::string& packet : kept_) {
    // The packet was accepted before.
    static_cast<void>(decoder.take(packet, nothing));
  }
}

void SkeletonPackets::forget_waiting() {
  waiting_.clear();
  waiting_bytes_ = 0;
}

}  // namespace retarget
