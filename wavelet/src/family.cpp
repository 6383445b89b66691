#include "wavefog/wavelet/family.h"

#include <charconv>
#include <cstdio>

#include "wavefog/wavelet/filters.h"

namespace wavefog {
namespace {

// Growth of the condition number per level, 2^-s with s the Sobolev exponent of the dual scaling
// function (stability.md 1.2 and 1.3).
struct Growth {
    int order, dual_moments;
    double per_level;
};
constexpr Growth kUnstable[] = {{3, 1, 1.47}, {4, 2, 1.77}, {4, 4, 1.15}, {2, 0, 1.41}};

constexpr const char* kBasisNames[] = {"haar", "linear", "quadratic", "cubic"};
constexpr int kNamedBases = 4;

}  // namespace

std::string Family::name() const {
    switch (kind) {
        case Kind::chui_wang:
            return "chui-wang";
        case Kind::positive:
            return "positive";
        case Kind::cdf:
            break;
    }
    return std::to_string(degree + 1) + "," + std::to_string(dual_moments);
}

double Family::condition_growth() const {
    if (kind == Kind::cdf)
        for (const Growth& row : kUnstable)
            if (row.order == degree + 1 && row.dual_moments == dual_moments) return row.per_level;
    return 1;
}

bool Family::stable() const {
    return condition_growth() == 1;
}

std::string Family::warning() const {
    if (stable()) return {};
    char growth[16];
    std::snprintf(growth, sizeof growth, "%.2f", condition_growth());
    return "family " + name() + " is unstable: its condition number grows " + growth +
           " times with every level; use " + default_family(degree, Form::wavelet).name() +
           " unless you study this";
}

Family default_family(int degree, Form form) {
    switch (degree) {
        case 0:
            return {Family::Kind::cdf, 0, 1};
        case 1:
            return {Family::Kind::cdf, 1, 2};
        case 2:
            return {Family::Kind::cdf, 2, form == Form::wavelet ? 3 : 5};
        case 3:
            return {Family::Kind::cdf, 3, 6};
        default:
            return {Family::Kind::chui_wang, degree, 0};
    }
}

std::vector<Family> families(int degree) {
    std::vector<Family> all;
    for (const auto& [order, dual_moments] : cdf_pairs())
        if (order == degree + 1) all.push_back({Family::Kind::cdf, degree, dual_moments});
    all.push_back({Family::Kind::chui_wang, degree, 0});
    all.push_back({Family::Kind::positive, degree, 0});
    return all;
}

Result<Family> parse_family(std::string_view text, int degree) {
    std::string known;
    for (const Family& family : families(degree)) {
        if (family.name() == text) return family;
        if (!known.empty()) known += ", ";
        known += family.name();
    }
    return usage_error("family \"" + std::string(text) + "\": not known for basis " +
                       basis_name(degree) + "; use one of " + known);
}

std::string basis_name(int degree) {
    if (degree >= 0 && degree < kNamedBases) return kBasisNames[degree];
    return "degree-" + std::to_string(degree);
}

Result<int> parse_basis(std::string_view text) {
    for (int degree = 0; degree < kNamedBases; ++degree)
        if (text == kBasisNames[degree]) return degree;
    constexpr std::string_view prefix = "degree-";
    if (text.starts_with(prefix)) {
        int degree = -1;
        const char* end = text.data() + text.size();
        const auto parsed = std::from_chars(text.data() + prefix.size(), end, degree);
        if (parsed.ec == std::errc() && parsed.ptr == end && degree >= 0 && degree <= max_degree)
            return degree;
    }
    return usage_error(
        "basis \"" + std::string(text) +
        "\": not known; use haar, linear, quadratic, cubic or degree-N with N from 0 to " +
        std::to_string(max_degree));
}

}  // namespace wavefog
