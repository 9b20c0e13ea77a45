#include <array>
#include <utility>

#include "base/try.h"
#include "retarget/text.h"
#include "retarget/view.h"
#include "view/page_assets.h"
#include "view/page_data.h"
#include "view/svg.h"
#include "view/written_motion.h"

namespace retarget {
namespace {

std::string title_of(std::span<const PageMotion> motions) {
  std::vector<std::string> labels;
  for (const PageMotion& motion : motions) {
    labels.push_back(motion.label.empty() ? motion.clip->robot().name() : motion.label);
  }
  return list_names(labels);
}

}  // namespace

std::string assemble_page(const std::string& title, PageData data) {
  const std::string policy = "default-src 'none'; script-src " + kPageScript.policy_source() +
                             "; style-src " + kPageStyle.policy_source() +
                             "; base-uri 'none'; form-action 'none'";
  // In the order of the marks in the shell.
  const std::array<std::pair<std::string_view, std::string>, 6> parts = {
      {{"@POLICY@", policy},
       {"@TITLE@", xml_text(title)},
       {"@STYLE@", kPageStyle.text()},
       {"@HEADER@", std::move(data.header)},
       {"@TRACKS@", std::move(data.tracks)},
       {"@SCRIPT@", kPageScript.text()}}};
  return fill_shell(kPageShell, parts);
}

Result<std::string> view_page(std::span<const PageMotion> motions, const PageOptions& options) {
  PageOptions with_title = options;
  if (with_title.title.empty()) with_title.title = title_of(motions);
  TRY_ASSIGN(PageData data, page_data(motions, with_title));
  return assemble_page(with_title.title, std::move(data));
}

Result<std::string> view_page(const Motion& motion, const std::string& label,
                              const QualityReport* report, const RobotMeshes* meshes) {
  QualityReport measured;
  if (report == nullptr) {
    TRY_ASSIGN(measured, evaluate(motion));
    report = &measured;
  }
  const WrittenMotion written(motion);
  const PageMotion shown{label, &written.clip, &written.human, report, &motion.plan.limits,
                         {},    meshes};
  return view_page({&shown, 1});
}

}  // namespace retarget
