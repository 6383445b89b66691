#include "bench/gnuplot.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "bench/output.h"
#include "interrupt.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct Look {
    const char* key;
    const char* colour;  // Okabe and Ito's palette, told apart by the colour-blind
    int marker;          // gnuplot's point type
    int dash;
};

// One look for a method, a codec and a family in all charts. Unstable families are dashed and warm.
constexpr Look kLooks[] = {{"exact", "#0072B2", 7, 1},
                           {"radial", "#56B4E9", 15, 1},
                           {"paper", "#D55E00", 5, 1},
                           {"paper-scaling", "#E69F00", 9, 1},
                           {"march", "#009E73", 13, 1},
                           {"march on a fine map", "#009E73", 4, 2},
                           {"march on a finer map", "#009E73", 8, 4},
                           {"froxel", "#CC79A7", 11, 1},
                           {"homogeneous", "#000000", 2, 1},
                           {"reference", "#56B4E9", 3, 1},
                           {"five times", "#BBBBBB", 1, 1},
                           {"formulas", "#D55E00", 7, 1},
                           {"aware", "#0072B2", 7, 1},
                           {"average", "#D55E00", 5, 1},
                           {"vertices", "#009E73", 13, 1},
                           {"wavefog", "#0072B2", 7, 1},
                           {"wavefog --best", "#D55E00", 5, 1},
                           {"JPEG XL e9", "#009E73", 9, 1},
                           {"JPEG XL e7", "#56B4E9", 11, 1},
                           {"JPEG-LS", "#CC79A7", 13, 1},
                           {"JPEG 2000 5/3", "#E69F00", 15, 1},
                           {"PNG", "#000000", 4, 1},
                           {"zstd -19", "#595959", 6, 1},
                           {"zfp", "#8C564B", 8, 1},
                           {"1,1", "#000000", 7, 1},
                           {"2,2", "#0072B2", 5, 1},
                           {"3,3", "#009E73", 9, 1},
                           {"3,5", "#56B4E9", 11, 1},
                           {"4,6", "#CC79A7", 13, 1},
                           {"positive", "#CC79A7", 15, 1},
                           {"2,0", "#E69F00", 4, 2},
                           {"3,1", "#D55E00", 8, 2},
                           {"4,4", "#E69F00", 10, 4},
                           {"4,2", "#D55E00", 12, 4}};
constexpr Look kOtherLook = {"", "#7F7F7F", 6, 1};
constexpr const char* kGrey = "#595959";
constexpr double kWidth = 1200, kHeight = 800;  // pixels
// Edges of the plot, as shares of the picture.
constexpr double kLeft = 0.11, kRight = 0.86, kBottom = 0.24, kTop = 0.86, kTopWithAxis = 0.80;

const Look& look_of(const std::string& key) {
    for (const Look& look : kLooks)
        if (key == look.key) return look;
    return kOtherLook;
}

/// A gnuplot string without meaning for its enhanced text: neither subscripts nor escapes.
std::string plain(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\n')
            result += "\\n";
        else if (c == '"')
            result += "\\\"";
        else if (std::string_view("_^{}@&~\\").find(c) != std::string_view::npos)
            result += std::string("\\\\") + c;
        else
            result += c;
    }
    return result;
}

std::string quoted(const std::string& text) {
    return '"' + plain(text) + '"';
}

std::string shell_quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

bool drawable(double value, const Axis& axis) {
    return std::isfinite(value) && (!axis.log || value > 0);
}

struct Range {
    double low = 0, high = 1;
};

/// The axis's own range, or the data's with a margin.
Range range_of(const Axis& axis, std::vector<double> values) {
    if (axis.low < axis.high) return {axis.low, axis.high};
    std::erase_if(values, [&](double v) { return !drawable(v, axis); });
    if (values.empty()) return axis.log ? Range{0.1, 10} : Range{0, 1};
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (axis.log) {
        const double margin = std::max(std::pow(*high / *low, 0.06), 1.2);
        return {*low / margin, *high * margin};
    }
    const double margin = std::max((*high - *low) * 0.05, 1e-12);
    return {*low - margin, *high + margin};
}

/// Where a note's text goes: beside its point, off the others.
class NotePlacer {
  public:
    NotePlacer(const Figure& figure, const Range& x, const Range& y)
        : figure_(figure), x_(x), y_(y) {
        for (const Curve& curve : figure.curves) {
            const Pixel* before = nullptr;
            Pixel last{};
            for (const auto& [px, py] : curve.points) {
                if (!drawable(px, figure.x) || !drawable(py, figure.y)) continue;
                const Pixel at = pixel(px, py);
                taken_.push_back(around(at, 9, 9));
                if (before != nullptr && curve.style != Curve::Style::points) cover(last, at);
                last = at;
                before = &last;
            }
        }
    }

    /// Gnuplot's words for the place.
    std::string place(const Note& note) {
        const Pixel at = pixel(note.x, note.y);
        const auto letters = std::count_if(note.text.begin(), note.text.end(),
                                           [](char c) { return (c & 0xC0) != 0x80; });
        const double width = 11.0 * double(letters), height = 20;
        Box best;
        bool best_left = true;
        double least = 1e300;
        for (const double dy : {22.0, -22.0, 0.0, 44.0, -44.0, 66.0})
            for (const bool left_aligned : {true, false}) {
                const double middle = at.x + (left_aligned ? 1 : -1) * (width / 2 + 16);
                const Box box = around({middle, at.y + dy}, width / 2, height / 2);
                const double badness = covered(box) + 0.1 * std::abs(dy) + (left_aligned ? 0 : 1);
                if (badness >= least) continue;
                least = badness;
                best = box;
                best_left = left_aligned;
            }
        taken_.push_back(best);
        return fmt::format("at screen {:.4f},{:.4f} {}",
                           (best_left ? best.left : best.right) / kWidth,
                           (best.bottom + best.top) / 2 / kHeight, best_left ? "left" : "right");
    }

  private:
    struct Pixel {
        double x, y;
    };
    struct Box {
        double left = 0, right = 0, bottom = 0, top = 0;
    };

    /// A line, as a chain of small boxes.
    void cover(const Pixel& from, const Pixel& to) {
        const int steps = int(std::hypot(to.x - from.x, to.y - from.y) / 8);
        for (int i = 1; i < steps; ++i) {
            const double t = double(i) / steps;
            taken_.push_back(
                around({std::lerp(from.x, to.x, t), std::lerp(from.y, to.y, t)}, 4, 4));
        }
    }

    static Box around(const Pixel& p, double half_width, double half_height) {
        return {p.x - half_width, p.x + half_width, p.y - half_height, p.y + half_height};
    }

    static double share(double value, const Axis& axis, const Range& range) {
        return axis.log ? std::log(value / range.low) / std::log(range.high / range.low)
                        : (value - range.low) / (range.high - range.low);
    }

    Pixel pixel(double px, double py) const {
        const double top = figure_.top_label.empty() ? kTop : kTopWithAxis;
        return {kWidth * (kLeft + (kRight - kLeft) * share(px, figure_.x, x_)),
                kHeight * (kBottom + (top - kBottom) * share(py, figure_.y, y_))};
    }

    /// Pixels of overlap with what is there, and of sticking out of the picture.
    double covered(const Box& box) const {
        double area = 0;
        for (const Box& other : taken_) {
            const double w = std::min(box.right, other.right) - std::max(box.left, other.left);
            const double h = std::min(box.top, other.top) - std::max(box.bottom, other.bottom);
            if (w > 0 && h > 0) area += w * h;
        }
        const double top = figure_.top_label.empty() ? kTop : kTopWithAxis;
        const double out = std::max({kWidth * kLeft - box.left, box.right - kWidth * 0.99,
                                     kHeight * kBottom - box.bottom, box.top - kHeight * top, 0.0});
        return area + 100 * out;
    }

    const Figure& figure_;
    Range x_, y_;
    std::vector<Box> taken_;
};

/// Plain numbers where they stay short, powers of ten elsewhere.
std::string axis_commands(const Axis& axis, const char* name, const Range& range) {
    std::string text = fmt::format("set {}label {}\nset {}range [{:g}:{:g}]\n", name,
                                   quoted(axis.label), name, range.low, range.high);
    if (axis.step > 0) text += fmt::format("set {}tics {:g}\n", name, axis.step);
    if (axis.log) {
        const bool powers = range.low < 1e-3 || range.high > 3e4;
        text += fmt::format("set logscale {}\nset format {} {}\n", name, name,
                            powers ? "'10^{%T}'" : "'%g'");
        // Within one or two decades powers of ten alone leave an axis without numbers.
        if (!powers && range.high / range.low < 30)
            text +=
                fmt::format("set {}tics add (0.1,0.2,0.5,1,2,5,10,20,50,100,200,500,1000)\n", name);
    }
    return text;
}

std::string plot_clause(const Curve& curve, std::size_t index) {
    const Look& look = look_of(curve.key);
    const std::string title = curve.name.empty() ? "notitle" : "title " + quoted(curve.name);
    switch (curve.style) {
        case Curve::Style::points:
            return fmt::format("$d{} with points pt {} ps 0.8 lw 1.5 lc rgb '{}' {}", index,
                               look.marker, look.colour, title);
        case Curve::Style::dashed:
            return fmt::format("$d{} with linespoints pt {} ps 1.3 lw 2.5 dt 2 lc rgb '{}' {}",
                               index, look.marker, look.colour, title);
        case Curve::Style::plain:
            return fmt::format("$d{} with lines lw 3 lc rgb '{}' {}", index, look.colour, title);
        case Curve::Style::line:
            break;
    }
    return fmt::format("$d{} with linespoints pt {} ps 1.6 lw 3 dt {} lc rgb '{}' {}", index,
                       look.marker, look.dash, look.colour, title);
}

/// What gnuplot said, and how it ended.
Result<void> run_gnuplot(const fs::path& program) {
    const std::string command = "gnuplot " + shell_quoted(program.string()) + " 2>&1";
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return data_error("gnuplot cannot be started; is there memory left?");
    std::string said;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) said += char(c);
    const int status = pclose(pipe);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
    return data_error("gnuplot failed: " + said);
}

}  // namespace

bool has_gnuplot() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((fs::path(folder) / "gnuplot").c_str(), X_OK) == 0) return true;
    return false;
}

std::string gnuplot_program(const Figure& figure, const std::string& terminal,
                            const std::string& output) {
    std::vector<double> xs, ys;
    for (const Curve& curve : figure.curves)
        for (const auto& [x, y] : curve.points) {
            if (!drawable(x, figure.x) || !drawable(y, figure.y)) continue;
            xs.push_back(x);
            ys.push_back(y);
        }
    for (const Level& level : figure.levels) ys.push_back(level.y);
    const Range x = range_of(figure.x, xs), y = range_of(figure.y, ys);

    const bool svg = terminal == "svg";
    std::string text = fmt::format(
        "set terminal {} size {},{} enhanced font 'DejaVu Sans,{}' background '#ffffff'\n"
        "set output {}\nset encoding utf8\n",
        terminal, kWidth, kHeight, svg ? 19 : 15, quoted(output));
    text += fmt::format(
        "set border 3 lw 1.5 lc rgb '{0}'\nset tics nomirror out textcolor rgb '{0}'\n"
        "set grid lw 1 lc rgb '#D8D8D8'\n"
        "set lmargin at screen {1}\nset rmargin at screen {2}\n"
        "set bmargin at screen {3}\nset tmargin at screen {4}\n"
        "set key at screen {5},0.012 center bottom horizontal maxrows 3 samplen 2.5 spacing 1.15 "
        "width 1\n",
        kGrey, kLeft, kRight, kBottom, figure.top_label.empty() ? kTop : kTopWithAxis,
        (kLeft + kRight) / 2);
    text += fmt::format("set label 1 {} at screen 0.02,0.962 left font ',{}'\n",
                        "\"{/:Bold " + plain(figure.title) + "}\"", svg ? 25 : 20);
    if (!figure.subtitle.empty())
        text += fmt::format("set label 2 {} at screen 0.02,0.92 left textcolor rgb '{}'\n",
                            quoted(figure.subtitle), kGrey);
    text += axis_commands(figure.x, "x", x) + axis_commands(figure.y, "y", y);
    if (!figure.top_label.empty()) {
        const Axis top{figure.top_label, figure.x.log};
        text += axis_commands(top, "x2", {x.low * figure.top_factor, x.high * figure.top_factor});
        text += "set x2tics\nset x2label offset 0,-0.6\nset border 7\n";
    }
    int tag = 10;
    for (const Level& level : figure.levels) {
        text += fmt::format(
            "set arrow {0} from graph 0, first {1:g} to graph 1, first {1:g} nohead dt 2 lw 2 lc "
            "rgb '{2}'\nset label {0} {3} at graph 1.01, first {1:g} left textcolor rgb '{2}'\n",
            tag, level.y, kGrey, quoted(level.label));
        ++tag;
    }
    NotePlacer placer(figure, x, y);
    for (const Note& note : figure.notes)
        if (drawable(note.x, figure.x) && drawable(note.y, figure.y))
            text += fmt::format("set label {} {} {} textcolor rgb '{}'\n", tag++, quoted(note.text),
                                placer.place(note), look_of(note.key).colour);
    std::string plot;
    for (std::size_t i = 0; i < figure.curves.size(); ++i) {
        const Curve& curve = figure.curves[i];
        text += fmt::format("$d{} << EOD\n", i);
        std::size_t points = 0;
        for (const auto& [px, py] : curve.points)
            if (drawable(px, figure.x) && drawable(py, figure.y)) {
                text += fmt::format("{:.9g} {:.9g}\n", px, py);
                ++points;
            }
        text += "EOD\n";
        if (points > 0) plot += (plot.empty() ? "plot " : ", \\\n  ") + plot_clause(curve, i);
    }
    return text + (plot.empty() ? "plot NaN notitle" : plot) + "\n";
}

Result<void> draw_figure(const Figure& figure, const fs::path& folder) {
    const HoldInterrupts hold;
    for (const auto& [terminal, extension] : {std::pair{"svg", "svg"}, {"pngcairo", "png"}}) {
        const fs::path file = folder / (figure.id + "." + extension);
        const fs::path drawn = file.string() + fmt::format(".tmp-{}", getpid());
        const fs::path program = file.string() + fmt::format(".gp-{}", getpid());
        Result<void> done = write_text(program, gnuplot_program(figure, terminal, drawn.string()));
        if (done) done = run_gnuplot(program);
        std::error_code code;
        fs::remove(program, code);
        if (done) {
            fs::rename(drawn, file, code);
            if (!code) continue;
            done = data_error("cannot be written (" + code.message() + ")");
        }
        fs::remove(drawn, code);
        return tl::unexpected(
            Error{done.error().kind, file.string() + ": " + done.error().message});
    }
    return {};
}

}  // namespace wavefog::cli
