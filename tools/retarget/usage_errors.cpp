#include "usage_errors.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "help_format.h"
#include "retarget/load.h"
#include "retarget/robots.h"
#include "retarget/text.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

// The innermost command given: `retarget edit path` has its own options.
const CLI::App& given_command(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

// Returns the full name of a command, such as `retarget edit path`.
std::string call_of(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent == nullptr ? command.get_name() : call_of(*parent) + " " + command.get_name();
}

std::string options_hint(const CLI::App& command) {
  return call_of(command) + " --help lists the options";
}

// Names the help that lists an option; for an unknown name, the help with all options.
std::string options_hint(const CLI::App& command, const std::string& name) {
  const CLI::Option* option = command.get_option_no_throw(name);
  const bool hidden = option == nullptr || only_help_all_lists(command, *option);
  return call_of(command) + (hidden ? " --help-all" : " --help") + " lists the options";
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

bool is_there(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

bool is_given(const CLI::App& command, const std::string& name) {
  const CLI::Option* option = command.get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}

Need need_of(const CLI::Option& option) {
  const std::string name = option.get_name();
  if (option.get_positional()) return {name, option.get_type_name()};
  if (name == "--output") return {"output", "-o or --output " + option.get_type_name()};
  return {name, name + " " + option.get_type_name()};
}

// Commands that always need a robot; others request one if necessary.
constexpr std::array<std::string_view, 3> kOfARobot = {"batch", "convert", "evaluate"};

// Finds a word that names a robot but is not a file, such as `g1`, if the command still lacks
// --robot.
std::string robot_among(const CLI::App& command, const std::vector<std::string>& words) {
  const CLI::Option* option = command.get_option_no_throw("--robot");
  if (option == nullptr || option->count() > 0 || is_given(command, "--robot-xml")) return {};
  DataFolder chosen;
  if (is_given(command, "--data-dir")) {
    chosen.chosen = command.get_option("--data-dir")->results().front();
  }
  const auto folder = find_data_folder(chosen);
  if (!folder) return {};
  const auto is_robot = [&](const std::string& word) {
    return !is_there(word) && names_robot(word, robot_folders(*folder));
  };
  const auto found = std::ranges::find_if(words, is_robot);
  return found == words.end() ? std::string() : *found;
}

// Returns the help hint, preceded by the option that a stray robot name probably belongs to.
std::string robot_or_options_hint(const CLI::App& command, const std::vector<std::string>& words) {
  const std::string robot = robot_among(command, words);
  return (robot.empty() ? "" : "did you mean --robot " + robot + "? ") + options_hint(command);
}

// Returns the positional arguments that were given.
std::vector<std::string> words_of(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    words.insert(words.end(), option->results().begin(), option->results().end());
  }
  return words;
}

// GLB files can show human motions, which need no robot.
bool may_be_of_human(const CLI::App& command) {
  const CLI::Option* format = command.get_option_no_throw("--format");
  if (format != nullptr && format->count() > 0 && format->results().front() == "glb") return true;
  return std::ranges::any_of(std::array{"out", "--output"}, [&](const char* name) {
    const auto& given = command.get_option(name)->results();
    return !given.empty() && is_glb_name(given.front());
  });
}

std::vector<Need> needs_of(const CLI::App& command) {
  // A command that this build lacks accepts all words (quick_start/outer_commands.cpp).
  if (command.get_allow_extras()) return {};
  const std::string& name = command.get_name();
  const bool merges = is_given(command, "--merge");
  std::vector<Need> needs;
  // The positional names of `compare`, A and B, need an explanation.
  const bool compares_motions = name == "compare" && command.get_option_no_throw("b") != nullptr;
  if (compares_motions && !is_given(command, "b")) {
    if (is_given(command, "a")) return {{"second motion file", "B"}};
    return {{"motion files", "A and B, the two motion files to compare"}};
  }
  if (name == "batch" && !merges && !is_given(command, "inputs") && !is_given(command, "--list") &&
      !is_given(command, "--clips")) {
    needs.push_back({"motion files", "IN..."});
  }
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_required() && option->count() == 0) needs.push_back(need_of(*option));
  }
  const bool of_a_robot = std::ranges::find(kOfARobot, name) != kOfARobot.end() && !merges &&
                          !(name == "convert" && may_be_of_human(command));
  if (of_a_robot && !is_given(command, "--robot") && !is_given(command, "--robot-xml")) {
    needs.push_back({"robot", "--robot NAME or --robot-xml FILE"});
  }
  if (name == "convert" && !is_given(command, "out") && !is_given(command, "--output")) {
    needs.push_back({"output", "OUT or -o FILE"});
  }
  return needs;
}

}  // namespace

Result<void> check_needs(const std::vector<Need>& needs, const std::string& help) {
  if (needs.empty()) return {};
  std::string message, hint;
  for (const Need& need : needs) {
    const bool last = &need == &needs.back();
    message += (message.empty() ? "no " : last ? " and no " : ", no ") + need.what;
    hint += need.how + "; ";
  }
  const bool plural = needs.size() > 1 || needs.front().what.ends_with('s');
  return usage_failure(message + (plural ? " are given" : " is given"), "add " + hint + help);
}

std::vector<std::string> without_help_command(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

Result<void> check_command(const CLI::App& app, const std::vector<std::string>& words,
                           bool for_help) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> known = commands_of(*command);
    if (known.empty() || word.starts_with('-')) return {};
    const auto found = std::ranges::find(known, word, &CLI::App::get_name);
    if (found != known.end()) {
      command = *found;
      continue;
    }
    const std::string near = did_you_mean(word, names_of(known));
    const bool may_be_motion = command == &app && !for_help;
    if (may_be_motion && (near.empty() || is_there(word))) return {};
    std::string message = "unknown command \"";
    message.append(word).append("\"").append(near);
    return usage_failure(std::move(message), call_of(*command) + " --help lists the commands");
  }
  return {};
}

Result<void> check_given(const CLI::App& app) {
  const CLI::App& command = given_command(app);
  const std::vector<const CLI::App*> parts = commands_of(command);
  if (&command != &app && !parts.empty()) {
    const std::vector<std::string> names = names_of(parts);
    return usage_failure(
        call_of(command) + " needs one of the commands " + list_names(names, names.size()),
        call_of(command) + " --help lists them");
  }
  const std::vector<Need> needs = needs_of(command);
  if (needs.empty()) return {};
  return check_needs(needs, robot_or_options_hint(command, words_of(command)));
}

namespace {

// A positional argument that was written as an option: `--degrees 37`.
Failure positional_as_option(const CLI::App& command, const std::string& word,
                             const std::string& name) {
  std::string usage = call_of(command);
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) usage += " " + option->get_name();
  }
  return usage_failure("unknown option " + word + ": " + name + " is given without a name",
                       usage + "; " + options_hint(command));
}

}  // namespace

Failure unknown_words(const CLI::App& app) {
  const CLI::App& command = given_command(app);
  std::vector<std::string> known, positional;
  for (const CLI::Option* option : command.get_options()) {
    (option->get_positional() ? positional : known).push_back(option->get_name());
  }
  const std::vector<std::string> words = app.remaining(true);
  for (const std::string& word : words) {
    if (!word.starts_with('-')) continue;
    const std::string name = word.substr(word.starts_with("--") ? 2 : 1);
    if (std::ranges::find(positional, name) != positional.end()) {
      return positional_as_option(command, word, name);
    }
    return usage_failure("unknown option " + word + did_you_mean(word, known),
                         options_hint(command, nearest_name(word, known)));
  }
  return usage_failure(
      "unexpected " + list_names(words),
      &command == &app
          ? "a run takes one motion file and one robot; use retarget batch for several files"
          : robot_or_options_hint(command, words));
}

namespace {

// Replaces messages of the parser about numbers of values, which name its internals.
std::string plain_message(const std::string& message, const std::string& option) {
  if (message.find(": At Most 1 required") != std::string::npos) {
    return option + " is given more than once";
  }
  if (message.starts_with(option + ": 1 required") && message.ends_with("missing")) {
    return option + " needs a value";
  }
  return message;
}

}  // namespace

Failure wrong_words(const CLI::App& app, const CLI::ParseError& error) {
  const std::string message = error.what();
  // Messages begin with the name of the option.
  const std::string option = message.substr(0, message.find(':'));
  return usage_failure(plain_message(message, option), options_hint(given_command(app), option));
}

}  // namespace retarget::cli
