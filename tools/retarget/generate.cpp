#include "generate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include "declare_table.h"
#include "retarget/enum_names.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/model_pack.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/robots.h"
#include "retarget/try.h"
#include "retarget/version.h"

namespace retarget::cli {
namespace {

// An option as described in scripts and pages.
struct Told {
  std::string name, letter, type, group, help, standard;
  std::vector<std::string> words;  // Allowed values.
  bool takes_value = false, is_path = false, is_robot = false;
};

struct Command {
  std::string path;  // `edit path`; empty: the default command.
  std::string help, arguments;
  std::vector<Told> options;
  std::vector<std::string> commands;  // Its subcommands.
  std::vector<std::string> words;     // Further words that may follow.
  bool takes_robot = false;           // A robot may follow.
};

std::vector<std::string> split(const std::string& text) {
  return CLI::detail::split(text, '|');
}

std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

// Lower-case types are literal values; `FILE` and `N` are placeholders.
std::vector<std::string> literals_of(const std::string& type) {
  std::vector<std::string> words = split(type);
  std::erase_if(words, [](const std::string& word) { return word == upper_case(word); });
  return words;
}

Told tell(const CLI::Option& option) {
  Told told;
  if (!option.get_lnames().empty()) told.name = option.get_lnames().front();
  if (!option.get_snames().empty()) told.letter = option.get_snames().front();
  told.takes_value = option.get_expected_max() > 0;
  told.type = told.takes_value ? option.get_type_name() : "";
  told.group = option.get_group();
  told.help = option.get_description();
  std::ranges::replace(told.help, '\n', ' ');
  told.standard = option.get_default_str();
  told.words = literals_of(told.type);
  if (told.type.starts_with("FORMAT")) {
    for (const auto& [format, name] : kEnumNames<MotionFormat>) told.words.emplace_back(name);
  }
  told.is_robot = told.type.starts_with("NAME") && told.name.ends_with("robot");
  told.is_path =
      told.type.find("FILE") != std::string::npos || told.type == "DIR" || told.name == "robot";
  return told;
}

void collect(const CLI::App& app, const std::string& path, std::vector<Command>& commands) {
  Command command;
  command.path = path;
  command.help = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) {
      command.arguments += " " + option->get_type_name();
      const std::vector<std::string> words = literals_of(option->get_type_name());
      command.words.insert(command.words.end(), words.begin(), words.end());
      command.takes_robot |= option->get_type_name().find("ROBOT") != std::string::npos;
    }
    if (option->nonpositional() && !option->get_group().empty()) {
      command.options.push_back(tell(*option));
    }
  }
  const auto below = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* each : below) command.commands.push_back(each->get_name());
  if (path == "help") command.words = commands.front().commands;
  commands.push_back(std::move(command));
  for (const CLI::App* each : below) {
    collect(*each, path.empty() ? each->get_name() : path + " " + each->get_name(), commands);
  }
}

std::string joined(const std::vector<std::string>& words, const char* between = " ") {
  return fmt::format("{}", fmt::join(words, between));
}

// Replaces single characters by text.
std::string replaced(const std::string& text,
                     std::initializer_list<std::pair<char, const char*>> words) {
  std::string safe;
  for (const char letter : text) {
    const auto* word = std::ranges::find(words, letter, &std::pair<char, const char*>::first);
    word == words.end() ? safe += letter : safe += word->second;
  }
  return safe;
}

// One word of bash or zsh.
std::string quoted(const std::string& text) {
  return "'" + replaced(text, {{'\'', "'\\''"}}) + "'";
}

// Prints the names of all robots. It runs the command that is completed.
std::string robot_names(const char* program) {
  return fmt::format("$({} robots list 2>/dev/null | cut -d ' ' -f 1)", program);
}

// The command that completes with files, words and names of robots.
std::string bash_reply(bool files, const std::vector<std::string>& words, bool robots) {
  std::string text = quoted(joined(words));
  if (robots) text += "\" " + robot_names("\"$1\"") + "\"";
  return fmt::format("_retarget_reply{} -W {}", files ? " -f" : "", text);
}

std::string bash_script(const std::vector<Command>& commands) {
  // Each line is one reply: names of files contain spaces. If nothing matches a name with quotes or
  // backslashes, the shell completes files itself.
  std::string text =
      "# bash completion for retarget\n_retarget_reply() {\n"
      "  local line\n  COMPREPLY=()\n  while IFS= read -r line; do COMPREPLY+=(\"$line\"); done"
      " < <(compgen \"$@\" -- \"$cur\")\n"
      "  [[ $1 == -f ]] || compopt +o default 2>/dev/null\n}\n_retarget() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} path= word\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n    case \"$path $word\" in\n";
  for (const Command& command : commands) {
    for (const std::string& below : command.commands) {
      const std::string path = command.path.empty() ? below : command.path + " " + below;
      text += fmt::format("      '{} {}') path='{}' ;;\n", command.path, below, path);
    }
  }
  text += "    esac\n  done\n  case \"$path:$prev\" in\n";
  for (const Command& command : commands) {
    for (const Told& option : command.options) {
      if (!option.takes_value) continue;
      text += fmt::format("    '{}:--{}') {}; return ;;\n", command.path, option.name,
                          bash_reply(option.is_path, option.words, option.is_robot));
    }
  }
  text += "  esac\n  case \"$path\" in\n";
  for (const Command& command : commands) {
    std::vector<std::string> names;
    for (const Told& option : command.options) names.push_back("--" + option.name);
    std::vector<std::string> words = command.commands;
    words.insert(words.end(), command.words.begin(), command.words.end());
    text +=
        fmt::format("    '{}') if [[ $cur == -* ]]; then {}\n      else {}; fi ;;\n", command.path,
                    bash_reply(false, names, false), bash_reply(true, words, command.takes_robot));
  }
  return text + "  esac\n}\ncomplete -o filenames -o default -F _retarget retarget\n";
}

// The action for an argument that takes files, words or robots.
std::string zsh_action(bool files, const std::vector<std::string>& words, bool robots) {
  if (!files && !robots) return words.empty() ? "" : "(" + joined(words) + ")";
  std::vector<std::string> steps;
  if (files) steps.emplace_back("_files");
  if (!words.empty()) steps.push_back("compadd -- " + joined(words));
  if (robots) steps.push_back("compadd -- " + robot_names("retarget"));
  return "{" + joined(steps, "; ") + "}";
}

std::string zsh_script(const std::vector<Command>& commands) {
  std::string text =
      "#compdef retarget\n_retarget() {\n  local at= word\n"
      "  for word in ${words[2,CURRENT-1]}; do\n    case \"$at $word\" in\n";
  for (const Command& command : commands) {
    for (const std::string& below : command.commands) {
      const std::string path = command.path.empty() ? below : command.path + " " + below;
      text += fmt::format("      '{} {}') at='{}' ;;\n", command.path, below, path);
    }
  }
  const auto safe = [](const std::string& description) {
    return replaced(description, {{'\\', "\\\\"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}});
  };
  text += "    esac\n  done\n  case \"$at\" in\n";
  for (const Command& command : commands) {
    text += fmt::format("    '{}') _arguments", command.path);
    for (const Told& option : command.options) {
      std::string value;
      if (option.takes_value) {
        value = ":" + safe(option.type) + ":" +
                zsh_action(option.is_path, option.words, option.is_robot);
      }
      text +=
          " \\\n      " + quoted(fmt::format("--{}[{}]{}", option.name, safe(option.help), value));
    }
    std::vector<std::string> words = command.commands;
    words.insert(words.end(), command.words.begin(), command.words.end());
    text += " \\\n      " + quoted("*:argument:" + zsh_action(true, words, command.takes_robot)) +
            " ;;\n";
  }
  return text + "  esac\n}\n_retarget \"$@\"\n";
}

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(text, {{'\\', "\\\\"}, {'\'', "\\'"}}) + "'";
}

std::string fish_words(const std::vector<std::string>& words, bool robots) {
  std::string text = joined(words);
  // Substitutions of fish have no dollar sign.
  if (robots) text += (text.empty() ? "" : " ") + robot_names("retarget").substr(1);
  return text.empty() ? "" : " -a " + fish_quoted(text);
}

std::string fish_script(const std::vector<Command>& commands) {
  std::string text = "# fish completion for retarget\n";
  const std::string of_all = joined(commands.front().commands);
  for (const Command& command : commands) {
    std::string when = "not __fish_seen_subcommand_from " + of_all;
    if (!command.path.empty()) {
      when.clear();
      for (const std::string& word : split([&] {
             std::string path = command.path;
             std::ranges::replace(path, ' ', '|');
             return path;
           }())) {
        when += (when.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
      }
    }
    for (const Told& option : command.options) {
      text +=
          fmt::format("complete -c retarget -n '{}' -l {}{} -d {}{}{}\n", when, option.name,
                      option.letter.empty() ? "" : " -s " + option.letter, fish_quoted(option.help),
                      !option.takes_value ? ""
                      : option.is_path    ? " -r"
                                          : " -x",
                      fish_words(option.words, option.is_robot));
    }
    std::vector<std::string> words = command.commands;
    words.insert(words.end(), command.words.begin(), command.words.end());
    const std::string arguments = fish_words(words, command.takes_robot);
    if (!arguments.empty())
      text += fmt::format("complete -c retarget -n '{}'{}\n", when, arguments);
  }
  return text;
}

std::string troff(const std::string& text) {
  std::string safe = replaced(text, {{'\\', "\\e"}, {'-', "\\-"}});
  if (safe.starts_with('.') || safe.starts_with('\'')) safe = "\\&" + safe;
  return safe;
}

std::string man_page(const std::vector<Command>& commands) {
  std::string text = fmt::format(".TH RETARGET 1 \"\" \"retarget {}\"\n.SH NAME\nretarget \\- {}\n",
                                 version_number(), troff(commands.front().help));
  for (const Command& command : commands) {
    const std::string call = "retarget" + (command.path.empty() ? "" : " " + command.path);
    text += fmt::format(".SH {}\n.B {}{}\n[options]\n.PP\n{}\n", troff(upper_case(call)), call,
                        troff(command.arguments), troff(command.help));
    for (const Told& option : command.options) {
      text += fmt::format(".TP\n.B {}\\-\\-{} {}\n{}\n",
                          option.letter.empty() ? "" : "\\-" + option.letter + ", ",
                          troff(option.name), troff(option.type), troff(option.help));
    }
  }
  return text +
         ".SH EXIT STATUS\n0 done, 1 the run failed, 2 wrong usage, 3 bad input file, 4 bad "
         "configuration, model or unknown robot, 130 interrupted\n"
         ".SH ENVIRONMENT\nRETARGET_DATA_DIR: the folder that holds robots/ and configs/\n";
}

std::string cell(const std::string& text) {
  return replaced(text, {{'|', "\\|"}});
}

std::string options_page(const std::vector<Command>& commands) {
  std::string text =
      "# Options\n\nGenerated by `retarget generate options` from the option tables; do not edit.\n"
      "The same names, with `_` for `-`, are members of `retarget::Options` and keys of "
      "sidecars. Options without a value are flags: `--mirror` or `--mirror=true`, and "
      "`--mirror=false` for the default.\n";
  for (const Command& command : commands) {
    if (command.options.size() <= 2) continue;
    text += fmt::format("\n## retarget{}{}\n\n{}\n", command.path.empty() ? "" : " ", command.path,
                        command.help);
    std::string group;
    for (const Told& option : command.options) {
      if (option.group != group) {
        group = option.group;
        text += fmt::format("\n{}:\n\n| option | value | default | |\n|---|---|---|---|\n", group);
      }
      text += fmt::format("| `--{}`{} | {} | {} | {} |\n", option.name,
                          option.letter.empty() ? "" : ", `-" + option.letter + "`",
                          cell(option.type), cell(option.standard), cell(option.help));
    }
  }
  text += "\n## The fit\n\nMembers of the JSON file of `--fit-config` (docs/fit.md).\n";
  FitOptions fit;
  std::string group;
  for (const Option& row : fit_table(fit)) {
    if (row.info.group != group) {
      group = row.info.group;
      text += fmt::format("\n{}:\n\n| option | default | |\n|---|---|---|\n", group);
    }
    text += fmt::format("| `{}` | {} | {} |\n", row.name, to_text(row.get()), row.info.help);
  }
  return text;
}

}  // namespace

namespace {

Result<std::string> robot_pack(const std::string& robot) {
  if (robot.empty()) {
    return usage_failure("a robot pack needs a robot", "retarget generate robot-pack unitree_g1");
  }
  RETARGET_TRY_ASSIGN(const std::string data_folder, find_data_folder(DataFolder{}));
  RETARGET_TRY_ASSIGN(const RobotFiles files, find_robot(robot, robot_folders(data_folder)));
  return make_model_pack(files);
}

}  // namespace

CLI::App* add_generate_command(CLI::App& app, Generated& generated) {
  CLI::App* command =
      app.add_subcommand("generate", "Print completions, man page, options page or robot pack");
  Option row = word("kind", generated.what, "", "Kind of output");
  row.choices = {"bash", "zsh", "fish", "man", "options", "robot-pack"};
  const Option robot =
      word("robot", generated.robot, "ROBOT", "Robot of a pack (docs/browser.md)", false);
  declare(*command, {row, robot});
  return command;
}

ExitCode print_generated(const CLI::App& app, const Generated& generated) {
  const std::string& what = generated.what;
  if (what == "robot-pack") {
    Console console(false);
    const auto pack = robot_pack(generated.robot);
    if (!pack) return console.fail(pack.error());
    const auto written = write_file("-", *pack);
    return written ? kDone : console.fail(written.error());
  }
  std::vector<Command> commands;
  collect(app, "", commands);
  const std::string text = what == "bash"   ? bash_script(commands)
                           : what == "zsh"  ? zsh_script(commands)
                           : what == "fish" ? fish_script(commands)
                           : what == "man"  ? man_page(commands)
                                            : options_page(commands);
  Console console(false);
  const auto written = write_file("-", text);
  return written ? kDone : console.fail(written.error());
}

}  // namespace retarget::cli
