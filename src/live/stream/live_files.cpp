#include "live/stream/live_files.h"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "live/stream/stream_address.h"
#include "live/stream/stream_record.h"
#include "retarget/run.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// A replay does not read the output of its recording.
Result<std::vector<std::string>> files_read(const ServeOptions& options, const RobotSetup& robot) {
  Run run;
  run.robot = robot.loaded.choice;
  run.options = options.pipeline.run;
  std::vector<std::string> files = files_of(run, robot.loaded.data_folder);
  if (options.skeleton) files.push_back(options.skeleton->origin().name);
  if (!options.replay.empty()) {
    files.push_back(recorded_input_in(options.replay));
    files.push_back(recorded_file(options.replay, kRecordedOptions));
    return files;
  }
  RETARGET_TRY_ASSIGN(const StreamAddress from, parse_address(options.input));
  if (from.transport == Transport::kStdin) files.emplace_back("-");
  return files;
}

Result<std::vector<std::string>> files_written(const ServeOptions& options) {
  std::vector<std::string> files = {options.stats};
  if (options.outputs.empty()) files.emplace_back("-");  // As in Server::open_outputs().
  for (const std::string& place : options.outputs) {
    RETARGET_TRY_ASSIGN(const StreamAddress to, parse_address(place));
    if (to.transport == Transport::kFile) files.push_back(to.file);
    if (to.transport == Transport::kStdout) files.emplace_back("-");
  }
  std::error_code ignored;
  // A folder that is not there yet has no file of another name.
  if (options.record.empty() || !fs::is_directory(options.record, ignored)) return files;
  files.push_back(recorded_input_in(options.record));
  for (const char* name : {kRecordedOutput, kRecordedOptions}) {
    files.push_back(recorded_file(options.record, name));
  }
  return files;
}

constexpr std::string_view kAnyHost = "0.0.0.0";

// A run that receives its own output would take itself for the sender.
Result<void> check_own_input(const ServeOptions& options) {
  if (!options.replay.empty()) return {};
  RETARGET_TRY_ASSIGN(const StreamAddress from, parse_address(options.input));
  if (from.transport != Transport::kUdp || from.port == 0) return {};
  for (const std::string& place : options.outputs) {
    RETARGET_TRY_ASSIGN(const StreamAddress to, parse_address(place));
    if (to.transport != Transport::kUdp || to.port != from.port) continue;
    // Datagrams to 0.0.0.0 go to the loopback address.
    const bool is_local = is_this_machine(to) || to.host == kAnyHost;
    if (!is_local || (from.host != to.host && from.host != kAnyHost && to.host != kAnyHost)) {
      continue;
    }
    return usage_failure("the output \"" + place + "\" is also the input of this run",
                         "send to another port");
  }
  return {};
}

}  // namespace

std::string recorded_file(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / fs::path(name).filename()).string();
}

Result<void> check_live_files(const ServeOptions& options, const RobotSetup& robot) {
  RETARGET_TRY(check_own_input(options));
  RETARGET_TRY_ASSIGN(const auto read, files_read(options, robot));
  RETARGET_TRY_ASSIGN(auto written, files_written(options));
  return check_written(written, read);
}

}  // namespace retarget
