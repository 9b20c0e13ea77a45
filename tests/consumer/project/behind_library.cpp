// A program that uses retarget only through another library.

#include <filesystem>
#include <iostream>

#include "motions.h"

int main(int argc, char** argv) {
  const std::string found = folder_of_robots();
  std::error_code unknown;
  if (argc == 2 && std::filesystem::equivalent(found, argv[1], unknown)) return 0;
  std::cerr << "robots in \"" << found << "\", expected " << (argc == 2 ? argv[1] : "one argument")
            << "\n";
  return 1;
}
