// Decodes rows of a BVH file's MOTION section, one line of text each, as simple senders send them
// over UDP. The skeleton comes from a file or is sent first: the text of a BVH file up to its rows,
// in one datagram or line by line.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "live/stream/stream_formats.h"
#include "live/stream/stream_skeleton.h"
#include "retarget/bvh.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxHeader = std::size_t{1} << 18;  // bytes

// A rate of rows in frames per second.
std::optional<double> sender_rate(const std::string& value) {
  const auto fps = parse_number<double>(value);
  return fps && *fps > 0.0 && *fps < 1e4 ? fps : std::nullopt;
}

std::string_view trimmed(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = line.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return line.substr(begin, line.find_last_not_of(kBlanks) + 1 - begin);
}

class BvhRowDecoder final : public Decoder {
 public:
  explicit BvhRowDecoder(double fps) : fps_(fps) {}
  Result<void> take(std::string_view bytes, StreamSink& sink) override;
  void know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) override;
  void restart() override { header_.clear(); }
  [[nodiscard]] std::string lack() const override;
  std::string_view time_remedy() const override {
    return "state their rate (stdin?format=bvh&fps=30)";
  }

 private:
  Result<void> take_line(std::string_view line, StreamSink& sink);
  Result<void> end_header(StreamSink& sink);
  Result<void> take_row(std::string_view line, StreamSink& sink);
  void take_frame_time(std::string_view text);
  void use(const std::shared_ptr<const Skeleton>& skeleton);

  std::shared_ptr<const Skeleton> known_;  // From the user's file; null: none.
  double fps_;                             // 0: rows have no timestamps.
  std::optional<FrameRate> declared_;      // From the stream's header.
  std::string header_;                     // Partial header; empty while rows arrive.
  std::optional<BvhRowReader> rows_;
  std::optional<Clip> clip_;  // Has one frame.
  long count_ = 0;
  StreamFrame frame_;
};

void BvhRowDecoder::know_skeleton(const std::shared_ptr<const Skeleton>& skeleton) {
  known_ = skeleton;
  use(skeleton);
}

std::string BvhRowDecoder::lack() const {
  if (!header_.empty()) return "the skeleton is incomplete: its line MOTION is missing";
  return rows_ && count_ == 0 ? "the skeleton has no rows" : std::string();
}

void BvhRowDecoder::use(const std::shared_ptr<const Skeleton>& skeleton) {
  rows_.emplace(*skeleton);
  declared_.reset();
  clip_.emplace(skeleton, FrameRate{}, 1);
  count_ = 0;
}

Result<void> BvhRowDecoder::take(std::string_view bytes, StreamSink& sink) {
  while (!bytes.empty()) RETARGET_TRY(take_line(trimmed(take_until(bytes, '\n')), sink));
  return {};
}

Result<void> BvhRowDecoder::take_line(std::string_view line, StreamSink& sink) {
  if (line.empty()) return {};
  if (line.starts_with("HIERARCHY")) {
    header_ = "HIERARCHY\n";
    return {};
  }
  if (!header_.empty()) {
    if (line.starts_with("MOTION")) return end_header(sink);
    if (header_.size() + line.size() > kMaxHeader) {
      header_.clear();
      return bad_packet("the skeleton exceeds 256 KiB");
    }
    header_.append(line).append("\n");
    return {};
  }
  // A stream has any number of frames.
  if (line.starts_with("Frames:")) return {};
  constexpr std::string_view kFrameTime = "Frame Time:";
  if (!line.starts_with(kFrameTime)) return take_row(line, sink);
  take_frame_time(trimmed(line.substr(kFrameTime.size())));
  return {};
}

void BvhRowDecoder::take_frame_time(std::string_view text) {
  constexpr double kShortest = 1e-4, kLongest = 10.0;  // seconds
  const auto seconds = parse_number<double>(text);
  const bool is_valid = seconds && *seconds >= kShortest && *seconds <= kLongest;  // Also not NaN.
  if (is_valid) declared_ = frame_rate_from_frame_time(*seconds);
}

Result<void> BvhRowDecoder::end_header(StreamSink& sink) {
  const std::string text = std::exchange(header_, {});
  RETARGET_TRY_ASSIGN(const auto skeleton, bvh_skeleton(text, "stream"));
  if (skeleton->joint_count() > kMaxStreamJoints) {
    return bad_packet(fmt::format("the skeleton has more than {} joints", kMaxStreamJoints));
  }
  // The user's file has more information about the same skeleton.
  if (known_ && have_same_joints(*known_, *skeleton)) return {};
  use(skeleton);
  sink.take_skeleton(Clip(skeleton, FrameRate{}, 0), false);
  return {};
}

Result<void> BvhRowDecoder::take_row(std::string_view line, StreamSink& sink) {
  if (!rows_) return bad_packet("received a row, but no skeleton is known");
  RETARGET_TRY(rows_->read(line, *clip_, 0));
  frame_.time =
      fps_ > 0.0 ? static_cast<double>(count_) / fps_ : std::numeric_limits<double>::quiet_NaN();
  frame_.declared =
      declared_ ? declared_->time_of(count_) : std::numeric_limits<double>::quiet_NaN();
  ++count_;
  frame_.rotations.assign(clip_->rotations(0).begin(), clip_->rotations(0).end());
  frame_.translations.assign(clip_->translations(0).begin(), clip_->translations(0).end());
  sink.take_frame(frame_);
  return {};
}

class BvhRowEncoder final : public Encoder {
 public:
  std::string begin(const Clip& clip) override;
  Result<std::string> frame(const Clip& clip, int frame) override;

 private:
  std::optional<Error> error_;
  std::vector<std::string> rows_;
};

std::string BvhRowEncoder::begin(const Clip& clip) {
  const auto text = format_bvh(clip);
  if (!text) {
    error_ = text.error();
    return {};
  }
  const std::size_t time = text->find("Frame Time:");
  std::size_t begin = std::min(text->find('\n', time), text->size() - 1) + 1;
  std::string header = text->substr(0, begin);
  while (begin < text->size()) {
    const std::size_t end = std::min(text->find('\n', begin), text->size() - 1) + 1;
    rows_.push_back(text->substr(begin, end - begin));
    begin = end;
  }
  return header;
}

Result<std::string> BvhRowEncoder::frame(const Clip&, int frame) {
  if (error_) return failure(*error_);
  return rows_[static_cast<std::size_t>(frame)];
}

}  // namespace

StreamFormat bvh_row_format() {
  static constexpr std::array kExtras = {
      StreamExtra{"fps", "a number from 0 to 10000",
                  [](const std::string& value) { return sender_rate(value).has_value(); }}};
  return {.name = "bvh",
          .description =
              "motion rows of a BVH file as text, one per line; ?fps=N, because they "
              "have no timestamps",
          .port = 1118,
          .decoder = [](const StreamAddress& from) -> std::unique_ptr<Decoder> {
            return std::make_unique<BvhRowDecoder>(sender_rate(from.extra("fps")).value_or(0.0));
          },
          .encoder = make_encoder<BvhRowEncoder>,
          .extras = kExtras,
          .datagram_lines = 4096};  // A skeleton's rows may arrive line by line in a datagram.
}

}  // namespace retarget
