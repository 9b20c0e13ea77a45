// Pages and renderings that a run writes next to its motion.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "retarget/report.h"
#include "retarget/run.h"
#include "retarget/solve.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"

namespace retarget {

std::vector<SummaryLine> mesh_lines(const RobotMeshes& meshes) {
  std::vector<SummaryLine> lines;
  if (!meshes.bodies.empty()) {
    lines.push_back(
        {"meshes", (meshes.bodies.size() == 1 ? std::string("1 body")
                                              : std::to_string(meshes.bodies.size()) + " bodies") +
                       " of the robot"});
  }
  for (const std::string& note : meshes.notes) {
    lines.push_back({lines.empty() ? "meshes" : "", note});
  }
  return lines;
}

RunDrawing page_of_run(std::string path) {
  return {std::move(path), true,
          [](const Motion& motion, const QualityReport* report,
             Observer& observer) -> Result<DrawnFile> {
            RETARGET_TRY_ASSIGN(
                const RobotMeshes meshes,
                load_robot_meshes(*motion.plan.robot.robot, motion.plan.robot.model));
            observer.lines(mesh_lines(meshes));
            observer.lines(scene_lines(motion.scene ? &motion.scene->clip : nullptr));
            const std::string label = std::filesystem::path(report->file).stem().string();
            RETARGET_TRY_ASSIGN(std::string page, view_page(motion, label, report, &meshes));
            const std::string size = number_text(static_cast<double>(page.size()) / 1e6, 2);
            return DrawnFile{std::move(page), {"page", size + " MB (open it in a browser)"}};
          }};
}

RunDrawing picture_of_run(std::string path, int poses) {
  return {std::move(path), false,
          [poses](const Motion& motion, const QualityReport* /*report*/,
                  Observer& /*observer*/) -> Result<DrawnFile> {
            StripPictureOptions options;
            if (poses > 0) options.poses = poses;
            const int drawn = std::min(options.poses, motion.clip.frame_count());
            return DrawnFile{draw_strip_picture(motion, options),
                             {"picture", count_text(drawn, "pose")}};
          }};
}

}  // namespace retarget
