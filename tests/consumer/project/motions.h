#pragma once

#include <string>

/// The robots folder of the linked library; empty: not found.
std::string folder_of_robots();
