// view: pages that play motions in a browser.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <deque>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "bindings.h"
#include "gates.h"
#include "handles.h"
#include "notes_observer.h"
#include "raise.h"
#include "retarget/file.h"
#include "retarget/measure.h"
#include "retarget/robot_meshes.h"
#include "retarget/run.h"
#include "retarget/try.h"
#include "retarget/view.h"

namespace retarget::python {

using namespace nb::literals;

namespace {

// A motion of a page with everything that PageMotion points to.
struct ShownMotion {
  std::string label;
  RobotClip clip;
  std::optional<HumanClip> human;
  QualityReport report;
  LimitSet limits;
};

Result<ShownMotion> shown_as_solved(const MotionHandle& motion) {
  const Motion& solved = *motion.solved;
  RETARGET_TRY_ASSIGN(QualityReport report, retarget::evaluate(solved, false));
  return ShownMotion{{},
                     solved.clip,
                     to_human(*solved.source, solved.plan.human.calibration),
                     std::move(report),
                     solved.plan.limits};
}

// Shows a motion that was not solved here, next to a clip if there is one.
Result<ShownMotion> shown_beside(const MotionHandle& motion, const ClipHandle* clip,
                                 Observer& observer) {
  ShownMotion shown;
  shown.clip = *motion.clip;
  Options options = measuring_options(motion);
  if (options.solve.limits.empty()) options.solve.limits = motion.robot->limits_for({});
  RETARGET_TRY_ASSIGN(shown.limits, load_limits(*motion.robot, options.solve.limits));
  if (clip == nullptr) {
    shown.report = measure_motion(shown.clip, shown.limits, nullptr).report;
    return shown;
  }
  RETARGET_TRY_ASSIGN(MotionBeside measured,
                      measure_against(*motion.clip, record_against(motion, *clip, observer), **clip,
                                      motion.robot.loaded, options, false, observer));
  shown.human = std::move(measured.human);
  shown.report = std::move(measured.report);
  return shown;
}

// Returns the HTML of a page. `clips` and `labels` have one entry per motion; a clip may be None.
nb::str page_html(const nb::list& motions, const nb::list& clips, const nb::list& labels,
                  const nb::object& gates, const std::string& meshes, const std::string& title) {
  std::deque<ShownMotion> shown;
  const MotionHandle* first = nullptr;
  for (std::size_t i = 0; i < nb::len(motions); ++i) {
    const auto* motion = nb::cast<const MotionHandle*>(motions[i]);
    const nb::object given = clips[i];
    const ClipHandle* clip = given.is_none() ? nullptr : nb::cast<const ClipHandle*>(given);
    if (first == nullptr) first = motion;
    WarningsObserver observer;
    shown.push_back(without_gil([&] {
      return motion->solved && clip == nullptr ? shown_as_solved(*motion)
                                               : shown_beside(*motion, clip, observer);
    }));
    observer.tell();
    shown.back().label = bytes_of_name(labels[i], "labels");
    shown.back().report.file = std::filesystem::path(motion->name).filename().string();
    gates_of(gates, motion->robot.loaded.data_folder).judge(shown.back().report);
  }
  if (first == nullptr) raise(usage_failure("view: expected at least one motion").value());
  RobotMeshes loaded;
  const std::string page = without_gil([&]() -> Result<std::string> {
    RETARGET_TRY_ASSIGN(loaded,
                        load_robot_meshes(*first->robot, first->robot.loaded.model, meshes));
    std::vector<PageMotion> all;
    for (const ShownMotion& each : shown) {
      all.push_back({each.label,
                     &each.clip,
                     each.human ? &*each.human : nullptr,
                     &each.report,
                     &each.limits,
                     {},
                     &loaded});
    }
    PageOptions options;
    options.title = title;
    return view_page(all, options);
  });
  if (!meshes.empty()) warn(loaded.notes, meshes);
  return text_of(page);
}

// Returns a strip of poses, as SVG or PNG.
nb::bytes strip_bytes(const MotionHandle& motion, int poses, bool svg, const std::string& title) {
  if (poses < 1 || poses > 100) {
    raise(usage_failure("poses: expected 1 to 100, found " + std::to_string(poses)).value());
  }
  const std::string picture = without_gil([&]() -> Result<std::string> {
    std::optional<HumanClip> human;
    if (motion.solved) {
      human = to_human(*motion.solved->source, motion.solved->plan.human.calibration);
    }
    const HumanClip* source = human ? &*human : nullptr;
    if (svg) return draw_strip(*motion.clip, source, {poses, title});
    StripPictureOptions options;
    options.poses = poses;
    return draw_strip_picture(*motion.clip, source, options);
  });
  return nb::bytes(picture.data(), picture.size());
}

// Writes a page or a picture as the command does: completely, or the old file stays.
void write_drawing(const nb::object& file, const nb::bytes& content, bool is_page) {
  const std::string path = bytes_of_path(file, "output");
  if (path == "-") raise(usage_failure("output: expected a file, found standard output").value());
  value_of(is_page ? check_output_ending(path, {".html", ".htm"}, "a page in HTML")
                   : check_output_ending(path, {".png", ".svg"}, "a picture"));
  const std::string_view text(content.c_str(), content.size());
  without_gil([&] { return write_file(path, text); });
}

}  // namespace

void bind_pages(nb::module_& module) {
  module.def("page_html", &page_html, "motions"_a, "clips"_a, "labels"_a, "gates"_a.none(),
             "meshes"_a, "title"_a);
  module.def("write_drawing", &write_drawing, "file"_a.none(), "content"_a, "is_page"_a);
  module.def("strip_bytes", &strip_bytes, "motion"_a, "poses"_a, "svg"_a, "title"_a);
}

}  // namespace retarget::python
