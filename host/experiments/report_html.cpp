#include "host/experiments/report_html.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "host/core/error.h"

namespace rosefusion {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>ROSEFusion: the paper's experiments</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; color: #1b1b1b; max-width: 1100px; margin: 2em auto; padding: 0 1em; }
img { max-width: 100%; border: 1px solid #ddd; }
table { border-collapse: collapse; margin: 0.7em 0; font-size: 0.92em; }
th, td { border: 1px solid #ccc; padding: 0.25em 0.6em; text-align: left; vertical-align: top; }
.agrees { background: #e3f1e3; } .differs { background: #f7dddd; font-weight: 600; } .open { background: #eee; }
figure { margin: 1em 0; } figcaption, small { color: #555; } details { margin: 0.4em 0; }
</style></head><body>
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<'   ? "&lt;"
           : c == '>' ? "&gt;"
           : c == '&' ? "&amp;"
           : c == '"' ? "&quot;"
                      : std::string(1, c);
  return out;
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string() + ": is missing; run the experiment again with --again.");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::size_t count(const ExperimentResult& result, Agreement agreement) {
  return static_cast<std::size_t>(std::count_if(result.verdicts.begin(), result.verdicts.end(),
                                                [&](const Verdict& v) { return v.agreement == agreement; }));
}

std::string verdictTable(const ExperimentResult& result) {
  std::string out = "<table><tr><th>What is to be seen</th><th>Here</th><th>Verdict</th></tr>\n";
  for (const Verdict& v : result.verdicts)
    out += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"{}\">{}</td></tr>\n", escaped(v.claim),
                       escaped(v.found), toString(v.agreement), toString(v.agreement));
  return out + "</table>\n";
}

std::string tableOf(const std::filesystem::path& file) {
  constexpr std::size_t kMostRows = 400;  // the rest is in the file
  std::istringstream lines(contents(file));
  std::string line, out;
  std::size_t rows = 0;
  while (std::getline(lines, line) && rows <= kMostRows) {
    const char* tag = rows++ == 0 ? "th" : "td";
    out += "<tr>";
    std::string cell;
    bool quoted = false;
    for (const char c : line + ',') {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        out += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
        cell.clear();
      } else {
        cell += c;
      }
    }
    out += "</tr>\n";
  }
  if (rows > kMostRows) out += "<tr><td>... the rest is in the file</td></tr>\n";
  return out;
}

}  // namespace

std::string summaryOf(const ExperimentResult& result) {
  const std::size_t agrees = count(result, Agreement::Agrees), differs = count(result, Agreement::Differs),
                    open = count(result, Agreement::Open);
  const char* word = differs == 0 && open == 0  ? "agrees"
                     : agrees == 0 && open == 0 ? "differs"
                                                : "agrees in part";
  return fmt::format("{} ({} of {} points{})", word, agrees, result.verdicts.size(),
                     open > 0 ? fmt::format(", {} open", open) : "");
}

std::string reportHtml(const ExperimentContext& context, const std::vector<NamedResult>& results) {
  const DeviceInfo& device = context.device.info();
  const std::string on = fmt::format("{} ({})", device.name, device.driver);
  std::string out = kHead;
  out += fmt::format(
      "<h1>The paper's experiments</h1>\n<p>ROSEFusion (Zhang et al., ACM TOG 2021), run by this program on "
      "<b>{}</b>, {} "
      "settings, seed {}. Every verdict is worked out from the numbers of the tables below it. Figures "
      "marked as quoted "
      "are the paper's own; the systems they are of were not run "
      "here.</p>\n<table><tr><th>Experiment</th><th>Paper</th>"
      "<th>Verdict</th></tr>\n",
      escaped(on), context.options.quick ? "quick" : "full", context.options.seed);
  for (const NamedResult& r : results)
    out += fmt::format("<tr><td><a href=\"#{0}\">{0}</a></td><td>{1}</td><td>{2}</td></tr>\n",
                       r.experiment->name, escaped(r.experiment->figure), escaped(summaryOf(r.result)));
  out += "</table>\n";
  for (const NamedResult& r : results) {
    const auto folder = context.options.out / r.experiment->name;
    std::string found;
    for (const Verdict& v : r.result.verdicts)
      found +=
          fmt::format("{}{}: {} ({})", found.empty() ? "" : "; ", v.claim, v.found, toString(v.agreement));
    out += fmt::format(
        "<h2 id=\"{0}\">{1} <small>{0}, {2}</small></h2>\n<p><b>Run:</b> {3} Device: {4}. <b>The paper:</b> "
        "{5} <b>Here:</b> {6}. "
        "<b>In all it {7}.</b></p>\n",
        r.experiment->name, escaped(r.experiment->title), escaped(r.experiment->figure),
        escaped(r.result.ran), escaped(on), escaped(r.result.paper), escaped(found),
        escaped(summaryOf(r.result)));
    out += verdictTable(r.result);
    for (const Figure& figure : r.result.figures)
      out += fmt::format(
          "<figure><img alt=\"{0}\" "
          "src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
          escaped(figure.caption), base64(contents(folder / figure.file)));
    for (const std::string& table : r.result.tables)
      out += fmt::format("<details><summary>{}/{}</summary><table>{}</table></details>\n", r.experiment->name,
                         table, tableOf(folder / table));
  }
  return out + "</body></html>\n";
}

}  // namespace rosefusion
