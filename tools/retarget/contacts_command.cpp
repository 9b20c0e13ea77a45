// `retarget contacts`: the contacts that a run holds, as a table.

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/contact_table.h"
#include "retarget/file.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/solve.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {

Result<void> contacts(const ContactsArguments& arguments, Console& console) {
  const Run& run = arguments.run.run;
  RETARGET_TRY(check_robot_choice(run.robot));
  RETARGET_TRY(check_config_choice(run.robot, run.options.solve));
  RETARGET_TRY(check_solving_options(run.options));
  RETARGET_TRY(check_written({arguments.json}, files_read(run, arguments.run.common)));
  RETARGET_TRY(check_output_ending(arguments.json, {".json"}, "a table in JSON"));
  RETARGET_TRY_ASSIGN(const RobotSetup setup, set_up_robot(run, arguments.run.common, console));
  RETARGET_TRY(check_has_contacts(*setup.loaded.robot));
  RETARGET_TRY_ASSIGN(Plan plan, read_and_plan(run, arguments.run.request, setup, console));
  RETARGET_TRY_ASSIGN(const Motion motion, solve(std::move(plan)));
  const ContactLabels labels = contact_labels(motion);
  if (!arguments.json.empty()) {
    RETARGET_TRY(write_file(arguments.json, contacts_json(labels, motion.clip.rate())));
    if (arguments.json == "-") return {};
  }
  return write_file("-", printable(contacts_text(labels, motion.clip.rate())));
}

}  // namespace retarget::cli
