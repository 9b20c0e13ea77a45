// Any bytes as a record of a run: a manifest line, a sidecar.

#include <string_view>

#include "app/run/sidecar.h"
#include "batch/manifest.h"
#include "fuzz/fuzz_target.h"
#include "retarget/file.h"

namespace retarget::fuzz {

void fuzz_manifest(std::string_view bytes) {
  const auto entry = parse_manifest_line(bytes);
  if (!entry) return;
  require(parse_manifest_line(manifest_line(*entry)).has_value(), "a written line is readable");
}

void fuzz_sidecar(std::string_view bytes) {
  const auto sidecar = read_sidecar(bytes, "fuzz.csv.json");
  if (!good(sidecar)) return;
  require(is_plain_name(sidecar->output), "outputs lie beside their sidecar");
}

}  // namespace retarget::fuzz
