#include "base/pickle_opcodes.h"

#include <array>
#include <string>
#include <utility>

#include "base/utf8.h"

namespace retarget {
namespace {

// opcodes that motions do not need: old text forms, references out of the file, sets, objects
constexpr std::array<std::pair<std::uint8_t, const char*>, 26> kRefused = {{
    {'0', "POP"},
    {'1', "POP_MARK"},
    {'2', "DUP"},
    {'F', "FLOAT"},
    {'I', "INT"},
    {'L', "LONG"},
    {'P', "PERSID"},
    {'Q', "BINPERSID"},
    {'S', "STRING"},
    {'T', "BINSTRING"},
    {'U', "SHORT_BINSTRING"},
    {'V', "UNICODE"},
    {'g', "GET"},
    {'i', "INST"},
    {'o', "OBJ"},
    {'p', "PUT"},
    {0x82, "EXT1"},
    {0x83, "EXT2"},
    {0x84, "EXT4"},
    {0x8f, "EMPTY_SET"},
    {0x90, "ADDITEMS"},
    {0x91, "FROZENSET"},
    {0x92, "NEWOBJ_EX"},
    {0x97, "NEXT_BUFFER"},
    {0x98, "READONLY_BUFFER"},
    {0x8b, "LONG4"},
}};

}  // namespace

std::string refused_opcode_name(std::uint8_t opcode) {
  for (const auto& [code, name] : kRefused) {
    if (code == opcode) return name;
  }
  return "0x" + hex_text(std::string(1, static_cast<char>(opcode)));
}

}  // namespace retarget
