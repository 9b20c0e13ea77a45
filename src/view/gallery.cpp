#include "retarget/view.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "retarget/report.h"
#include "retarget/text.h"
#include "view/page.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Rounds to three significant digits, which is enough for display.
Json short_number(double value) {
  if (!std::isfinite(value)) return Json();
  int decimals = 4;
  for (double size = std::abs(value); size >= 0.1 && decimals > 0; size /= 10.0) --decimals;
  return parse_number<double>(number_text(value, decimals)).value_or(value);
}

// Returns JSON for an HTML script element: ASCII only, and without characters that could end the
// element. Invalid UTF-8 becomes U+FFFD.
std::string script_json(const Json& json) {
  std::string text;
  for (const char letter : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (letter == '<' || letter == '>' || letter == '&') {
      text += fmt::format("\\u{:04x}", static_cast<int>(letter));
    } else {
      text += letter;
    }
  }
  return text;
}

// Returns the metrics that at least one clip has; clips refer to them by index.
std::vector<const Metric*> known_metrics(std::span<const GalleryClip> clips) {
  std::vector<const Metric*> metrics;
  for (const Metric& metric : quality_metrics()) {
    const bool known = std::ranges::any_of(clips, [&](const GalleryClip& clip) {
      return std::ranges::any_of(clip.figures,
                                 [&](const auto& figure) { return figure.first == metric.key; });
    });
    if (known) metrics.push_back(&metric);
  }
  return metrics;
}

Json clip_json(const GalleryClip& clip, const std::vector<const Metric*>& metrics) {
  Json json = {{"name", clip.name}, {"robot", clip.robot}};
  if (!clip.page.empty()) json["page"] = clip.page;
  if (!clip.picture.empty()) json["picture"] = clip.picture;
  if (clip.failed) json["failed"] = true;
  json["rank"] = opening_rank(clip);
  if (!clip.message.empty()) json["message"] = clip.message;
  if (clip.fps > 0.0 && !clip.failed) {
    json["seconds"] = short_number(std::max(0, clip.frames - 1) / clip.fps);
  }
  if (!clip.measured) return json;
  json["missed"] = clip.missed;
  Json figures = Json::array();
  for (const Metric* metric : metrics) {
    const auto figure = std::ranges::find_if(
        clip.figures, [&](const auto& each) { return each.first == metric->key; });
    figures.push_back(figure == clip.figures.end() ? Json() : short_number(figure->second));
  }
  json["figures"] = std::move(figures);
  return json;
}

}  // namespace

int opening_rank(const GalleryClip& clip) {
  if (clip.failed) return 3;
  if (!clip.measured) return 1;
  return clip.missed.empty() ? 0 : 2;
}

std::string gallery_page(const std::string& title, std::span<const GalleryClip> clips) {
  const std::vector<const Metric*> metrics = known_metrics(clips);
  Json header = {{"title", title},
                 {"thumbnail", {kThumbnailWidth, kThumbnailHeight}},
                 {"metrics", Json::array()},
                 {"clips", Json::array()}};
  for (const Metric* metric : metrics) {
    header["metrics"].push_back({{"key", metric->key},
                                 {"label", metric_label(metric->key)},
                                 {"unit", metric->unit},
                                 {"definition", metric->definition}});
  }
  for (const GalleryClip& clip : clips) header["clips"].push_back(clip_json(clip, metrics));
  // Pictures are separate files next to the page, on disk or on a server.
  const std::string policy = fmt::format(
      "default-src 'none'; img-src 'self'; script-src {}; style-src {}; base-uri 'none'; "
      "form-action 'none'",
      kGalleryScript.policy_source(), kGalleryStyle.policy_source());
  const std::array<std::pair<std::string_view, std::string>, 5> parts = {
      {{"@POLICY@", policy},
       {"@TITLE@", xml_text(title)},
       {"@STYLE@", kGalleryStyle.text()},
       {"@HEADER@", script_json(header)},
       {"@SCRIPT@", kGalleryScript.text()}}};
  return fill_shell(kGalleryShell, parts);
}

std::string gallery_note_page(const std::string& title, const std::string& message,
                              const PageLinks& links) {
  std::string ways;
  const std::array<std::pair<const std::string*, std::string_view>, 3> all = {
      {{&links.index, "All clips"}, {&links.previous, "Previous"}, {&links.next, "Next"}}};
  for (const auto& [address, text] : all) {
    if (address->empty()) continue;
    ways += fmt::format("<a href=\"{}\">{}</a> ", xml_text(*address), text);
  }
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src {}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main class=\"note\">\n<h1>{}</h1>\n"
      "<p>{}</p>\n<p>{}</p>\n</main>\n</body>\n</html>\n",
      kGalleryStyle.policy_source(), xml_text(title), kGalleryStyle.text(), xml_text(title),
      xml_text(message), ways);
}

}  // namespace retarget
