// The CSV of rays that probe reads and completes.
#pragma once

#include <Eigen/Core>
#include <istream>
#include <string>
#include <vector>

#include "wavefog/wavelet/result.h"

namespace wavefog::cli {

struct Ray {
    Eigen::Vector3d origin, end;  ///< metres
    std::string text;             ///< the row as it was written, without the line's end
};

struct RayTable {
    std::string header;  ///< empty if the file had none
    std::vector<Ray> rays;
};

/// Rows "ox,oy,oz,px,py,pz", with or without a header line (one in which no column is a number).
/// Blank lines are skipped; Windows line ends and a byte-order mark are accepted. A data error
/// names line and column. `name` is the file's name in messages.
Result<RayTable> read_rays(std::istream& input, const std::string& name);

}  // namespace wavefog::cli
