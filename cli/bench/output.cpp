#include "bench/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "bench/gnuplot.h"
#include "files.h"
#include "interrupt.h"

namespace wavefog::cli {

namespace fs = std::filesystem;

Result<void> check_output_directory(const fs::path& folder) {
    std::error_code code;
    if (!fs::exists(folder, code)) {
        if (fs::create_directory(folder, code)) return {};
        return data_error(fmt::format("{}: the folder cannot be made ({}); make its parent first",
                                      folder.string(), code.message()));
    }
    if (!fs::is_directory(folder, code))
        return data_error(
            fmt::format("{}: this is a file; name a folder for the results", folder.string()));
    if (access(folder.c_str(), W_OK) != 0)
        return data_error(fmt::format(
            "{}: the folder cannot be written to ({}); choose another or change its permissions",
            folder.string(), std::strerror(errno)));
    return {};
}

std::string read_text(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Result<void> write_text(const fs::path& file, const std::string& text) {
    const HoldInterrupts hold;
    Result<TextOutput> output = TextOutput::create(file);
    if (!output) return tl::unexpected(output.error());
    output->stream() << text;
    return output->commit();
}

Result<void> write_results(const Results& results, const std::vector<Figure>& figures,
                           const fs::path& folder) {
    if (auto ok = write_text(folder / "results.json", to_json(results).dump(1) + "\n"); !ok)
        return ok;
    if (!results.rows.empty())
        if (auto ok = write_text(folder / "results.csv", rows_csv(results.rows)); !ok) return ok;
    if (figures.empty()) return {};
    if (auto ok = write_text(folder / "figures.csv", figures_csv(figures)); !ok) return ok;
    if (!has_gnuplot()) {
        warn(
            fmt::format("{}: no charts, gnuplot is not there; install it (apt install "
                        "gnuplot-nox) and run `wavefog bench --from {} -o {}`",
                        folder.string(), (folder / "results.json").string(), folder.string()));
        return {};
    }
    for (const Figure& figure : figures)
        if (auto ok = draw_figure(figure, folder); !ok) return ok;
    return {};
}

}  // namespace wavefog::cli
