#include "app/plan/reference_file.h"

#include <cstddef>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/registry/format.h"
#include "retarget/check_options.h"
#include "retarget/file_endings.h"
#include "retarget/os.h"
#include "retarget/reference.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kUsualRate = 200.0;

Result<void> check_reference_ending(const std::string& path) {
  const std::string ending = ending_of(path);
  if (ending == ".npz" || ending == ".csv") return {};
  return usage_failure("the reference \"" + path + "\" is neither an NPZ nor a CSV file",
                       "give a name that ends in .npz or .csv");
}

}  // namespace

Result<std::string> reference_path(const std::string& output, const SaveOptions& options) {
  if (!options.reference.empty()) {
    TRY(check_reference_ending(options.reference));
    return options.reference;
  }
  if (options.reference_rate <= 0.0) return std::string();
  if (output == "-") {
    return usage_failure(
        OPTION("reference-rate") " needs a file name if the motion goes to standard output",
        "name it with " OPTION("reference"));
  }
  std::string base = os::without_last_separators(output);
  const std::string given = ending_of(base);
  if (!given.empty() && output_ending(given) == given) base.erase(base.size() - given.size());
  return base + ".reference.npz";
}

Result<ReferenceFile> write_reference(const std::string& path, const RobotClip& clip,
                                      const WriteMotionOptions& write, const SaveOptions& options,
                                      const LimitSet* limits) {
  ReferenceOptions how;
  how.rate =
      frame_rate_from_fps(options.reference_rate > 0.0 ? options.reference_rate : kUsualRate);
  if (limits != nullptr) how.limits = *limits;
  how.planted = write.contacts;
  if (write.scene) how.scene = &*write.scene;
  how.max_bytes = memory_share(0.0);
  auto made = make_reference(clip, how);
  if (!made && made.error().location.file.empty()) made.error().location.file = path;
  TRY_ASSIGN(const MotionReference reference, std::move(made));
  std::string bytes;
  if (ending_of(path) == ".csv") {
    bytes = format_reference_csv(reference);
  } else {
    TRY_ASSIGN(bytes, format_reference_npz(reference));
  }
  TRY_ASSIGN(OutputFile file, OutputFile::create(path));
  TRY(file.write(bytes));
  ReferenceFile written{std::move(file), {}};
  written.lines.push_back({"sampled", path + ": " + count_text(reference.samples, "sample") +
                                          " at " + to_text(reference.rate) + " per second"});
  for (std::string& note : reference_notes(reference)) {
    written.lines.push_back({"", std::move(note)});
  }
  return written;
}

}  // namespace retarget
