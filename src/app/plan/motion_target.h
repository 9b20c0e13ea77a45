#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/output_folder.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/scene.h"
#include "retarget/solve.h"
#include "retarget/solved_scene.h"

namespace retarget {

/// Output of a motion in one format: a file or folder, written completely or not at all.
class MotionTarget {
 public:
  [[nodiscard]] static Result<MotionTarget> create(const OutputItem& item);

  [[nodiscard]] Result<void> write(const std::vector<FormattedFile>& files);
  [[nodiscard]] Result<void> commit();

 private:
  explicit MotionTarget(OutputFile file) : place_(std::move(file)) {}
  explicit MotionTarget(OutputFolder folder) : place_(std::move(folder)) {}
  std::variant<OutputFile, OutputFolder> place_;
};

/// Writes contacts as CSV to a file that is not committed yet. Error (kUsage): contacts are
/// unknown.
/// @param labels  contacts in a scene; empty: no scene.
[[nodiscard]] Result<OutputFile> write_contacts(const std::string& path,
                                                const std::optional<FootContacts>& contacts,
                                                const FrameRate& rate,
                                                const std::optional<ContactLabels>& labels);

/// Writes the scene of a robot to a file that is not committed yet. Errors: those of format_scene;
/// the motion has no scene (kUsage).
[[nodiscard]] Result<OutputFile> write_scene(const std::string& path, const RobotClip& motion,
                                             const std::optional<SceneClip>& scene);

/// Applies normalize_start to a motion before writing; the human shown with it and its scene move
/// along.
void normalize_start(RobotClip& clip, WriteMotionOptions& write);

/// Name of the requested reference file next to an output; empty: none.
/// Errors (kUsage): an extension other than .npz and .csv; no name if the motion goes to standard
/// output.
[[nodiscard]] Result<std::string> reference_path(const std::string& output,
                                                 const SaveOptions& options);

/// A reference that is written but not committed yet.
struct ReferenceFile {
  OutputFile file;
  std::vector<SummaryLine> lines;  ///< Samples, corrections, and what remains beyond limits.
};

/// Makes the reference of a motion (make_reference) and writes it.
/// @param path    from reference_path(), not empty.
/// @param clip    the motion as it is written to its file.
/// @param write   contacts and scene of the motion.
/// @param limits  joint ranges; null: the robot's default set.
[[nodiscard]] Result<ReferenceFile> write_reference(const std::string& path, const RobotClip& clip,
                                                    const WriteMotionOptions& write,
                                                    const SaveOptions& options,
                                                    const LimitSet* limits);

}  // namespace retarget
