#include <array>
#include <utility>

#include "base/suggest.h"
#include "base/try.h"
#include "human/human_clip.h"
#include "retarget/view.h"
#include "robot/normalize_start.h"
#include "view/page_assets.h"
#include "view/page_data.h"
#include "view/svg.h"

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
  // in the order of the shell
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
                              const QualityReport* report) {
  QualityReport measured;
  if (report == nullptr) {
    TRY_ASSIGN(measured, evaluate(motion));
    report = &measured;
  }
  // as it is written
  RobotClip clip = motion.clip;
  if (motion.plan.options.save.normalize_start) normalize_start(clip);
  const HumanClip human = to_human(*motion.source, motion.plan.human.calibration);
  const PageMotion shown{label, &clip, &human, report, &motion.plan.limits};
  return view_page({&shown, 1});
}

}  // namespace retarget
