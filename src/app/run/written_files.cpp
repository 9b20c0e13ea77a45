#include "retarget/run.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/option_table.h"
#include "retarget/robots.h"

namespace retarget {

namespace fs = std::filesystem;

namespace {

using Identity = std::pair<dev_t, ino_t>;

// Identity of a regular file. Pipes and devices are never overwritten.
std::optional<Identity> identity_of(const std::string& path, int stream) {
  struct stat info {};
  const int found = path == "-" ? ::fstat(stream, &info) : ::stat(path.c_str(), &info);
  if (found != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return Identity{info.st_dev, info.st_ino};
}

std::string whole_path(const std::string& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? fs::path(path).lexically_normal().string() : whole.string();
}

// Adds model, profile and configurations of a robot that has a folder.
void append_robot(std::vector<std::string>& files, const std::string& name,
                  const fs::path& data_folder) {
  if (name.empty()) return;
  const auto robot = find_robot(name, robot_folders(data_folder));
  if (!robot) return;
  files.insert(files.end(), {robot->model.string(), robot->profile.string()});
  const fs::path place = robot->model.parent_path();
  const auto configs =
      find_configs({}, Method::kGmr, place, data_folder, fs::absolute(place).filename().string());
  if (configs) files.insert(files.end(), {configs->of_lafan1, configs->of_others});
}

}  // namespace

void KnownFiles::add(const std::string& path, int stream) {
  if (path.empty()) return;
  if (const auto identity = identity_of(path, stream)) by_identity_.emplace(*identity, path);
  if (path != "-") by_path_.emplace(whole_path(path), path);
}

const std::string* KnownFiles::find(const std::string& path, int stream) const {
  if (path.empty()) return nullptr;
  if (const auto identity = identity_of(path, stream)) {
    const auto found = by_identity_.find(*identity);
    return found == by_identity_.end() ? nullptr : &found->second;
  }
  if (path == "-") return nullptr;
  const auto found = by_path_.find(whole_path(path));
  return found == by_path_.end() ? nullptr : &found->second;
}

WrittenFiles::WrittenFiles(const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) inputs_.add(input, STDIN_FILENO);
}

Result<void> WrittenFiles::check_spared(const std::string& output) const {
  const std::string* input = inputs_.find(output, STDOUT_FILENO);
  if (input == nullptr) return {};
  const std::string by_name = *input == output ? "" : " \"" + output + "\"";
  return usage_failure("the output" + by_name + " would overwrite the input \"" + *input + "\"",
                       "give another name");
}

Result<void> WrittenFiles::take(const std::string& output) {
  if (output.empty()) return {};
  TRY(check_spared(output));
  if (output == "-") return {};
  if (outputs_.find(output, STDOUT_FILENO) != nullptr) {
    return usage_failure("two outputs name the same file \"" + output + "\"");
  }
  outputs_.add(output, STDOUT_FILENO);
  return check_output_folder(output);
}

Result<void> check_written(const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs) {
  WrittenFiles written(inputs);
  for (const std::string& output : outputs) TRY(written.take(output));
  return {};
}

std::vector<std::string> files_of(const Run& run, const std::string& data_folder) {
  std::vector<std::string> files = {run.motion};
  Run copy = run;
  for (const Option& row : run_table(copy)) {
    if (row.info.file != OptionFile::kNone) files.push_back(to_text(row.get()));
  }
  if (data_folder.empty()) return files;
  append_robot(files, run.robot.name, data_folder);
  append_robot(files, run.options.source.from_robot, data_folder);
  for (const char* name : {"skeletons", "quality"}) {
    for (const fs::path& file : files_in_folder(fs::path(data_folder) / "configs" / name)) {
      files.push_back(file.string());
    }
  }
  return files;
}

Result<void> check_outputs(const Run& run, bool sidecar, const std::vector<std::string>& inputs,
                           const std::vector<std::string>& others) {
  WrittenFiles written(inputs);
  // First check for an input given as output by mistake, before its extension is interpreted.
  if (run.output != "-" && run.options.save.formats.size() <= 1) {
    TRY(written.check_spared(run.output));
  }
  TRY_ASSIGN(const auto items, plan_outputs(run.output, run.options.save));
  for (const std::string& other : others) TRY(written.take(other));
  if (run.options.save.contacts == "-") {
    return usage_failure(OPTION("contacts") " needs a file", "name one that ends in .csv");
  }
  TRY(written.take(run.options.save.contacts));
  for (const OutputItem& item : items) {
    TRY(written.take(item.path));
    if (!sidecar) continue;
    if (item.path == "-") {
      return usage_failure(OPTION("sidecar") " needs an output file",
                           "name a file with " OPTION("output"));
    }
    TRY(written.take(item.path + ".json"));
  }
  return {};
}

}  // namespace retarget
