#include <fmt/format.h>

#include <charconv>

#include "wavefog/fogmap/scene.h"

namespace wavefog {

namespace {

constexpr int kMaxSamples = 65536;
constexpr const char* kMethods = "reference, exact, march:N (N = 1 to 65536), homogeneous";

}  // namespace

std::string Method::name() const {
    switch (kind) {
        case MethodKind::reference:
            return "reference";
        case MethodKind::exact:
            return "exact";
        case MethodKind::march:
            return fmt::format("march:{}", samples);
        case MethodKind::homogeneous:
            break;
    }
    return "homogeneous";
}

Result<Method> parse_method(const std::string& text) {
    Method method;
    if (text == "reference") {
        method.kind = MethodKind::reference;
    } else if (text == "exact") {
        method.kind = MethodKind::exact;
    } else if (text == "homogeneous") {
        method.kind = MethodKind::homogeneous;
    } else if (text.starts_with("march:")) {
        const char* const begin = text.data() + 6;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(begin, end, method.samples);
        if (error != std::errc() || stop != end || method.samples < 1 ||
            method.samples > kMaxSamples)
            return usage_error(
                fmt::format("method \"{}\": N must be 1 to {} samples; for example "
                            "march:32",
                            text, kMaxSamples));
        method.kind = MethodKind::march;
    } else {
        return usage_error(
            fmt::format("method \"{}\" does not exist; choose one of: {}", text, kMethods));
    }
    return method;
}

}  // namespace wavefog
