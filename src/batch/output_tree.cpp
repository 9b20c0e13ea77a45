#include "batch/output_tree.h"

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "retarget/option_name.h"
#include "retarget/run.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Files of a batch other than motions.
constexpr std::array kOwnFiles = {"manifest.jsonl", "summary.csv", "options.json",   "passed.txt",
                                  "failed.tsv",     "train.txt",   "validation.txt", "test.txt",
                                  "duplicates.tsv", "motions.yaml"};

// The files of a clip below a folder, including sidecars.
Result<std::vector<std::string>> outputs_of(const BatchInput& input, const BatchRequest& request,
                                            const std::string& folder) {
  const SaveOptions& save = request.run.options.save;
  RETARGET_TRY_ASSIGN(const auto items,
                      plan_outputs(folder + batch_output(save, input.relative), save));
  std::vector<std::string> files;
  for (const OutputItem& item : items) {
    files.push_back(item.path);
    if (request.of_clip.sidecar) files.push_back(item.path + ".json");
  }
  if (request.contacts) files.push_back(folder + contacts_output(input.relative));
  return files;
}

// All files that a batch would write, to detect duplicates and conflicts of files with folders.
class OutputTree {
 public:
  explicit OutputTree(const BatchRequest& request) : request_(request) {
    if (!request.pack.empty()) files_[request.pack] = {};
    // With several robots, each has its own folder of clips.
    if (request.robots.size() > 1) return;
    for (const char* own : kOwnFiles) files_[own] = {};
  }

  Result<void> add(const BatchInput& input) {
    RETARGET_TRY_ASSIGN(const auto files, outputs_of(input, request_, {}));
    for (const std::string& file : files) RETARGET_TRY(add_file(file, input));
    return {};
  }

  // Call this after all files have been added.
  [[nodiscard]] Result<void> check_folders() const {
    for (const auto& [folder, input] : folders_) {
      const auto file = files_.find(folder);
      if (file == files_.end()) continue;
      return usage_failure("\"" + input->path + "\" would be written to a folder \"" + folder +
                               "\", which is " + what_is(file->second),
                           "rename one of them or exclude it with " RETARGET_OPTION("exclude"));
    }
    return {};
  }

 private:
  static std::string what_is(const BatchInput* owner) {
    return owner == nullptr ? "a file of the batch itself"
                            : "the output of \"" + owner->path + "\"";
  }

  Result<void> add_file(const std::string& path, const BatchInput& input) {
    const auto [owner, is_new] = files_.emplace(path, &input);
    if (!is_new) {
      return usage_failure("the output of \"" + input.path + "\" would be called \"" + path +
                               "\", which is " + what_is(owner->second),
                           "rename one of them, exclude it with " RETARGET_OPTION(
                               "exclude") ", or write one format at a time");
    }
    for (fs::path folder = fs::path(path).parent_path(); !folder.empty();
         folder = folder.parent_path()) {
      if (!folders_.emplace(folder.string(), &input).second) break;
    }
    return {};
  }

  const BatchRequest& request_;
  std::map<std::string, const BatchInput*> files_;  // Clip; null: a file of the batch.
  std::map<std::string, const BatchInput*> folders_;
};

}  // namespace

Result<void> check_outputs_of(const std::vector<BatchInput>& inputs, const BatchRequest& request) {
  OutputTree tree(request);
  for (const BatchInput& input : inputs) {
    RETARGET_TRY(tree.add(input));
  }
  return tree.check_folders();
}

Result<void> check_outputs_spared(const std::vector<BatchInput>& inputs,
                                  const BatchRequest& request, const std::string& output,
                                  const std::list<BatchRobot>& robots) {
  std::vector<std::string> read = request.lists;
  read.insert(read.end(), request.gates.begin(), request.gates.end());
  read.push_back(request.clips);
  for (const BatchInput& input : inputs) read.push_back(input.path);
  for (const BatchRobot& robot : robots) {
    const std::vector<std::string> of_robot = files_of(robot.run, robot.setup.loaded.data_folder);
    read.insert(read.end(), of_robot.begin(), of_robot.end());
  }
  const WrittenFiles written(read);
  const std::string folder = output + "/";
  for (const char* own : kOwnFiles) {
    RETARGET_TRY(written.check_spared(folder + own));
  }
  for (const BatchRobot& robot : robots) {
    if (!request.pack.empty())
      RETARGET_TRY(written.check_spared(folder + robot.folder + request.pack));
    for (const BatchInput& input : inputs) {
      RETARGET_TRY_ASSIGN(const auto files, outputs_of(input, request, folder + robot.folder));
      for (const std::string& file : files) RETARGET_TRY(written.check_spared(file));
    }
  }
  return {};
}

}  // namespace retarget
