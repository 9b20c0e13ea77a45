# Runs at every build. Writes OUTPUT only if it changes, so that nothing is compiled needlessly.

set(GIT_COMMIT "")
find_program(GIT git)
if(GIT AND EXISTS ${SOURCE}/.git)
  # Do not lock the index: a build must not block the developer's git commands.
  set(ENV{GIT_OPTIONAL_LOCKS} 0)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE GIT_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#pragma once

inline constexpr char kToolVersion[] = "@VERSION@";
inline constexpr char kGitCommit[] = "@GIT_COMMIT@";  // empty when not built from a git checkout
]])
