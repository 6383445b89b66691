#include "bench/readme.h"

#include <fmt/format.h>

#include "bench/advantage.h"
#include "bench/compression.h"
#include "bench/models.h"
#include "bench/motion.h"
#include "bench/paper_tables.h"
#include "bench/ray_promise.h"
#include "bench/resolution.h"
#include "bench/scale.h"
#include "bench/table_text.h"

namespace wavefog::cli {
namespace {

constexpr std::string_view kBegin = "<!-- bench ", kBeginEnd = " -->", kEnd = "<!-- /bench -->";

std::string text_of(const Facts& provenance, const char* key) {
    const Facts value = provenance.value(key, Facts());
    return value.is_string() ? value.get<std::string>()
           : value.is_null() ? "unknown"
                             : value.dump();
}

std::string quoted(const std::string& text, bool markdown) {
    return markdown ? "`" + text + "`" : text;
}

}  // namespace

std::string provenance_text(const Results& results, bool markdown) {
    const Facts& p = results.provenance;
    return fmt::format("{} at commit {}, {}, on {} ({} cores, {}), {}, OpenGL {}; times are {}.\n",
                       quoted(text_of(p, "command"), markdown),
                       quoted(text_of(p, "commit"), markdown), text_of(p, "date").substr(0, 10),
                       text_of(p, "cpu"), text_of(p, "cores"), text_of(p, "compiler"),
                       text_of(p, "gl_renderer"), text_of(p, "gl_version"), text_of(p, "clock"));
}

std::string report_text(const Results& results, bool markdown) {
    std::string text;
    if (results.preset() == "paper-tables")
        text = paper_tables_text(results.rows, markdown);
    else if (results.preset() == "compression")
        text = compression_text(results.compression, markdown) + "\n" +
               ray_promise_text(results.ray_promise, markdown);
    else if (results.preset() == "motion")
        text = motion_text(results.motion, markdown);
    else if (results.preset() == "resolution")
        text = resolution_text(results.rows, markdown);
    else if (results.preset() == "models")
        text = models_text(results.rows, markdown);
    else if (results.preset() == "scale")
        text = (markdown ? "" : scale_table_text(results.rows, markdown) + "\n") +
               scale_summary_text(results.rows, markdown);
    else if (results.preset() == "chart")
        // The README has the charts themselves.
        text = (markdown ? "" : rows_text(results.rows, markdown) + "\n") +
               advantage_text(results.rows, markdown);
    else if (!results.rows.empty())
        text = rows_text(results.rows, markdown);
    for (const Figure& figure : results.figures)
        text += fmt::format("{}: {} curves\n", figure.title, figure.curves.size());
    return text + "\n" + provenance_text(results, markdown);
}

Result<std::string> fill_readme(const std::string& text, const std::filesystem::path& folder) {
    std::string filled;
    std::size_t at = 0;
    for (;;) {
        const std::size_t begin = text.find(kBegin, at);
        if (begin == std::string::npos) return filled + text.substr(at);
        const std::size_t name = begin + kBegin.size();
        const std::size_t name_end = text.find(kBeginEnd, name);
        const std::size_t end = text.find(kEnd, name);
        if (name_end == std::string::npos || end == std::string::npos || end < name_end)
            return data_error(
                fmt::format("a '{}FILE{}' has no '{}' after it; add it", kBegin, kBeginEnd, kEnd));
        const Result<Results> results = read_results(folder / text.substr(name, name_end - name));
        if (!results) return tl::unexpected(results.error());
        filled +=
            text.substr(at, name_end + kBeginEnd.size() - at) + "\n" + report_text(*results, true);
        at = end;
    }
}

}  // namespace wavefog::cli
