// Aligned tables for terminals, and the same for Markdown.
#pragma once

#include <string>
#include <vector>

#include "bench/results.h"

namespace wavefog::cli {

class Table {
  public:
    explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    /// The first column and those without a title are aligned to the left, the others (numbers) to
    /// the right.
    std::string text(bool markdown) const;

  private:
    std::vector<std::vector<std::string>> rows_;
};

/// One table a group: ms with percentiles, ratio to `homogeneous`, errors, bytes.
std::string rows_text(const std::vector<Row>& rows, bool markdown);

/// "4.12", "37.1", "1234": three digits that matter, "-" if not measured.
std::string short_number(const std::optional<double>& value);

/// "7.1e-02", "-" if not measured.
std::string error_number(const std::optional<double>& value);

}  // namespace wavefog::cli
