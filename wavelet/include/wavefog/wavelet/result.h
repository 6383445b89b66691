// Errors as values: every public function that can fail returns Result<T>.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace wavefog {

/// What went wrong. The command line exits with 2 for `usage` and 1 for `data`.
enum class ErrorKind {
    usage,  ///< The caller asked for something that does not exist (a family, a method, a size).
    data,   ///< A file, a scene or a map is missing, damaged or outside the documented ranges.
};

/// Message format: "<file or argument>: <what and where>; <what to do>". No trailing full stop.
struct Error {
    ErrorKind kind = ErrorKind::data;
    std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> usage_error(std::string message) {
    return tl::unexpected<Error>(Error{ErrorKind::usage, std::move(message)});
}

inline tl::unexpected<Error> data_error(std::string message) {
    return tl::unexpected<Error>(Error{ErrorKind::data, std::move(message)});
}

}  // namespace wavefog
