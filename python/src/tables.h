#pragma once

#include "retarget/option_table.h"

namespace retarget {
struct BatchRequest;
struct ConvertRequest;
struct GalleryRequest;
struct MeasureRequest;
struct Options;
struct ServeRequest;
}  // namespace retarget

namespace retarget::python {

struct EditOptions;
struct LiveKeywords;

/// Returns all options of batch except inputs, output and robots.
[[nodiscard]] OptionTable batch_keywords(BatchRequest& request);

/// Returns the options of certify except the files and the robot's name.
[[nodiscard]] OptionTable certify_keywords(MeasureRequest& request);

/// Returns the options of convert except the robot's name and the files.
[[nodiscard]] OptionTable convert_keywords(ConvertRequest& request);

/// Returns the options common to all edits: how to recognise the human, and which part to use.
[[nodiscard]] OptionTable edit_table(EditOptions& options);

/// Returns the options of evaluate: limits, how to read the source, and whether to compute inverse
/// dynamics.
[[nodiscard]] OptionTable evaluate_table(Options& options, bool& dynamics);

/// Returns the options of a gallery except its folders and the robot.
[[nodiscard]] OptionTable gallery_keywords(GalleryRequest& request);

/// Returns the options of live except the robot and the rate.
[[nodiscard]] OptionTable live_keywords(LiveKeywords& options);

/// Returns the options of serve except the robot and the rate.
[[nodiscard]] OptionTable serve_keywords(ServeRequest& request);

/// Returns all options of to_robot except the robot: human, part, solver, time and output.
[[nodiscard]] OptionTable solving_table(Options& options);

}  // namespace retarget::python
