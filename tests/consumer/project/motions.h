#pragma once

#include <string>

/// Where the robots of the library are that this project links; empty: not found.
std::string folder_of_robots();
