#include "live/stream/stream_record.h"

#include <fmt/format.h>
#include <filesystem>
#include <iterator>
#include <utility>

#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr FrameBytesQueue::Bounds kWaiting = {16384, std::size_t{16} << 20};
constexpr std::size_t kMaxPacket = std::size_t{4} << 20;  // bytes

bool is_event(char letter) {
  return std::string_view("PSCETBF").find(letter) != std::string_view::npos;
}

}  // namespace

std::string recorded_input_in(const std::string& folder) {
  return (std::filesystem::path(folder) / "input.stream").string();
}

StreamRecorder::StreamRecorder(std::string name, const FrameOutputContext& context, Descriptor file)
    : name_(std::move(name)),
      tell_(context.tell),
      is_stopped_(context.is_stopped),
      waits_(context.waits),
      thread_(std::make_unique<WriterThread>(std::move(file), kWaiting)) {}

Result<StreamRecorder> StreamRecorder::create(const std::string& file,
                                              const FrameOutputContext& context) {
  StreamAddress to;
  to.transport = Transport::kFile;
  to.file = file;
  RETARGET_TRY_ASSIGN(Descriptor opened, open_for_writing(to));
  return StreamRecorder(file, context, std::move(opened));
}

void StreamRecorder::add(StreamEvent event, std::int64_t microseconds, std::string_view bytes) {
  // After a lost event, the following events would replay another stream.
  if (has_ended_) return;
  event_.clear();
  fmt::format_to(std::back_inserter(event_), "{} {} {}\n{}\n", static_cast<char>(event),
                 microseconds, bytes.size(), bytes);
  const bool taken = waits_ ? thread_->put_in_time(event_, is_stopped_) : thread_->put(event_);
  if (!taken) end();
}

void StreamRecorder::end() {
  has_ended_ = true;
  const int error = thread_->progress().error;
  tell_("record", fmt::format("{} stops here: {}; the run continues", name_,
                              error == 0 ? "the disk is too slow" : error_text(error)));
}

Result<void> StreamRecorder::finish() {
  const bool is_whole = thread_->finish(waits_, is_stopped_);
  if (is_whole && !has_ended_) return {};
  return run_failure(name_, "the recording is incomplete");
}

Result<StreamReplay> StreamReplay::open(const std::string& file) {
  StreamReplay replay;
  replay.name_ = file;
  replay.file_.open(file, std::ios::binary);
  if (!replay.file_) return input_failure(file, "no recording found");
  return replay;
}

Result<bool> StreamReplay::next(Entry& entry) {
  constexpr std::size_t kMaxLine = 64;
  std::string line;
  for (char c = 0; line.size() < kMaxLine && file_.get(c) && c != '\n';) line += c;
  if (line.empty() && file_.eof()) return false;
  const auto bad = [&] {
    return input_failure(name_, fmt::format("expected a recorded event after {} us", latest_));
  };
  const std::size_t blank = line.find(' ', 2);
  if (line.size() < 5 || !is_event(line[0]) || line[1] != ' ' || blank == std::string::npos) {
    return bad();
  }
  const auto time = parse_number<std::int64_t>(std::string_view(line).substr(2, blank - 2));
  const auto size = parse_number<std::size_t>(std::string_view(line).substr(blank + 1));
  if (!time || !size || *time < latest_ || *size > kMaxPacket) return bad();
  entry.event = static_cast<StreamEvent>(line[0]);
  entry.microseconds = latest_ = *time;
  entry.bytes.resize(*size);
  file_.read(entry.bytes.data(), static_cast<std::streamsize>(*size));
  if (!file_ || file_.get() != '\n') return bad();
  return true;
}

}  // namespace retarget
