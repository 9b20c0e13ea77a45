#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "arguments.h"
#include "console.h"
#include "retarget/error.h"

namespace retarget::cli {

/// The commands, each with its arguments and the function to call after parsing.
class Commands {
 public:
  /// Declares a command and its options in `app`. The arguments live as long as this object.
  template <typename Arguments, typename Value>
  void add(CLI::App& app, CLI::App* (*declare)(CLI::App&, Arguments&),
           Result<Value> (*command_call)(const Arguments&, Console&)) {
    auto arguments = std::make_shared<Arguments>();
    const CLI::App* command = declare(app, *arguments);
    calls_.emplace_back(command, [arguments = std::move(arguments), command_call] {
      Console console(common_of(*arguments).quiet);
      const Result<Value> done = command_call(*arguments, console);
      if (!done) return console.fail(done.error());
      if constexpr (std::is_void_v<Value>) {
        return kDone;
      } else {
        return *done;
      }
    });
  }

  /// Calls the last command that was parsed: the default command, which comes first, always is.
  [[nodiscard]] ExitCode call() const {
    const auto parsed = std::find_if(calls_.rbegin(), calls_.rend(),
                                     [](const auto& each) { return each.first->parsed(); });
    return parsed->second();
  }

 private:
  template <typename Arguments>
  static const CommonArguments& common_of(const Arguments& arguments) {
    if constexpr (requires { arguments.common; }) {
      return arguments.common;
    } else {
      return arguments.run.common;
    }
  }

  std::vector<std::pair<const CLI::App*, std::function<ExitCode()>>> calls_;
};

}  // namespace retarget::cli
