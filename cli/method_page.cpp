#include "method_page.h"

#include <chiaro/sheet.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include "method_report.h"

namespace chiaro::cli {
namespace {

constexpr const char* style = R"(
body { margin: 2em auto; max-width: 76em; padding: 0 1em; background: #181818; color: #ddd;
       font: 15px/1.5 system-ui, sans-serif }
h1 { font-size: 1.3em; font-weight: 600 }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums }
th, td { padding: .25em 1em .25em 0; text-align: right; border-bottom: 1px solid #333 }
th:first-child, td:first-child { text-align: left }
section { display: flex; flex-wrap: wrap; gap: 1em; margin: 1.5em 0 }
figure { margin: 0; flex: 1 1 20em; max-width: 37em }
figure div { position: relative }
img { width: 100%; display: block }
.truth { position: absolute; inset: 0; background: var(--truth) 0 0 / 100% 100%; opacity: 0 }
div:hover > .truth { opacity: 1 }
figcaption { color: #aaa }
.scale { height: 1em; max-width: 24em; background: linear-gradient(to right, #053094, #fff, #b30312) }
.ends { display: flex; justify-content: space-between; max-width: 24em; color: #aaa }
)";

/// RFC 4648, section 4.
std::string base64(const std::vector<std::byte>& bytes) {
    constexpr const char* signs = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? signs[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string embedded(const Image& image) { return "data:image/png;base64," + base64(encode_png(image)); }

std::string escaped(const std::string& text) {
    std::string html;
    for (char c : text) html += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
    return html;
}

std::string figure(const std::string& what, const std::string& caption, const std::string& image, int truth = -1) {
    return fmt::format(
        "<figure><div><img alt=\"{}\" src=\"{}\">{}</div><figcaption>{}</figcaption></figure>\n", what, image,
        truth < 0 ? "" : fmt::format("<div class=\"truth\" style=\"--truth: var(--truth{})\"></div>", truth), caption);
}

std::string table_html(const MethodComparison& comparison) {
    std::string html = "<table>\n<tr>";
    for (const char* heading : headings) html += fmt::format("<th>{}</th>", heading);
    for (const MethodImage& image : comparison.images) {
        html += "</tr>\n<tr>";
        for (const std::string& cell : cells_of(image)) html += fmt::format("<td>{}</td>", cell);
    }
    return html + "</tr>\n</table>\n";
}

std::string legend(double full) {
    return fmt::format(
        "<div class=\"scale\"></div>\n<div class=\"ends\"><span>-{0:g} darker</span><span>as the reference</span>"
        "<span>+{0:g} brighter</span></div>\n",
        full);
}

}  // namespace

std::string page_of(const MethodComparison& comparison, const std::string& title, const std::string& told) {
    std::vector<std::string> references;
    std::string truths;  // a colour of the style sheet for each
    for (const MethodReference& r : comparison.references) {
        references.push_back(embedded(develop(r.image.frame, {})));
        truths += fmt::format("--truth{}: url({}); ", references.size() - 1, references.back());
    }
    const double full = full_difference(comparison);
    std::string html = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}</title>\n<style>{1}:root {{ "
        "{2}}}\n</style></head>\n<body>\n<h1>{0}</h1>\n<p>{3}</p>\n",
        escaped(title), style, truths, escaped(told));
    html += table_html(comparison);
    html += "<p>" + fmt::format("{}", fmt::join(reference_sentences(comparison), "; ")) +
            ". Differences of luminance, in linear light:</p>\n" + legend(full);
    for (const MethodImage& image : comparison.images) {
        const std::string name(to_text(image.method));
        html += "<section>\n" +
                figure(name, name + "; under the pointer the reference", embedded(develop(image.frame, {})),
                       int(image.reference)) +
                figure("difference of " + name, "where " + name + " is brighter or darker",
                       embedded(difference_image(image.frame, truth_of(comparison, image), full))) +
                "</section>\n";
    }
    html += "<section>\n";
    for (std::size_t i = 0; i < references.size(); ++i)
        html += figure("reference", "reference, light " + comparison.references[i].light, references[i]);
    return html + "</section>\n</body>\n</html>\n";
}

}  // namespace chiaro::cli
