// A chart as data: curves over two axes. What draws it is in gnuplot.h.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace wavefog::cli {

struct Axis {
    std::string label;  ///< with the unit
    bool log = true;
    double low = 0, high = 0;  ///< equal: from the data
    double step = 0;           ///< between numbers; 0: chosen by gnuplot
};

struct Curve {
    /// line and dashed have markers, plain has none.
    enum class Style { line, points, dashed, plain };
    std::string name;  ///< in the legend; empty: none
    std::string key;   ///< chooses colour and marker: a method, a family (gnuplot.cpp)
    Style style = Style::line;
    std::vector<std::pair<double, double>> points;
};

/// A horizontal line across the chart, e.g. the least visible error.
struct Level {
    double y = 0;
    std::string label;
};

/// A short text beside a point.
struct Note {
    double x = 0, y = 0;
    std::string text, key;
};

struct Figure {
    std::string id;  ///< the file name without extension
    std::string title, subtitle;
    Axis x, y;
    std::string top_label = {};  ///< of a second x axis, `top_factor` times the first; empty: none
    double top_factor = 1;
    std::vector<Level> levels = {};
    std::vector<Curve> curves = {};
    std::vector<Note> notes = {};
};

/// The least step of an 8-bit display, halved: a smaller change of T cannot be seen.
inline constexpr double kVisibleError = 1.0 / 510;

}  // namespace wavefog::cli
