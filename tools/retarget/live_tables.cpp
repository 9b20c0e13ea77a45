// Option table of `retarget live`.

#include "argument_tables.h"
#include "declare_table.h"
#include "retarget/option_table.h"
#include "retarget/serve_table.h"

namespace retarget::cli {

OptionTable live_command_table(LiveArguments& arguments) {
  OptionTable table = serve_table(arguments.request);
  table.push_back(option("play", arguments.play, "Player", "FILE",
                         "Only send this motion to --to, as the capture system would",
                         {.basic = true}));
  append(table, player_table(arguments.player));
  table.push_back(option("list", arguments.list, kInputGroup, "",
                         "List the input and output formats and exit", {.basic = true}));
  append(table, common_table(arguments.common));
  return table;
}

}  // namespace retarget::cli
