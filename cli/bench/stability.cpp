#include "bench/stability.h"

namespace wavefog::cli {

Result<void> study_stability(Context&, Results&) {
    return {};
}

}  // namespace wavefog::cli
