#include "read_source.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <system_error>

#include "base/file.h"
#include "base/machine.h"
#include "bvh/read_bvh.h"
#include "smpl/read_smpl.h"

namespace retarget::cli {
namespace {

// a motion's text, its clip, the same at another rate, and what is made of it share the memory
constexpr std::uint64_t kShares = 4;

std::optional<double> given_rate(const SourceOptions& options) {
  return options.source_fps > 0.0 ? std::optional<double>(options.source_fps) : std::nullopt;
}

Result<SourceMotion> read_bvh_source(std::string_view bytes, const SourceOptions& options,
                                     bool skeleton_only) {
  BvhReadOptions read_options;
  read_options.lenient = options.lenient;
  read_options.motion_optional = skeleton_only;
  read_options.root = options.root;
  read_options.source_fps = given_rate(options);
  read_options.most_clip_bytes = memory_share(options);
  auto file = read_bvh(bytes, source_name(options), read_options);
  if (!file) return failure(file.error());
  return SourceMotion{std::move(file->clip), std::move(file->warnings), std::nullopt};
}

Result<SourceMotion> read_smpl_source(std::string_view bytes, const SourceOptions& options) {
  SmplReadOptions read_options;
  read_options.source_fps = given_rate(options);
  read_options.most_clip_bytes = memory_share(options);
  std::optional<SmplBody> body;
  if (!options.smpl_model.empty()) {
    auto loaded = load_smpl_body(options.smpl_model);
    if (!loaded) return failure(loaded.error());
    body = std::move(*loaded);
    read_options.body = &*body;
  }
  auto motion = read_smpl(bytes, source_name(options), read_options);
  if (!motion) return failure(motion.error());
  SourceMotion result{std::move(motion->clip), std::move(motion->warnings), motion->height};
  if (motion->approximate_body) {
    result.warnings.push_back({0, 0,
                               "bone lengths are those of a generic body, approximately; "
                               "--smpl-model FILE takes them from your body model"});
  }
  return result;
}

}  // namespace

std::uint64_t memory_bound(const SourceOptions& options) {
  if (options.memory_gb > 0.0) return static_cast<std::uint64_t>(options.memory_gb * 1e9);
  return usable_memory() / 4 * 3;
}

std::size_t memory_share(const SourceOptions& options) {
  const std::uint64_t bound = memory_bound(options);
  return bound == 0 ? std::numeric_limits<std::size_t>::max() : bound / kShares;
}

void add_memory_hint(Error& error) {
  const bool too_large = error.message.starts_with("expected at most ") && error.hint.empty();
  if (too_large) error.hint = "--memory gives more; or split the motion";
}

Result<void> check_no_folder(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::is_directory(path, ignored)) return {};
  return input_failure(path, "expected a motion file, found a directory",
                       "retarget batch " + path + " -o OUT --robot NAME takes a folder of clips");
}

Result<SourceMotion> read_source(const SourceOptions& options, bool skeleton_only,
                                 Console& console) {
  if (auto file = check_no_folder(options.file); !file) return failure(file.error());
  auto bytes = read_file(options.file, ErrorKind::kInput, memory_share(options));
  if (!bytes) {
    add_memory_hint(bytes.error());
    return failure(bytes.error());
  }
  // archives hold NPZ, and no BVH file begins like one
  const bool is_archive = bytes->view().starts_with("PK\x03\x04");
  if (!options.smpl && !is_archive && !options.smpl_model.empty()) {
    return usage_failure(
        "--smpl-model is a body of SMPL motions, and \"" + source_name(options) + "\" is none",
        "leave it out");
  }
  auto motion = options.smpl || is_archive ? read_smpl_source(bytes->view(), options)
                                           : read_bvh_source(bytes->view(), options, skeleton_only);
  if (!motion) return motion;
  motion->bytes = bytes->view().size();
  console.warn(motion->warnings, source_name(options));
  return motion;
}

std::string source_name(const SourceOptions& options) {
  return options.file == "-" ? "standard input" : options.file;
}

}  // namespace retarget::cli
