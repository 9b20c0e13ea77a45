#include "view/page_assets.h"

#include "base/utf8.h"
#include "formats/containers/base64.h"

namespace retarget {

std::string PageAsset::text() const {
  std::string whole;
  for (const std::string_view piece : pieces) whole += piece;
  return whole;
}

std::string PageAsset::policy_source() const {
  return "'sha256-" + base64_text(bytes_from_hex(sha256).value_or(std::string())) + "'";
}

std::string fill_shell(const PageAsset& shell,
                       std::span<const std::pair<std::string_view, std::string>> parts) {
  const std::string whole = shell.text();
  std::string page;
  std::size_t begin = 0;
  for (const auto& [mark, text] : parts) {
    const std::size_t at = whole.find(mark, begin);
    if (at == std::string::npos) continue;
    page.append(whole, begin, at - begin).append(text);
    begin = at + mark.size();
  }
  return page.append(whole, begin, std::string::npos);
}

}  // namespace retarget
