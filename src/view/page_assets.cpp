#include "view/page_assets.h"

#include "base/base64.h"
#include "base/utf8.h"

namespace retarget {

std::string PageAsset::text() const {
  std::string whole;
  for (const std::string_view piece : pieces) whole += piece;
  return whole;
}

std::string PageAsset::policy_source() const {
  return "'sha256-" + base64_text(bytes_from_hex(sha256).value_or(std::string())) + "'";
}

}  // namespace retarget
