// Checks of a live run before its sockets and files are opened.

#include <filesystem>
#include <string>
#include <system_error>

#include "live/stream/byte_source.h"
#include "live/stream/frame_output.h"
#include "live/stream/stream_formats.h"
#include "live/stream/stream_record.h"
#include "retarget/file.h"
#include "retarget/live_table.h"
#include "retarget/serve.h"
#include "retarget/try.h"

namespace retarget {
namespace {

Result<void> check_source(const StreamAddress& from) {
  RETARGET_TRY_ASSIGN(const StreamFormat* format, find_stream_format(from.format));
  RETARGET_TRY(check_input(from, *format));
  RETARGET_TRY(SenderFilter::parse(from.extra("from")));
  return {};
}

// Files of another recording must not be mixed with those of this one.
Result<void> check_recording(const std::string& folder) {
  std::error_code ignored;
  if (folder.empty() || !std::filesystem::exists(recorded_input_in(folder), ignored)) return {};
  return usage_failure(folder + " already contains a recording", "give another folder");
}

}  // namespace

Result<void> check_serve(const ServeOptions& options) {
  const LivePipelineOptions& pipeline = options.pipeline;
  RETARGET_TRY(check_live_options(pipeline.live, pipeline.run.solve.method));
  RETARGET_TRY(check_options(pipeline.run));
  RETARGET_TRY_ASSIGN(const StreamAddress from, parse_address(options.input));
  RETARGET_TRY(check_source(from));
  for (const std::string& place : options.outputs) {
    RETARGET_TRY_ASSIGN(const StreamAddress to, parse_address(place));
    RETARGET_TRY(check_frame_output(to));
  }
  if (!options.stats.empty()) RETARGET_TRY(check_output_folder(options.stats));
  RETARGET_TRY(check_recording(options.record));
  if (!options.replay.empty()) RETARGET_TRY(StreamReplay::open(recorded_input_in(options.replay)));
  return {};
}

}  // namespace retarget
