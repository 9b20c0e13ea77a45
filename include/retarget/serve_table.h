#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/serve.h"

// Live runs described by options. Link retarget::live.
namespace RETARGET_API retarget {

/// A live run with the robot's name. A recording stores most of its members.
struct ServeRequest {
  RobotChoice robot;
  ServeOptions serve;    ///< Except the skeleton.
  std::string skeleton;  ///< File of the skeleton; empty: none.
  bool plain = false;    ///< Use only the published method.
  /// Names of the options that were set explicitly (serve_table, noting_given).
  std::vector<std::string> given = {};

  [[nodiscard]] bool is_given(std::string_view name) const;
};

/// The options that a recording keeps: input, skeleton, calibration, retargeting, robot and human.
[[nodiscard]] OptionTable recorded_serve_table(ServeRequest& request);
/// All options of a live run. Setting one adds its name to `given`.
[[nodiscard]] OptionTable serve_table(ServeRequest& request);
/// The options of a player that are not those of a human.
[[nodiscard]] OptionTable player_table(PlayOptions& options);

/// Restores the options of the recording to replay, if there is one, and checks the request.
/// Errors: no robot, options that contradict each other or have no effect (kUsage); those of
/// load_options.
[[nodiscard]] Result<void> prepare_serve(ServeRequest& request);

/// Loads the skeleton, chooses the pace, writes the options into the folder of the recording, and
/// serves.
/// @param robot    robot of the request, set up with the options of its pipeline.
/// @param request  result of prepare_serve().
[[nodiscard]] Result<ServeSummary> serve_request(const RobotSetup& robot, ServeRequest request,
                                                 const ServeControl& control);

/// Lines that describe a run: a label and a text.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> serve_summary_lines(
    const ServeSummary& summary);

}  // namespace retarget
