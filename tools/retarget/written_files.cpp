#include "written_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <optional>
#include <system_error>

#include "base/file.h"
#include "robot/find_robot.h"
#include "robot_mapping.h"
#include "run_setup.h"

namespace retarget::cli {

namespace fs = std::filesystem;

namespace {

using Identity = std::pair<dev_t, ino_t>;

// of a regular file; of pipes and devices nothing is overwritten
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

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// files of a folder of ours, which are all read
void append_folder(std::vector<std::string>& files, const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    files.push_back(at->path().string());
  }
}

// dialects and gates
std::vector<std::string> files_of(const CommonOptions& options) {
  std::vector<std::string> files;
  if (const auto folder = data_folder_of(options)) {
    append_folder(files, *folder / "configs" / "skeletons");
    append_folder(files, *folder / "configs" / "quality");
  }
  return files;
}

// model, profile and mappings of a robot that has a folder
std::vector<std::string> robot_files(const RunOptions& options) {
  const auto folder = data_folder_of(options.common);
  if (!folder || options.robot.empty()) return {};
  const auto robot = find_robot(options.robot, *folder / "robots");
  if (!robot) return {};
  std::vector<std::string> files = {robot->model.string(), robot->profile.string()};
  const fs::path place = robot->model.parent_path();
  const auto mappings =
      find_mappings({}, "gmr", place, *folder, fs::absolute(place).filename().string());
  if (mappings) append(files, {mappings->of_lafan1, mappings->of_others});
  return files;
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
  if (auto spared = check_spared(output); !spared) return spared;
  if (output == "-") return {};
  if (outputs_.find(output, STDOUT_FILENO) != nullptr) {
    return usage_failure("two outputs are the file \"" + output + "\"");
  }
  outputs_.add(output, STDOUT_FILENO);
  return check_output_folder(output);
}

Result<void> check_written(const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs) {
  WrittenFiles written(inputs);
  for (const std::string& output : outputs) {
    if (auto taken = written.take(output); !taken) return taken;
  }
  return {};
}

std::vector<std::string> files_of(const SourceOptions& source, const HumanOptions& human) {
  return {source.file, source.smpl_model, human.map, human.tpose_file};
}

std::vector<std::string> files_of(const RunOptions& options) {
  std::vector<std::string> files = files_of(options.source, options.human);
  append(files, {options.smpl_file, options.robot_xml, options.robot_profile, options.ik_config,
                 options.limits, options.fit_config});
  append(files, robot_files(options));
  append(files, files_of(options.common));
  return files;
}

std::vector<std::string> files_of(const EditOptions& options) {
  std::vector<std::string> files = files_of(options.source, options.human);
  append(files, {options.like, options.path.to});
  append(files, options.files);
  append(files, files_of(options.common));
  return files;
}

}  // namespace retarget::cli
