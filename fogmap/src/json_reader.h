// Strict reading of JSON: every value knows its file and path, so that errors can name them.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wavefog/fogmap/fog.h"
#include "wavefog/wavelet/result.h"

namespace wavefog::detail {

/// Thrown by JsonValue and caught by the public function that reads the file.
struct JsonFailure {
    Error error;
};

/// Syntax errors and duplicate keys give line and column.
Result<nlohmann::json> parse_json(const std::string& text, const std::string& file);

class JsonValue {
  public:
    JsonValue(const nlohmann::json& value, const std::string& file, std::string path = {})
        : value_(&value), file_(&file), path_(std::move(path)) {}

    /// Throws "FILE: path: what".
    [[noreturn]] void fail(const std::string& what) const;

    /// The value is an object with no keys but these; an unknown key is named beside the valid
    /// ones.
    const JsonValue& only(const std::vector<std::string_view>& keys) const;
    JsonValue key(std::string_view name) const;                  ///< required
    std::optional<JsonValue> find(std::string_view name) const;  ///< optional

    double number() const;
    double number(double low, double high) const;  ///< low <= x <= high
    double above(double low) const;                ///< x > low
    int integer(int low, int high) const;
    bool boolean() const;
    std::string text() const;
    /// Index of the text in `choices`.
    int choice(std::initializer_list<std::string_view> choices) const;
    std::vector<JsonValue> items() const;
    std::vector<double> numbers(std::size_t count) const;
    Eigen::Vector3d vector3() const;
    Rect rect() const;
    /// "FILE: path", as in messages.
    std::string place() const;
    bool is_text() const { return value_->is_string(); }
    bool is_list() const { return value_->is_array(); }

  private:
    JsonValue child(std::string_view name, const nlohmann::json& value) const;

    const nlohmann::json* value_;
    const std::string* file_;
    std::string path_;
};

/// {"profile": "exponential", "base": 0, "scale": 8} and the like.
Profile read_profile(const JsonValue& value);
nlohmann::json write_profile(const Profile& profile);

/// [vx, vz], or [[t, vx, vz], ...] where it changes; m/s and seconds.
Wind read_wind(const JsonValue& value);
nlohmann::json write_wind(const Wind& wind);

}  // namespace wavefog::detail
