// Plays a clip to an address, as its motion capture system would have sent it.

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "live/stream/byte_output.h"
#include "live/stream/human_bones.h"
#include "live/stream/stream_formats.h"
#include "retarget/serve.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Waits until the given time or until stopped.
void wait_until(std::chrono::steady_clock::time_point then,
                const std::function<bool()>& is_stopped) {
  constexpr auto kLook = std::chrono::milliseconds(50);
  for (auto now = std::chrono::steady_clock::now(); now < then && !(is_stopped && is_stopped());
       now = std::chrono::steady_clock::now()) {
    std::this_thread::sleep_until(std::min(then, now + kLook));
  }
}

// Sends an encoder's bytes to the address and to receivers that requested them.
class Player {
 public:
  [[nodiscard]] static Result<Player> open(const StreamFormat& format, const StreamAddress& to) {
    Player player;
    player.encoder_ = format.encoder();
    RETARGET_TRY_ASSIGN(player.sink_, ByteSink::open(to));
    if (format.request_port > 0 && to.transport == Transport::kUdp) {
      RETARGET_TRY_ASSIGN(player.server_, RequestServer::open(to, format.request_port));
    }
    return player;
  }

  [[nodiscard]] Encoder& encoder() { return *encoder_; }
  /// Whether receivers request the header instead of receiving it first.
  [[nodiscard]] bool answers_requests() const { return server_.has_value(); }

  void wait(std::chrono::steady_clock::time_point then, const std::function<bool()>& is_stopped) {
    if (server_) {
      server_->serve(*encoder_, then, is_stopped);
    } else {
      wait_until(then, is_stopped);
    }
  }

  Result<void> send(std::string_view bytes, const std::function<bool()>& is_stopped) {
    const bool datagrams = sink_->address().transport == Transport::kUdp;
    while (!bytes.empty()) {
      const std::size_t size =
          datagrams ? std::min(encoder_->packet_size(bytes), bytes.size()) : bytes.size();
      RETARGET_TRY(sink_->write(bytes.substr(0, size), is_stopped));
      if (server_) server_->send(bytes.substr(0, size));
      bytes.remove_prefix(size);
    }
    return {};
  }

 private:
  std::unique_ptr<Encoder> encoder_;
  std::optional<ByteSink> sink_;
  std::optional<RequestServer> server_;
};

// The clip to play, converted as the format requires.
Result<Clip> played_clip(const Clip& clip, const StreamFormat& format, const PlayOptions& options) {
  if (format.plays_human != nullptr && format.plays_human(clip)) {
    return clip_of_human_bones(clip, options.human, options.data_folder);
  }
  if (format.is_metric) return clip_with_units(clip, options.human, options.data_folder);
  return clip;
}

}  // namespace

Result<int> play(const Clip& given, const PlayOptions& options,
                 const std::function<bool()>& is_stopped) {
  const ExactWaits exact;
  RETARGET_TRY_ASSIGN(const StreamAddress to, parse_address(options.to));
  RETARGET_TRY_ASSIGN(const StreamFormat* format, find_stream_format(to.format));
  RETARGET_TRY(check_player_target(to, *format));
  RETARGET_TRY_ASSIGN(const Clip clip, played_clip(given, *format, options));
  RETARGET_TRY_ASSIGN(Player player, Player::open(*format, to));
  const std::string header = player.encoder().begin(clip);
  if (options.header && !player.answers_requests()) RETARGET_TRY(player.send(header, is_stopped));
  const auto begin = std::chrono::steady_clock::now();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const std::chrono::duration<double> time(
        options.speed > 0.0 ? clip.rate().time_of(frame) / options.speed : 0.0);
    player.wait(begin + std::chrono::duration_cast<std::chrono::nanoseconds>(time), is_stopped);
    if (is_stopped && is_stopped()) return frame;
    RETARGET_TRY_ASSIGN(const std::string bytes, player.encoder().frame(clip, frame));
    RETARGET_TRY(player.send(bytes, is_stopped));
  }
  return clip.frame_count();
}

}  // namespace retarget
