#pragma once

/// An option within the text of an error, a warning or a note, by its name in the schema of options:
/// `"give the rate with " OPTION("source-fps")`. The text has a mark there; whoever shows it writes the
/// option as its users know it (spell_options): `--source-fps`, `source_fps`.
// a macro, for texts are put together from literals before the program runs
#define OPTION(name) "\x0e" name "\x0f"
