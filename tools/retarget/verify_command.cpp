// `retarget verify`: whether a run still gives the bytes that its sidecar tells of.

#include <algorithm>
#include <filesystem>

#include "base/file.h"
#include "base/suggest.h"
#include "base/text_size.h"
#include "clip_run.h"
#include "commands.h"
#include "provenance/hash.h"
#include "read_sidecar.h"
#include "retarget/version.h"
#include "run_setup.h"
#include "sidecar.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// a file that lies no longer where the run found it may lie beside the sidecar
void find_moved(std::string& file, const fs::path& beside) {
  std::error_code ignored;
  if (file.empty() || file == "-" || fs::exists(file, ignored)) return;
  const fs::path near = beside / fs::path(file).filename();
  const fs::path below = beside / file;
  if (fs::exists(below, ignored)) {
    file = below.string();
  } else if (fs::exists(near, ignored)) {
    file = near.string();
  }
}

Result<Sidecar> load_sidecar(const std::string& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    return input_failure(
        file, "expected the sidecar of a run, found a directory",
        "name a sidecar in it, such as " + (fs::path(file) / "walk.csv.json").string());
  }
  const auto content = read_file(file, ErrorKind::kInput, kMostTextBytes);
  if (!content) return failure(content.error());
  return read_sidecar(content->view(), file);
}

// the inputs whose content is another one, one line each
std::vector<std::string> changes(const Sidecar& sidecar, const std::vector<ReadFile>& now) {
  std::vector<std::string> changed;
  if (sidecar.version != version_number()) {
    changed.push_back("the tool is version " + version_number() + ", it was " + sidecar.version);
  }
  for (const ReadFile& then : sidecar.files) {
    const auto same_role = [&](const ReadFile& file) { return file.role == then.role; };
    const auto found = std::ranges::find_if(now, same_role);
    if (found == now.end()) {
      changed.push_back("the " + then.role + " " + then.file + " is no longer read");
    } else if (found->hash != then.hash && !then.hash.empty()) {
      changed.push_back("the " + then.role + " " + found->file + " has changed");
    }
  }
  return changed;
}

Result<void> verify_checked(const VerifyOptions& options, Console& console) {
  auto sidecar = load_sidecar(options.file);
  if (!sidecar) return failure(sidecar.error());
  RunOptions& run = sidecar->options;
  run.common = options.common;
  if (run.source.file == "-") {
    return input_failure(options.file,
                         "the motion came from standard input and cannot be read again");
  }
  if (auto sound = check_solving_options(run); !sound) {
    sound.error().kind = ErrorKind::kInput;
    sound.error().location.file = options.file;
    return sound;
  }
  const fs::path beside = fs::path(options.file).parent_path();
  for (std::string* file :
       {&run.source.file, &run.robot_xml, &run.robot_profile, &run.ik_config, &run.fit_config,
        &run.human.map, &run.human.tpose_file, &run.source.smpl_model, &run.limits, &run.robot}) {
    find_moved(*file, beside);
  }
  const auto data_folder = data_folder_of(run.common);
  if (!data_folder) return failure(data_folder.error());
  // the one output that the sidecar is of
  run.formats = {sidecar->format};
  run.output = sidecar->output;
  const auto setup = load_robot_setup(run, *data_folder, console);
  if (!setup) return failure(setup.error());
  const auto outcome = run_clip(run, *setup, *data_folder, console, Writing::kHashes);
  // which mapping is read is known from the source only
  const auto files =
      files_read(run, *data_folder, outcome ? outcome->mapping : setup->mappings.of_lafan1.file);
  if (!files) return failure(outcome ? files.error() : outcome.error());
  const std::vector<std::string> changed = changes(*sidecar, *files);
  for (const std::string& change : changed) console.line("changed", change);
  if (!outcome) return failure(outcome.error());
  const std::string& made = outcome->motions.front().hash;

  const std::string output = (beside / sidecar->output).string();
  std::error_code ignored;
  if (fs::exists(output, ignored)) {
    const auto there = hash_file(output);
    if (!there) return failure(there.error());
    if (*there != sidecar->hash) {
      return run_failure(output,
                         "the file is not the one that the sidecar tells of: it has changed");
    }
  }
  if (made == sidecar->hash) {
    console.line("verified", sidecar->output + ": the same bytes come out");
    return {};
  }
  return run_failure(options.file, "other bytes come out than those of " + sidecar->output,
                     changed.empty()
                         ? "nothing that is recorded has changed: another machine or build?"
                         : list_names(changed));
}

}  // namespace

ExitCode verify(const VerifyOptions& options, Console& console) {
  const auto done = verify_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
